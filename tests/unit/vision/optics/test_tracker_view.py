from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.vision.optics.camera import Camera, camera_table
from curlshot.vision.optics.camera_file import cameras_of
from curlshot.vision.optics.tracker_view import CORNER, closest_similarity, marks_of, off_at

SIZE = (1280, 720)


def camera(frame: int, tilt: float, k1: float = 0.0) -> Camera:
    """Turned by 0.3 rad, 150 px/m at the tee, y of the picture down."""
    cos, sin = 150 * np.cos(0.3), 150 * np.sin(0.3)
    similarity = np.array([[cos, -sin, 640.0], [-sin, -cos, 350.0], [0, 0, 1]])
    return Camera(frame, frame / 25, similarity @ np.array([[1, 0, 0], [0, 1, 0], [0, tilt, 1]]),
                  SIZE, k1)  # fmt: skip


def test_a_camera_from_above_is_a_similarity() -> None:
    cameras = [camera(3, 0.0), camera(4, 0.0)]
    system = closest_similarity(cameras)
    np.testing.assert_allclose(system.origin, [[640.5, 350.5]] * 2, atol=1e-6)
    np.testing.assert_allclose(system.angle, 0.3, atol=1e-6)
    np.testing.assert_allclose(system.scale, 150, rtol=1e-6)
    assert off_at(system, cameras, 1.829) < 1e-6
    places = np.array([[1.0, 2.0], [-1.5, 0.3]])
    marks = marks_of({c.frame: c for c in cameras}, [3, 4], places)
    np.testing.assert_allclose(system.world([3, 4], marks), places, atol=1e-6)
    np.testing.assert_allclose(marks, cameras[0].project(places) + CORNER)


def test_perspective_is_off_at_the_ring_but_not_at_the_tee() -> None:
    tilted = [camera(0, 0.05)]
    system = closest_similarity(tilted)
    assert off_at(system, tilted, 0.001) < 1e-6
    # x, y at a tilt a appear at 1 / (1 + a y) of the distance: a y² off, and more on one side.
    assert off_at(system, tilted, 1.829) == pytest.approx(0.05 * 1.829**2, rel=0.15)


def test_cameras_come_back_from_their_table(tmp_path: Path) -> None:
    made = [camera(5, 0.02, -0.03), camera(6, 0.01)]
    path = tmp_path / "camera.csv"
    camera_table(made).to_csv(path, index=False)
    found = cameras_of(path, SIZE)
    places = np.array([[0.3, -1.0], [1.0, 1.5]])
    for one in made:
        np.testing.assert_allclose(found[one.frame].project(places), one.project(places))
    camera_table(made).drop(columns="k1").to_csv(path, index=False)
    with pytest.raises(InputError, match=r"camera\.csv: no column k1"):
        cameras_of(path, SIZE)
