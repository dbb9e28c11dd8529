"""Clips on disk: times as the container tells them, cuts, cache, and the bundled sample."""

from __future__ import annotations

import json
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from curlshot.synthetic import (
    cached_clip,
    describe,
    frame_times,
    random_scene,
    sample_camera,
    sample_scene,
    still_camera,
    write_video,
)

DATA = Path(__file__).resolve().parents[3] / "data"


@pytest.mark.parametrize(
    ("fps", "dropped", "jitter"), [(25.0, (), 0.0), (29.97, (3, 4, 9), 0.0), (50.0, (7,), 0.3)]
)
def test_file_tells_the_true_times(
    tmp_path: Path, fps: float, dropped: tuple[int, ...], jitter: float
) -> None:
    times = frame_times(fps, 0.8, dropped=dropped, jitter=jitter, rng=np.random.default_rng(1))
    path = tmp_path / "clip.mp4"
    grey = np.full((64, 96, 3), 128, np.uint8)
    write_video(path, ((float(t), grey) for t in times), fps=fps)
    with av.open(str(path)) as container:
        told = [float(f.pts * f.time_base) for f in container.decode(video=0)]
    assert np.allclose(told, times, atol=1e-9)
    reader = cv2.VideoCapture(str(path))
    told = []
    while reader.grab():
        told.append(reader.get(cv2.CAP_PROP_POS_MSEC) / 1000)
    assert np.allclose(told, times, atol=1e-4)


def test_cached_clip_is_rendered_once_and_tells_the_truth() -> None:
    scene, camera = random_scene(np.random.default_rng(0)), still_camera(size=(320, 180))
    path, truth = cached_clip(scene, camera, duration=0.2)
    written = path.stat().st_mtime_ns
    again, same = cached_clip(scene, camera, duration=0.2)
    assert (again, path.stat().st_mtime_ns) == (path, written)
    assert same.tracks.equals(truth.tracks)
    assert truth.camera["t"].tolist() == pytest.approx([0, 0.04, 0.08, 0.12, 0.16])
    other, _ = cached_clip(scene, camera, duration=0.2, crf=30)
    assert other != path


@pytest.mark.parametrize("seed", range(12))
def test_random_shots_have_room_and_a_hit(seed: int) -> None:
    scene = random_scene(np.random.default_rng(seed))
    places = np.array([(s.start.x, s.start.y) for s in scene.stones])
    apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    assert apart[~np.eye(len(places), dtype=bool)].min() > 0.3
    hits = describe(scene, still_camera(), [0.0, 2.0]).hits
    assert hits[0].stones == ("A", "B")


def test_sample_is_the_study_s_shot() -> None:
    truth = describe(sample_scene(), sample_camera(), np.arange(165) / 25)
    at_hit = truth.tracks[truth.tracks["frame"] == 28].set_index("stone")
    assert np.allclose(at_hit.loc["A", ["x", "y"]].astype(float), [-0.320, 0.894], atol=1e-6)
    assert np.allclose(at_hit.loc["A", ["vx", "vy"]].astype(float), [0.0457, -1.3599], atol=1e-6)
    assert [h.stones for h in truth.hits] == [("A", "B"), ("B", "C")]
    assert truth.hits[0].t == pytest.approx(1.120, abs=0.01)
    assert truth.hits[1].t == pytest.approx(2.320, abs=0.02)


def test_bundled_sample_matches_its_truth() -> None:
    told = json.loads((DATA / "sample.truth.json").read_text(encoding="utf-8"))
    truth = describe(sample_scene(), sample_camera(), told["t"])
    for name, rows in truth.tracks.groupby("stone"):
        assert np.allclose(rows["x"], told["stones"][str(name)]["x"], atol=1e-4)
    assert np.allclose(truth.camera["h11"], told["camera"]["h11"], rtol=1e-6)
    assert (DATA / "sample.mp4").stat().st_size < 5_000_000
    reader = cv2.VideoCapture(str(DATA / "sample.mp4"))
    count = 0
    while reader.grab():
        assert reader.get(cv2.CAP_PROP_POS_MSEC) / 1000 == pytest.approx(told["t"][count], abs=1e-4)
        count += 1
    assert count == len(told["t"])
