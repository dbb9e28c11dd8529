from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.vision.optics.camera import Camera, CameraError
from curlshot.vision.optics.cameras import Cameras
from curlshot.vision.optics.pose import View, camera
from curlshot.vision.optics.projection import PARAMETERS
from curlshot.vision.optics.rig import K1, K2, OVERHEAD, start_rig

HEIGHT = 8.0
COUNTS = (2, 0, 3, 1, 1)
HIGH = 0.12


def seen_from(x: float, tilt: float, k1: float, error: CameraError | None) -> Camera:
    rig = start_rig(OVERHEAD, (x, 0.3, HEIGHT))
    rig[3:6] = 0
    rig[[K1, K2]] = k1, 0.3 * k1
    view = View(np.array([tilt, 0.1, 0.2, np.log(1200.0 + 50 * x)]))
    return replace(camera(view, rig, (1280, 720)), error=error)


def known(share: float) -> CameraError:
    shared = share * np.diag(np.arange(1.0, PARAMETERS + 1)) * 1e-6
    return CameraError(shared, 0 * shared, scale=0.001 * share, drift=0.002 * share)


def several(k1: float = -0.1) -> list[Camera]:
    cameras = [
        seen_from(0.1 * k, 0.05 * k, k1 * k, known(1.0 + k) if k % 2 else None) for k in range(4)
    ]
    return [*cameras, replace(cameras[2], position=None)]


def each_of(cameras: list[Camera], points: np.ndarray) -> list[tuple[Camera, np.ndarray]]:
    parts = np.split(points, np.cumsum(COUNTS)[:-1])
    return [(one, part) for one, part in zip(cameras, parts, strict=True) if len(part)]


POINTS = np.random.default_rng(2).uniform(-1.5, 1.5, (sum(COUNTS), 2))


@pytest.mark.parametrize("k1", [0.0, -0.1])
@pytest.mark.parametrize("height", [0.0, HIGH])
def test_each_row_is_seen_by_its_own_camera(k1: float, height: float) -> None:
    cameras = several(k1)
    by = Cameras.of(cameras, COUNTS)
    told = np.concatenate([one.project(part, height) for one, part in each_of(cameras, POINTS)])
    np.testing.assert_allclose(by.project(POINTS[:, None], height)[:, 0], told, atol=1e-9)
    np.testing.assert_allclose(by.ice(told, height), POINTS, atol=1e-6)
    scale = np.concatenate([one.scale_at(part) for one, part in each_of(cameras, POINTS)])
    np.testing.assert_allclose(by.scale_at(POINTS), scale, rtol=1e-9)
    both = by.project(np.stack([POINTS, POINTS], 1), np.array([0.0, height]))
    np.testing.assert_allclose(both[:, 1], told, atol=1e-9)


def test_errors_are_those_of_each_row_s_camera_and_nothing_where_none_is_stated() -> None:
    cameras = several()
    found = Cameras.of(cameras, COUNTS).shared_place_cov(POINTS, HIGH)
    parts = [one.shared_place_cov(part, HIGH) for one, part in each_of(cameras, POINTS)]
    np.testing.assert_allclose(found, np.concatenate(parts), rtol=1e-9)
    assert np.trace(found[5]) > 0
    np.testing.assert_array_equal(Cameras.of(cameras[::2], (2, 2, 3)).shared_place_cov(POINTS), 0)


def test_views_slant_by_the_place_off_the_camera_s_foot() -> None:
    cameras = several()
    slants = Cameras.of(cameras, COUNTS).slants(POINTS)
    np.testing.assert_allclose(slants[:2], (POINTS[:2] - [0.0, 0.3]) / HEIGHT, atol=1e-12)
    np.testing.assert_allclose(slants[5], (POINTS[5] - [0.3, 0.3]) / HEIGHT, atol=1e-12)
    np.testing.assert_array_equal(slants[6], 0)
