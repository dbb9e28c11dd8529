"""The camera of the renderer: its maps invert each other and obey perspective."""

from __future__ import annotations

import numpy as np
import pytest

from curlshot.synthetic.camera import Lens, broadcast_camera, still_camera, tilted_camera

ICE = np.array([[0.0, 0.0], [1.2, 0.4], [-1.8, 1.1], [0.7, -1.5]])


@pytest.mark.parametrize(("k1", "k2"), [(0.06, 0.0), (-0.11, 0.02), (-0.28, 0.06)])
def test_undistortion_inverts_distortion(k1: float, k2: float) -> None:
    lens = Lens((1280, 720), k1, k2)
    pixels = np.stack(np.meshgrid([0, 300, 639.5, 1279], [0, 359.5, 719]), axis=-1)
    assert np.allclose(lens.distort(lens.undistort(pixels)), pixels, atol=1e-6)


def test_a_lens_that_folds_is_refused() -> None:
    with pytest.raises(ValueError, match="corners"):
        Lens((1280, 720), -0.28)


@pytest.mark.parametrize(
    "path",
    [
        still_camera(),
        broadcast_camera(k1=(-0.1, -0.02), k2=(0.03, 0.0), roll=(0.1, -0.3)),
        tilted_camera(np.deg2rad(55), roll=0.2),
    ],
)
def test_ground_inverts_projection(path) -> None:
    for t in (0.0, 2.3, 9.0):
        view = path.at(t)
        flat = np.column_stack([ICE, np.zeros(len(ICE))])
        pixels = view.project(flat)
        assert np.allclose(view.ground(pixels), ICE, atol=1e-8)
        h = np.column_stack([ICE, np.ones(len(ICE))]) @ view.homography.T
        assert np.allclose(view.lens.distort(h[:, :2] / h[:, 2:]), pixels, atol=1e-6)


def test_height_moves_a_point_away_from_the_foot_of_the_camera() -> None:
    view = still_camera(position=(0.3, -0.2, 9.0)).at(0)
    x, y, z = 1.5, 2.0, 0.12
    behind = view.ground(view.project([x, y, z]))
    away = 9.0 / (9.0 - z)
    assert np.allclose(behind, [0.3 + (x - 0.3) * away, -0.2 + (y + 0.2) * away])


def test_upright_picture_and_scale() -> None:
    view = still_camera(position=(0, 0, 9.9), target=(0, 0), px_per_m=110).at(0)
    right, up = view.project([[1, 0, 0], [0, 1, 0]]) - view.lens.centre
    assert np.allclose([right, up], [[110, 0], [0, -110]], atol=1e-9)
    assert view.scale(0, 0) == pytest.approx(110, rel=1e-6)


def test_a_camera_turned_counter_clockwise_turns_the_picture_clockwise() -> None:
    view = still_camera(target=(0, 0), roll=0.1).at(0)
    right = view.project([1, 0, 0]) - view.project([0, 0, 0])
    assert np.arctan2(right[1], right[0]) == pytest.approx(0.1)
