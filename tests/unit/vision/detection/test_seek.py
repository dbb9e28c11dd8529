from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.data.sheet import STONE, Stone
from curlshot.vision.detection.appearance import BY_SHAPE
from curlshot.vision.detection.seek import _filtered, seek, seek_about
from curlshot.vision.optics.camera import Camera

SIZE = (640, 480)
SCALE = 110.0
BOUNDS = (-2.2, 2.2, -1.8, 1.8)
PLACES = np.array([(-1.2, 0.7), (0.3, -0.9), (1.1, 0.6), (1.1, 0.3)])
PUCK = replace(STONE, cap_radius=0.0, cap_height=0.0)
ABOVE = Camera(
    0, 0.0,
    np.array([[SCALE, 0, (SIZE[0] - 1) / 2], [0, -SCALE, (SIZE[1] - 1) / 2], [0, 0, 1.0]]), SIZE,
)  # fmt: skip


def picture(disc: Stone, places: np.ndarray = PLACES) -> np.ndarray:
    """Discs seen from straight above, drawn four times as large and shrunk."""
    image = np.full((4 * SIZE[1], 4 * SIZE[0], 3), (235, 232, 228), np.uint8)
    for place in places:
        x, y = np.round(4 * (ABOVE.project(place) + 0.5)).astype(int).tolist()
        cv2.circle(image, (x, y), round(4 * SCALE * disc.radius), (112, 120, 122), -1)
        cv2.circle(image, (x, y), round(4 * SCALE * disc.cap_radius), (40, 26, 178), -1)
    return np.asarray(cv2.resize(image, SIZE, interpolation=cv2.INTER_AREA), np.uint8)


def nearest(found: np.ndarray) -> np.ndarray:
    return np.asarray(np.hypot(*(PLACES[:, None] - found).transpose(2, 0, 1)).min(1))


@pytest.mark.parametrize(("disc", "least"), [(STONE, 0.8), (PUCK, 0.6)])
def test_every_disc_is_among_the_strongest(disc: Stone, least: float) -> None:
    found = seek(picture(disc), ABOVE, None, disc, BOUNDS, radius_px=10.0, least=least)
    assert nearest(found.places[: len(PLACES)]).max() < 0.02
    assert (found.appearance is None) == (disc is PUCK)


@pytest.mark.parametrize("paint", [(235, 232, 228), (150, 60, 70), (60, 60, 60)])
def test_without_a_colour_discs_are_sought_by_their_circles(paint: tuple[int, int, int]) -> None:
    """On ice, on paint and on paint as dark as the caps."""
    image = picture(STONE)
    image[(image == (235, 232, 228)).all(2)] = paint
    image[(image[..., 2] > 150) & (image[..., 0] < 80)] = (60, 60, 60)
    found = seek(image, ABOVE, BY_SHAPE, STONE, BOUNDS, radius_px=10.0, least=0.45)
    assert nearest(found.places).max() < 0.02


def test_by_their_own_colours_discs_are_sought_that_no_table_of_colours_tells() -> None:
    """A table that says of every colour that it is neither cap nor granite."""
    blank = replace(BY_SHAPE, membership=np.zeros((64, 64, 64), np.float32))
    for look, furthest in ((blank, 0.02), (replace(blank, own=False), np.inf)):
        found = seek(picture(STONE), ABOVE, look, STONE, BOUNDS, radius_px=10.0, least=0.45)
        assert (len(found.places) > 0) == look.own
        if look.own:
            assert nearest(found.places).max() < furthest
    aside = PLACES + np.array([0.05, -0.03])
    about = seek_about(picture(STONE), ABOVE, aside, blank, STONE, radius_px=10.0, reach=0.8)
    assert np.hypot(*(about - PLACES).T).max() < 0.03


def test_bare_ice_holds_none() -> None:
    bare = picture(STONE, PLACES[:0])
    assert len(seek(bare, ABOVE, None, STONE, BOUNDS, radius_px=10.0, least=0.8).places) == 0


def test_outside_the_picture_is_none() -> None:
    far = (30.0, 31.0, 30.0, 31.0)
    found = seek(picture(STONE), ABOVE, None, STONE, far, radius_px=10.0, least=0.8)
    assert found.places.shape == (0, 2)


def test_nothing_is_sought_by_colour_in_a_picture_without_light() -> None:
    black = np.zeros_like(picture(STONE))
    assert len(seek(black, ABOVE, None, STONE, BOUNDS, radius_px=10.0, least=0.1).places) == 0


@pytest.mark.parametrize("disc", [STONE, PUCK])
def test_by_its_circles_no_disc_answers_by_more_than_two(disc: Stone) -> None:
    image = picture(disc)
    places = [
        seek(image, ABOVE, BY_SHAPE, disc, BOUNDS, radius_px=10.0, least=least).places
        for least in (0.5, 2.0)
    ]
    assert len(places[0]) >= len(PLACES) and len(places[1]) == 0


def test_a_disc_is_found_about_where_it_is_expected() -> None:
    image = picture(STONE)
    looks = seek(image, ABOVE, None, STONE, BOUNDS, radius_px=10.0, least=0.8).appearance
    aside = PLACES + 0.06 * np.array([(1, 0), (0, -1), (-0.7, 0.7), (-0.7, -0.7)])
    found = seek_about(image, ABOVE, aside, looks, STONE, radius_px=10.0, reach=0.8)
    assert np.linalg.norm(found - PLACES, axis=1).max() < 0.01


@pytest.mark.parametrize("half", [3, 7, 9])  # directly, and by Fourier transforms
def test_maps_are_correlated_alike_by_either_way(half: int) -> None:
    rng = np.random.default_rng(3)
    values = rng.normal(size=(31, 26)).astype(np.float32)
    kernel = rng.normal(size=(2 * half + 1, 2 * half + 1)).astype(np.float32)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(values, half), kernel.shape)
    told = np.einsum("ijkl,kl->ij", windows.astype(float), kernel)
    np.testing.assert_allclose(_filtered(values, kernel), told, atol=1e-4)
