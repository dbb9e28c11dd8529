from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from curlshot.vision.optics.camera import (
    CAMERA_COLUMNS,
    Camera,
    CameraError,
    camera_table,
)
from curlshot.vision.optics.projection import PARAMETERS, apply_homography

Array = NDArray[np.float64]
SIZE = (1280, 720)


class Pinhole:
    """A pinhole camera in three dimensions, to compare with: looks down, y of the ice up."""

    def __init__(self, place: tuple[float, float, float], pan: float, tilt: float, roll: float):
        down = np.diag([1.0, -1.0, -1.0])
        about_x = [[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]]
        about_y = [[np.cos(pan), 0, np.sin(pan)], [0, 1, 0], [-np.sin(pan), 0, np.cos(pan)]]
        about_z = [[np.cos(roll), -np.sin(roll), 0], [np.sin(roll), np.cos(roll), 0], [0, 0, 1]]
        self.turn = np.array(about_z) @ np.array(about_y) @ np.array(about_x) @ down
        self.place = np.array(place)
        self.f = 1500.0
        self.centre = np.array([(SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2])

    def pixels(self, xyz: Array) -> Array:
        seen = (xyz - self.place) @ self.turn.T
        return self.centre + self.f * seen[..., :2] / seen[..., 2:]

    def camera(self, k1: float = 0.0, k2: float = 0.0) -> Camera:
        inner = np.array([[self.f, 0, self.centre[0]], [0, self.f, self.centre[1]], [0, 0, 1]])
        to_ice = np.column_stack([self.turn[:, 0], self.turn[:, 1], -self.turn @ self.place])
        homography = inner @ to_ice
        return Camera(
            3, 0.12, homography / homography[2, 2], SIZE, k1, k2, self.f, position=self.place
        )


angles = st.floats(-0.25, 0.25)
pinholes = st.builds(
    Pinhole,
    st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(6, 12)),
    angles,
    angles,
    st.floats(-3, 3),
)
places = st.tuples(st.floats(-3, 3), st.floats(-3, 3))
# From none to the strongest that was measured, invertible within the picture.
distortions = st.sampled_from([(0.0, 0.0), (-0.11, 0.0), (0.06, 0.06), (-0.28, 0.06), (0.0, 0.02)])


@given(pinhole=pinholes, place=places, height=st.floats(0, 2))
def test_heights_are_seen_where_a_pinhole_camera_sees_them(
    pinhole: Pinhole, place: tuple[float, float], height: float
) -> None:
    wanted = pinhole.pixels(np.array([*place, height]))
    found = pinhole.camera().project(np.array(place), height)
    np.testing.assert_allclose(found, wanted, atol=1e-6)
    back = pinhole.camera().ice(wanted, height)
    np.testing.assert_allclose(back, place, atol=1e-7)


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


@given(
    x=st.floats(0, SIZE[0] - 1),
    y=st.floats(0, SIZE[1] - 1),
    distortion=distortions,
)
def test_undistorting_and_distorting_is_the_identity_in_the_picture(
    x: float, y: float, distortion: tuple[float, float]
) -> None:
    camera = Camera(0, 0.0, np.eye(3), SIZE, *distortion)
    pixel = np.array([x, y])
    np.testing.assert_allclose(camera.distort(camera.undistort(pixel)), pixel, atol=1e-6)


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


@given(pinhole=pinholes, place=places, distortion=distortions)
def test_ice_to_picture_and_back(
    pinhole: Pinhole, place: tuple[float, float], distortion: tuple[float, float]
) -> None:
    camera = pinhole.camera(*distortion)
    pixel = camera.project(np.array(place), 0.12)
    if (pixel < 0).any() or (pixel > np.array(SIZE)).any():
        return
    # What lies far outside may be folded into the picture by the polynomial.
    if np.hypot(*(camera.undistort(pixel) - pinhole.pixels(np.array([*place, 0.12])))) > 1:
        assert np.hypot(*(pinhole.pixels(np.array([*place, 0.12])) - pinhole.centre)) > 730
        return
    np.testing.assert_allclose(camera.ice(pixel, 0.12), place, atol=1e-6)


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
    with pytest.raises(ValueError, match="place is not known"):
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
