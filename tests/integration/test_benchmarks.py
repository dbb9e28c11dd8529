"""Every benchmark says what it measures before it begins."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.benchmarks import kinds
from curlshot.benchmarks.kinds import as_made
from curlshot.synthetic import Scene, Truth, random_scene
from curlshot.synthetic.stones import HEIGHT

ROOT = Path(__file__).resolve().parents[2]
RUN_BY_HAND = sorted(
    path.stem
    for path in (ROOT / "benchmarks").glob("*.py")
    if "__main__" in path.read_text(encoding="utf-8")
)


@pytest.mark.parametrize("name", RUN_BY_HAND)
def test_help_is_help(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", [f"{name}.py", "--help"])
    with pytest.raises(SystemExit) as done:
        runpy.run_path(str(ROOT / "benchmarks" / f"{name}.py"), run_name="__main__")
    assert done.value.code == 0
    assert len(capsys.readouterr().out.splitlines()) > 5


def test_kinds_differ_from_what_is_nominal_as_houses_and_stones_do() -> None:
    nominal = random_scene(np.random.default_rng(1))
    drawn = [as_made(nominal, np.random.default_rng(seed)) for seed in range(60)]
    for scene in drawn:
        assert [s.start for s in scene.stones] == [s.start for s in nominal.stones]
        assert len({(s.cap_height, s.cap_radius) for s in scene.stones}) == 1
        cap = scene.stones[0]
        assert min(cap.side) == pytest.approx(HEIGHT)  # nothing is between cap and granite
        assert scene.paint.radii[0] == 1.829  # the yardstick
    radii = np.array([scene.stones[0].cap_radius for scene in drawn])
    assert 0.1029 < radii.min() < 0.104 < 0.105 < radii.max() < 0.1061
    heights = np.array([scene.stones[0].cap_height for scene in drawn])
    assert 0.114 < heights.min() < 0.118 < 0.122 < heights.max() < 0.125
    inner = np.array([scene.paint.radii[1:3] for scene in drawn])
    assert np.allclose(inner.min(0), (1.207, 0.606), atol=0.002)
    assert np.allclose(inner.max(0), (1.224, 0.628), atol=0.002)
    outlines = np.array([s.paint.outline_width for s in drawn if s.paint.outline])
    assert 0.0039 < outlines.min() < 0.006 < 0.008 < outlines.max() < 0.0101
    assert {scene.light.power for scene in drawn} == {1.0, 2.2}
    assert {scene.paint.outline is None for scene in drawn} == {True, False}


def test_clips_of_kinds_are_drawn_as_made_and_flat_discs_show_no_spin(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tracks = pd.DataFrame({"stone": ["A"], "theta": [1.0], "omega": [0.5]})
    true, drawn = Truth(tracks, pd.DataFrame(), (), 0.01, (1280, 720), 25.0), []

    def clip(scene: Scene, *_: object, **__: object) -> tuple[Path, Truth]:
        drawn.append(scene)
        return Path("clip.mp4"), true

    monkeypatch.setattr(kinds, "cached_clip", clip)
    monkeypatch.setattr(kinds, "open_video", lambda paths: paths)
    told = {kind: kinds.clip_of(kind, 1)[1].tracks["omega"].notna().all() for kind in kinds.KINDS}
    assert all(spin != kind.plain for kind, spin in told.items())
    assert all(stone.wall > 0 for scene in drawn for stone in scene.stones)
