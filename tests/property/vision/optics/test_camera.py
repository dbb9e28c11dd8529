from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from curlshot.tests.helpers.vision.camera import SIZE, Pinhole, places
from curlshot.vision.optics.camera import (
    Camera,
)

angles = st.floats(-0.25, 0.25)
pinholes = st.builds(
    Pinhole,
    st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(6, 12)),
    angles,
    angles,
    st.floats(-3, 3),
)
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
