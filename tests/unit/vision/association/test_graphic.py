"""What stays in the picture is told from what stays on the ice, or glides on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.data.sheet import STONE
from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.association.follow import Track
from curlshot.vision.association.graphic import glide, is_graphic
from curlshot.vision.optics.camera import Camera, CameraError

Array = NDArray[np.float64]


def cameras_of(times: Array, x: Array, zoom: Array | float = 1.0) -> list[Camera]:
    """Cameras that look at (x, 0) from above, at 100 px/m times the zoom."""
    return [
        Camera(
            frame, float(t), np.array([[s, 0.0, 320 - s * at], [0.0, -s, 240.0], [0.0, 0.0, 1.0]]),
            (640, 480),
        )
        for frame, (t, at, s) in enumerate(
            zip(times, x, 100 * np.broadcast_to(zoom, x.shape), strict=True)
        )
    ]  # fmt: skip


def track_of(times: Array, places: Array, score: float = 2.2) -> Track:
    track = Track()
    for frame, (t, (x, y)) in enumerate(zip(times, places, strict=True)):
        seen = detection((x, y), score=score)._replace(sd_x=0.0008, sd_y=0.0008)
        track.add(frame, float(t), seen, STONE.radius)
    return track


def smooth(times: Array) -> Array:
    """From 0 to 1, without a jerk."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * times / times[-1]))


@pytest.mark.parametrize(
    ("along", "score", "graphic"),
    [(1.0, 1.2, True), (0.0, 1.2, False), (0.8, 1.2, False), (1.0, 2.2, True), (0.0, 2.2, False)],
)
def test_what_stays_in_the_picture_while_the_ice_moves_is_a_graphic(
    along: float, score: float, graphic: bool
) -> None:
    """However much of a stone it shows: no stone goes to and fro as the camera does."""
    times = np.arange(30) / 25
    x = 0.2 * np.sin(7.5 * times)
    noise = np.random.default_rng(2).normal(0, 0.003, (30, 2))
    places = np.column_stack([1.0 + along * x, 0 * x]) + noise
    assert is_graphic(track_of(times, places, score), cameras_of(times, x), STONE) == graphic


@pytest.mark.parametrize(
    ("swing", "score", "graphic"),
    [(0.3, 2.2, True), (0.3, 1.2, True), (0.0, 2.2, False), (0.0, 1.2, True)],
)
def test_a_graphic_that_shows_all_of_a_stone_does_not_glide(
    swing: float, score: float, graphic: bool
) -> None:
    """Under a camera that goes to and fro; one that glides may go along with a stone."""
    times = np.arange(75) / 25
    x = 0.5 * times - 0.05 * times**2 + swing * np.sin(2.5 * times)
    places = np.column_stack([x, np.random.default_rng(3).normal(0, 0.003, 75)])
    assert is_graphic(track_of(times, places, score), cameras_of(times, x), STONE) == graphic


def test_a_stone_that_was_at_rest_before_a_hit_is_no_graphic() -> None:
    """Though it lies still in the picture of a still camera, and no glide is all of its path."""
    times = np.arange(75) / 25
    x = 1.2 * np.maximum(times - 1.8, 0)
    track = track_of(times, np.column_stack([x, 0 * x]))
    assert not is_graphic(track, cameras_of(times, 0 * x), STONE)


@pytest.mark.parametrize("still", [0.2, 0.35, 0.48, 0.6])
def test_a_stone_that_comes_to_rest_as_the_camera_does_is_no_graphic(still: float) -> None:
    """It rests, is hit, glides and rests again: for a part of the time it stays in the picture.

    There its place is the middle one of all, for the camera has gone beyond and come back.
    """
    times = np.arange(150) / 25
    moving = np.clip(times / times[-1], 0, 1 - still) / (1 - still)
    x = np.where(moving < 0.5, 1.2, -1.2) * np.sin(2 * np.pi * moving) ** 2
    along = 0.7 * np.clip((moving - 0.2) / 0.8, 0, 1) * (2 - np.clip((moving - 0.2) / 0.8, 0, 1))
    noise = np.random.default_rng(6).normal(0, 0.0008, (150, 2))
    track = track_of(times, np.column_stack([along, 0 * x]) + noise)
    assert not is_graphic(track, cameras_of(times, x), STONE)


