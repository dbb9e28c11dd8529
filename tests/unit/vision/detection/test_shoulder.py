from math import erf

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.data.sheet import STONE
from curlshot.vision.detection.contrast import by_hue
from curlshot.vision.detection.mixture import FULL, SLIM, CapRays
from curlshot.vision.detection.rays import Rays, directions
from curlshot.vision.detection.shoulder import against_beyond
from curlshot.vision.video.colour import lab_of
from curlshot.vision.video.picture import TO_CHROMA

Array = NDArray[np.float64]

GREEN, RED, GRANITE, ICE, NAVY = (
    np.array(bgr, float)
    for bgr in ([60, 130, 25], [40, 40, 200], [125, 130, 130], [238, 240, 236], [120, 40, 20])
)
RADIUS = np.linspace(0.0291, 0.1542, 44)
RAYS, SLANT, PIXEL = 32, 1.2, 0.013
BEHIND = SLANT * directions(RAYS)[1][:, 0]
ALONG = PIXEL * (1 + SLANT**2) ** 0.25
RING = slice(31, 39)
FAR = BEHIND > 1.0
LEAST, MOST = np.interp(SLANT, *SLIM), np.interp(SLANT, *FULL)
"""How much granite is seen on slim shoulders and on full ones, m."""


def past(end: float, blur: float) -> Array:
    return np.array([0.5 + 0.5 * erf((r - end) / (blur * 2**0.5)) for r in RADIUS])


def seen(
    cap: Array, strip: float, beyond: Array, chroma: float = 1.25, pixel: float = ALONG
) -> tuple[Array, Rays]:
    """Give a cap, granite `strip` wide (m) and what is beyond, chroma blurred by so many pixels."""
    first, second, third = (TO_CHROMA @ colour for colour in (cap, GRANITE, beyond))
    coded = np.empty((len(RADIUS), 3))
    for k, blur in enumerate((0.75, chroma, chroma)):
        ends = (past(STONE.cap_radius + width, blur * pixel) for width in (0.0, strip))
        one, two = ends
        coded[:, k] = first[k] + (second - first)[k] * one + (third - second)[k] * two
    bgr = np.rint(coded @ np.linalg.inv(TO_CHROMA).T).clip(0, 255).astype(np.uint8)
    bgr = np.tile(bgr, (1, RAYS, 1, 1))
    bgr[0, BEHIND < 0.2, RING] = GRANITE
    lab = lab_of(bgr[0])[None]
    colours = lab_of(np.array([[cap, GRANITE]], np.uint8))[0].astype(float)
    along = by_hue(colours[:1], colours[1:])[0]
    signal = (lab @ along - colours[1] @ along - 0.5).astype(np.float32)
    inside = np.ones(bgr.shape[:-1], bool)
    return signal, Rays(bgr, lab, inside, RADIUS, directions(RAYS)[0])


def made(signal: Array, rays: Rays, pixel: float = PIXEL) -> Array:
    of_cap = np.ones((1, RAYS, int(np.searchsorted(RADIUS, 0.88 * STONE.cap_radius))), bool)
    ring = np.ones((1, RAYS, 8), bool) & (BEHIND < 0.2)[:, None]
    seen = CapRays(
        rays, rays, BEHIND[None], of_cap, RING, ring, STONE.cap_radius, np.array([pixel])
    )
    return against_beyond(signal, seen, STONE)


def ends(signal: Array) -> Array:
    """How far beyond a cap's edge signals on far rays fall below 0, m."""
    far = signal[0, FAR]
    after = (far < 0).argmax(1)
    high, low = (np.take_along_axis(far, (after - k)[:, None], 1)[:, 0] for k in (1, 0))
    step = RADIUS[1] - RADIUS[0]
    return np.asarray(RADIUS[after - 1] + step * high / (high - low)) - STONE.cap_radius


@pytest.mark.parametrize("cap", [GREEN, RED])
@pytest.mark.parametrize("beyond", [ICE, NAVY])
def test_a_cap_ends_where_it_does_whatever_lies_beyond(cap: Array, beyond: Array) -> None:
    signal, rays = seen(cap, (LEAST + MOST) / 2, beyond)
    after = made(signal, rays)
    assert np.abs(ends(after)).max() < 0.001
    np.testing.assert_array_equal(after[0, BEHIND < 0.85], signal[0, BEHIND < 0.85])


@pytest.mark.parametrize("cap", [GREEN, RED])
@pytest.mark.parametrize("strip", [LEAST, MOST])
def test_with_shoulders_as_slim_or_full_as_occur_it_is_mm_aside(cap: Array, strip: float) -> None:
    off = [ends(made(*seen(cap, strip, beyond))).mean() for beyond in (ICE, NAVY)]
    assert np.abs(off).max() < 0.0085
    assert abs(off[0] - off[1]) < 0.005


def test_of_a_cap_before_dark_paint_half_the_hue_lies_inside() -> None:
    before, _ = seen(GREEN, 0.0, NAVY)
    assert (ends(before) < -0.3 * ALONG).all()


@pytest.mark.parametrize("beyond", [ICE, NAVY])
def test_coarser_pixels_blur_farther(beyond: Array) -> None:
    strip, coarse = (LEAST + MOST) / 2, 1.3
    off = ends(made(*seen(RED, strip, beyond, pixel=coarse * ALONG), coarse * PIXEL))
    assert np.abs(off).max() < 0.002


@pytest.mark.parametrize("chroma", [1.0, 1.5])
def test_how_far_chroma_is_blurred_hardly_matters(chroma: float) -> None:
    off = ends(made(*seen(RED, (LEAST + MOST) / 2, NAVY, chroma)))
    assert np.abs(off).max() < 0.002


def test_where_what_lies_beyond_is_not_in_the_picture_the_granite_counts() -> None:
    signal, rays = seen(GREEN, 0.0, ICE)
    rays.inside[..., RADIUS > 0.11] = False
    np.testing.assert_array_equal(made(signal, rays), signal)


def test_where_something_else_stands_before_the_edge_the_granite_counts() -> None:
    signal, rays = seen(RED, 0.005, NAVY)
    rays.bgr[0, :, (RADIUS > 0.09) & (RADIUS < 0.125)] = 250
    np.testing.assert_array_equal(made(signal, rays), signal)


def test_a_cap_before_its_own_colour_is_left_as_it_is() -> None:
    signal, rays = seen(GREEN, 0.0, GREEN)
    np.testing.assert_array_equal(made(signal, rays), signal)


@pytest.mark.parametrize(("apart", "told"), [(20.0, False), (60.0, True)])
def test_what_is_much_like_the_cap_tells_no_edge(apart: float, told: bool) -> None:
    signal, rays = seen(GREEN, 0.0, GREEN + apart)
    assert (made(signal, rays) != signal).any() == told


def test_the_step_is_as_wide_as_a_pixel_and_a_lens_make_it() -> None:
    after = made(*seen(RED, (LEAST + MOST) / 2, NAVY))[0, FAR]
    inner, outer = (
        np.array([np.interp(-level, -one, RADIUS) for one in after]) for level in (0.25, -0.25)
    )
    assert ((outer - inner > 0.8 * ALONG) & (outer - inner < 1.3 * ALONG)).all()
