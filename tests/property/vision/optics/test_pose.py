from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from curlshot.vision.optics.pose import (
    View,
    aim,
    camera,
    pictured,
    project,
    rescaled,
    rotation_vector,
    turned,
)
from curlshot.vision.optics.rig import ANYWHERE, OVERHEAD, POSITION, start_rig

SIZE = (1280, 720)
views = st.tuples(
    st.floats(-0.4, 0.4), st.floats(-0.1, 0.1), st.floats(-0.2, 0.2), st.floats(6.8, 8.2)
).map(lambda v: View(np.array(v)))
places = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(6.0, 11.0)).map(np.array)


def circle(radius: float) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi, 50)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@given(views, places, st.floats(-0.1, 0.1))
@settings(max_examples=50, deadline=None)
def test_camera_shows_points_where_project_does(view: View, place: np.ndarray, k1: float) -> None:
    rig = start_rig(OVERHEAD, place)
    rig[3] = k1
    points = circle(1.8)
    seen = camera(view, rig, SIZE)
    np.testing.assert_allclose(
        seen.project(points), project(points, view.vector, rig, SIZE), atol=1e-6
    )
    np.testing.assert_allclose(seen.position, place)


@given(
    st.floats(300, 980),
    st.floats(50, 650),
    st.floats(110, 220),
    st.sampled_from([(0.0, 0.0, 8.0), (0.3, -0.2, 9.0), (0.0, -6.0, 9.0)]),
)
@settings(max_examples=50, deadline=None)
def test_aim_puts_the_tee_where_it_is_asked(
    x: float, y: float, scale: float, place: tuple[float, float, float]
) -> None:
    rig = start_rig(ANYWHERE, place)
    rig[3:6] = 0
    view = aim((x, y), scale, place, SIZE)
    tee, right = project(np.array([[0.0, 0.0], [0.01, 0.0]]), view.vector, rig, SIZE)
    np.testing.assert_allclose(tee, (x, y), atol=1e-6)
    assert right[0] > tee[0]
    assert abs(np.hypot(*(right - tee)) / 0.01 / scale - 1) < 0.25


@given(views, places, st.floats(-1.5, 1.5))
@settings(max_examples=50, deadline=None)
def test_turning_the_ice_leaves_circles_where_they_are(
    view: View, place: np.ndarray, angle: float
) -> None:
    rig = start_rig(OVERHEAD, place)
    other, moved = turned(view, rig, angle)
    c, s = np.cos(angle), np.sin(angle)
    points = circle(1.2)
    before = project(points @ np.array([[c, s], [-s, c]]), view.vector, rig, SIZE)
    np.testing.assert_allclose(before, project(points, other.vector, moved, SIZE), atol=1e-5)
    assert np.isclose(np.linalg.norm(moved[POSITION]), np.linalg.norm(place))


def test_a_larger_picture_is_the_same_picture() -> None:
    rig = start_rig(OVERHEAD)
    view = View(np.array([0.1, 0.02, 0.03, 7.0]))
    small = project(circle(1.0), view.vector, rig, (640, 360))
    large = project(circle(1.0), rescaled(view, 2).vector, rig, (1280, 720))
    np.testing.assert_allclose((small + 0.5) * 2 - 0.5, large, atol=1e-9)


@given(
    axis=st.tuples(*3 * [st.floats(-1, 1)]).filter(lambda axis: np.linalg.norm(axis) > 1e-3),
    angle=st.sampled_from([0.0, 1e-12, 1e-6, 0.3, 2.0, np.pi - 1e-6, np.pi - 1e-3]),
)
def test_a_rotation_vector_is_exact_near_the_identity_and_near_a_half_turn(
    axis: tuple[float, float, float], angle: float
) -> None:
    vector = angle * np.array(axis) / np.linalg.norm(axis)

    found = rotation_vector(Rotation.from_rotvec(vector).as_matrix())

    np.testing.assert_allclose(found, vector, rtol=1e-8, atol=1e-15)


def test_places_are_in_the_picture_up_to_its_edge() -> None:
    place = (0.0, 0.0, 8.0)
    rig, view = start_rig(OVERHEAD, place), aim((640.0, 360.0), 200.0, place, SIZE)
    ice = np.array([[[0.0, 0.0], [3.0, 0.0]], [[3.4, 0.0], [0.0, -1.9]]])
    pixels, inside = pictured(ice, view.vector, rig, SIZE)
    np.testing.assert_array_equal(inside, [[True, True], [False, False]])
    np.testing.assert_allclose(pixels[0, 0], (640.0, 360.0), atol=1.0)


def test_a_view_tells_how_far_turning_moves_the_middle_of_the_picture() -> None:
    rig = start_rig(OVERHEAD)
    one = aim((600.0, 400.0), 120.0, rig[POSITION], (1280, 720))
    two = View(one.vector + np.array([0.02, -0.05, 0.0, 0.0]))
    middle = camera(one, rig, (1280, 720)).ice(np.array([[639.5, 359.5]]))
    moved = project(middle, two.vector, rig, (1280, 720))[0] - [639.5, 359.5]
    np.testing.assert_allclose(two.sweep(one), moved, rtol=0.05)
