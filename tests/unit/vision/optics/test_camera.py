from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.tests.helpers.vision.camera import SIZE, Pinhole
from curlshot.vision.optics.camera import (
    CAMERA_COLUMNS,
    Camera,
    CameraError,
    camera_table,
)
from curlshot.vision.optics.projection import PARAMETERS, apply_homography


def test_parallax_has_the_size_of_similar_triangles() -> None:
    camera = Pinhole((0.0, 0.0, 10.0), 0, 0, 0).camera()
    cap = camera.project([1.5, -2.0], 0.12)
    naive = camera.ice(cap)
    np.testing.assert_allclose(naive, np.array([1.5, -2.0]) * 10 / (10 - 0.12), atol=1e-12)
    np.testing.assert_allclose(camera.ice(cap, 0.12), [1.5, -2.0], atol=1e-12)


def test_without_a_place_of_the_camera_heights_are_ignored() -> None:
    known = Pinhole((0.5, 0.0, 9.0), 0.1, 0, 0).camera()
    camera = Camera(0, 0.0, known.homography, SIZE)
    np.testing.assert_array_equal(camera.project([1.0, 1.0], 0.12), camera.project([1.0, 1.0]))
    np.testing.assert_array_equal(camera.ice([9.0, 9.0], 0.12), camera.ice([9.0, 9.0]))


def test_distortion_is_the_polynomial_about_the_middle() -> None:
    camera = Camera(0, 0.0, np.eye(3), SIZE, k1=-0.1, k2=0.05)
    centre, radius = np.array([639.5, 359.5]), np.hypot(1280, 720) / 2
    np.testing.assert_array_equal(camera.distort(centre), centre)
    np.testing.assert_array_equal(camera.undistort(centre), centre)
    corner = centre + radius * np.array([0.6, 0.8])
    scaled = (camera.distort(corner) - centre) / (corner - centre)
    np.testing.assert_allclose(scaled, 1 - 0.1 + 0.05)
    halfway = centre + radius * np.array([0.5, 0.0])
    np.testing.assert_allclose(
        (camera.distort(halfway) - centre)[0] / radius, 0.5 * (1 - 0.1 / 4 + 0.05 / 16)
    )


def test_shapes_are_kept_and_inputs_are_not_changed() -> None:
    camera = Pinhole((0.0, 0.0, 10.0), 0.1, 0.1, 0).camera(-0.1, 0.02)
    points = np.random.default_rng(1).uniform(-2, 2, (4, 5, 2))
    copy = points.copy()
    pixels = camera.project(points, 0.12)
    assert pixels.shape == (4, 5, 2)
    np.testing.assert_allclose(camera.ice(pixels, 0.12), points, atol=1e-8)
    np.testing.assert_allclose(pixels[2, 3], camera.project(points[2, 3], 0.12))
    np.testing.assert_array_equal(points, copy)


@pytest.mark.parametrize("roll", [0.0, 1.0])
def test_scale_of_a_camera_straight_above(roll: float) -> None:
    camera = Pinhole((0.3, 0.2, 10.0), 0, 0, roll).camera()
    for place in ((0.0, 0.0), (1.8, -1.2)):
        assert camera.scale_at(place) == pytest.approx(1500 / 10, rel=1e-9)


def changed(parameter: int, step: float) -> Camera:
    """A tilted camera of which one of the parameters differs."""
    pinhole, k = Pinhole((0.4, -3.0, 8.0), 0.05, -0.3, 0.2), [-0.06, 0.02]
    if parameter < 3:
        x, y, z = step * np.eye(3)[parameter]
        crossed = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        pinhole.turn = (np.eye(3) + crossed) @ pinhole.turn
    elif parameter == 3:
        pinhole.f *= np.exp(step)
    elif parameter < 7:
        pinhole.place = pinhole.place + step * np.eye(3)[parameter - 4]
    else:
        k[parameter - 7] += step
    return pinhole.camera(*k)


@pytest.mark.parametrize("parameter", range(PARAMETERS))
@pytest.mark.parametrize("height", [0.0, 0.12])
def test_places_move_with_the_parameters_as_the_jacobian_says(
    parameter: int, height: float
) -> None:
    ice = np.array([[0.0, 0.0], [1.4, -0.8], [-1.1, 2.0]])
    pixels = changed(parameter, 0.0).project(ice, height)
    one, two = (changed(parameter, step).ice(pixels, height) for step in (-1e-6, 1e-6))
    found = changed(parameter, 0.0).place_jacobian(ice, height)[..., parameter]
    np.testing.assert_allclose(found, (two - one) / 2e-6, rtol=1e-4, atol=1e-6)


def test_the_covariance_of_places_is_of_what_is_shared_and_what_is_not() -> None:
    rng = np.random.default_rng(3)
    shared, own = (r @ r.T for r in rng.normal(0, 1e-3, (2, PARAMETERS, PARAMETERS)))
    camera, places = changed(0, 0.0), np.array([[1.0, 0.5], [-0.3, 2.0]])
    assert not camera.place_cov(places).any()
    known = replace(camera, error=CameraError(shared, own, scale=0.002, drift=0.003))
    by_camera = camera.place_jacobian(places)
    expected = by_camera @ (shared + own) @ by_camera.transpose(0, 2, 1) + 0.003**2 * np.eye(2)
    expected += 0.002**2 * places[:, :, None] * places[:, None]
    np.testing.assert_allclose(known.place_cov(places), expected, rtol=1e-9)
    of_all = known.shared_place_cov(places)
    np.testing.assert_allclose(known.place_sd(places) ** 2, np.trace(of_all.T) / 2, rtol=1e-9)
    with pytest.raises(ValueError, match="position of the camera is unknown"):
        replace(camera, position=None).place_jacobian(places)


def test_homography_of_a_known_map() -> None:
    matrix = np.array([[2.0, 0, 1], [0, 3, -1], [0, 0.5, 1]])
    found = apply_homography(matrix, [[1.0, 2.0], [0.0, 0.0]])
    np.testing.assert_allclose(found, [[3 / 2, 5 / 2], [1, -1]])


def test_table_has_one_row_per_frame() -> None:
    known = Pinhole((0.5, 0.25, 9.0), 0, 0, 0).camera(-0.1, 0.02)
    carried = Camera(4, 0.16, known.homography, SIZE, found=False)
    table = camera_table([known, carried])
    assert tuple(table.columns) == CAMERA_COLUMNS
    assert table["frame"].tolist() == [3, 4]
    assert table["found"].tolist() == [1, 0]
    matrix = table.loc[0, [f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]].to_numpy(float)
    np.testing.assert_array_equal(matrix.reshape(3, 3), known.homography)
    assert table.loc[0, ["cam_x", "cam_y", "cam_z"]].tolist() == [0.5, 0.25, 9.0]
    assert table.loc[1, ["cam_x", "f_px", "rms_px"]].isna().all()
    assert tuple(camera_table([]).columns) == CAMERA_COLUMNS
