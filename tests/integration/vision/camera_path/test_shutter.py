from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from curlshot.synthetic import render_still
from curlshot.tests.helpers.vision.shutter import (
    BEFORE,
    HEIGHT,
    MIDDLE,
    SCENE,
    SIZE,
    SWEPT,
    before,
    looking,
)
from curlshot.vision.camera_path.edge_tracker import EdgeTracker
from curlshot.vision.camera_path.shutter import (
    LEAST_SMEAR,
    ShutterLight,
    Smeared,
    more_light,
)
from curlshot.vision.optics.paint import TWELVE
from curlshot.vision.optics.pose import View, camera
from curlshot.vision.video.frame import Frame

AROUND = np.linspace(0, 2 * np.pi, 24, endpoint=False)
RIM = 1.829 * np.stack([np.cos(AROUND), np.sin(AROUND)], axis=-1)


@cache
def moments() -> list[np.ndarray]:
    """What one exposure shows, bit by bit, from 0 to 1."""
    places = MIDDLE + SWEPT * (np.arange(19) / 18 - 0.5)
    return [render_still(SCENE, looking(y)) / 255.0 for y in places.tolist()]


def exposed(gamma: float) -> np.ndarray:
    """A pan's picture: the mean of its moments' codes, or of their light if gamma is 2.2."""
    light = np.mean([moment**gamma for moment in moments()], axis=0)
    noise = np.random.default_rng(3).normal(0, 1.0, light.shape)
    return np.clip(255 * light ** (1 / gamma) + noise, 0, 255).round().astype(np.uint8)


def aside(view: View, rig: np.ndarray) -> float:
    """How far a view of the smeared picture has the rim aside along the pan at most, mm."""
    true = looking(MIDDLE).at(0.0).project(np.c_[RIM, np.zeros(len(RIM))])
    inside = ((true > 0) & (true < SIZE)).all(1)
    seen = camera(view, rig, SIZE, frame=0, t=0.0, rms_px=0.0).ice(true[inside])
    return 1e3 * float(np.abs((seen - RIM[inside])[:, 1]).max())


@pytest.mark.parametrize(("gamma", "share"), [(2.2, 1.0), (1.0, 0.0)])
def test_a_pan_tells_what_its_shutter_blurs(gamma: float, share: float) -> None:
    """An outline hides it in the frame before; taken for codes, light puts the rim 14 mm aside."""
    house = before()
    assert abs(house.edge.light[TWELVE]) < 0.02
    edges = EdgeTracker(SIZE, house.evidence.palette, house.edge)
    ahead = View(house.view.vector - np.array([(MIDDLE - BEFORE) / HEIGHT, 0.0, 0.0, 0.0]))
    (seen,) = edges.settle([Frame(1, 0.04, exposed(gamma))], [ahead], house.rig, house.view)
    smeared = Smeared(edges.sweep, edges.palette, house.edge)
    told = smeared.told(seen.marks.get(), seen.view, house.rig, SIZE, share)
    assert told is not None
    assert abs(told[0] - share) < 0.2
    assert aside(seen.view, house.rig) < 2.0


def test_edges_measured_with_another_share_are_moved_to_where_they_lie(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    house = before()
    edges = EdgeTracker(SIZE, house.evidence.palette, house.edge)
    monkeypatch.setattr(EdgeTracker, "_learn_light", lambda *_: 0.0)
    ahead = View(house.view.vector - np.array([(MIDDLE - BEFORE) / HEIGHT, 0.0, 0.0, 0.0]))
    (seen,) = edges.settle([Frame(1, 0.04, exposed(2.2))], [ahead], house.rig, house.view)
    assert abs(seen.share) < 0.1 and seen.smeared > LEAST_SMEAR
    shares = []
    for _ in range(2):
        assert seen.by_light is not None
        more = more_light(seen.marks.get(), seen.view, house.rig, SIZE, seen.by_light)
        assert more is not None
        shares.append(more[0])
        edges.light = ShutterLight(seen.share + more[0], more[1])
        seen = edges.relit(seen)
        assert seen.share == edges.light.share
    assert shares[0] == pytest.approx(1.0, abs=0.3)
    assert shares[1] == pytest.approx(0.0, abs=0.1)