@pytest.mark.parametrize(
    ("move", "count"),
    [(move, count) for move in ("zoom", "smooth pan", "pan after rest") for count in (30, 75)]
    + [("pan", 75)],
)
def test_an_icon_under_a_camera_that_moves_smoothly_is_no_stone(move: str, count: int) -> None:
    """Though its path on the ice is near a parabola, or straight: stones slow down.

    In a second they do so by too little for an even pan to be told.
    """
    times = np.arange(count) / 25
    x, zoom = np.zeros(count), np.ones(count)
    if move == "zoom":
        zoom = 0.9 + 0.25 * smooth(times)
    elif move == "pan":
        x = 0.5 * times
    elif move == "smooth pan":
        x = 0.4 * smooth(times)
    else:
        x = 0.4 * smooth(np.maximum(times - 0.35 * times[-1], 0.0))
    noise = np.random.default_rng(4).normal(0, 0.1, (count, 2))  # px
    places = (np.array([120.0, 90.0]) + noise) / (100 * zoom)[:, None] + np.column_stack([x, 0 * x])
    cameras = cameras_of(times, x, zoom)
    assert is_graphic(track_of(times, places), cameras, STONE)
    rests = np.array([1.2, 0.9]) + noise / (100 * zoom)[:, None]
    assert not is_graphic(track_of(times, rests), cameras, STONE)


@pytest.mark.parametrize("speed", [0.3, 1.5])
@pytest.mark.parametrize("slowing", [0.06, 0.1, 0.2])
def test_a_glide_is_told_and_no_other_motion(speed: float, slowing: float) -> None:
    times = np.arange(30) / 25 + 7
    way = np.array([0.6, -0.8])
    ago = times - times[0]
    true = np.array([0.2, 3.0]) + np.outer(speed * ago - 0.5 * slowing * ago**2, way)
    np.testing.assert_allclose(glide(times, true), true, atol=1e-9)
    gains = np.outer(speed * ago + 0.5 * slowing * ago**2, way)
    even = np.outer(speed * ago, way)
    for other in (gains, even):
        assert np.ptp(glide(times, other) - other) > 0.002


@pytest.mark.parametrize(("aside", "told"), [(0.03, True), (-0.03, True), (0.5, False)])
def test_a_glide_curls_but_by_little(aside: float, told: bool) -> None:
    times = np.arange(-20, 21) / 25
    curls = np.column_stack([0.8 * times - 0.05 * times**2, 0.5 * aside * times**2])
    assert np.allclose(glide(times, curls), curls, atol=0.002) == told


def test_a_stone_on_which_a_camera_zooms_is_no_graphic() -> None:
    """It stays in the picture, and on the ice as well."""
    times = np.arange(60) / 25
    cameras = cameras_of(times, np.zeros(60), 0.8 + 0.4 * smooth(times))
    places = np.random.default_rng(5).normal(0, 0.001, (60, 2))
    assert not is_graphic(track_of(times, places), cameras, STONE)


@pytest.mark.parametrize(
    ("px", "rms", "graphic"),
    [(0.5, 0.6, False), (0.5, 0.05, True), (0.15, 0.05, False), (0.15, np.nan, False)],
)
def test_cameras_are_known_as_well_as_edges_fit(px: float, rms: float, graphic: bool) -> None:
    """A stone under a still camera, whose motion was found a bit wrong, stays in the picture."""
    times = np.arange(60) / 25
    off = px / 100 * np.sin(3 * times)
    cameras = [replace(each, rms_px=rms) for each in cameras_of(times, off)]
    assert is_graphic(track_of(times, np.column_stack([off, 0 * off])), cameras, STONE) == graphic


@pytest.mark.parametrize(("own", "graphic"), [(0.0, True), (0.0006, False)])
def test_a_stone_under_a_still_camera_that_people_cover_is_no_graphic(
    own: float, graphic: bool
) -> None:
    """The views go astray by half a pixel, as they say; the stone stays in the picture."""
    times = np.arange(60) / 30
    astray = np.random.default_rng(4).normal(0, 0.004, 60)
    places = np.column_stack([1.0 + astray, np.full(60, 0.5)])
    cov = np.diag([own**2] * 3 + [0.0] * 6)
    cameras = [
        replace(
            camera, f_px=800.0, position=np.array([x, 0.0, 8.0]), error=CameraError(0 * cov, cov)
        )
        for camera, x in zip(cameras_of(times, astray), astray, strict=True)
    ]
    assert is_graphic(track_of(times, places), cameras, STONE) == graphic
