from math import erf

import numpy as np
import pytest
from numpy.typing import NDArray

from data.sheet import STONE
from vision.detection.contrast import by_hue
from vision.detection.rays import Rays, directions
from vision.detection.shoulder import against_beyond
from vision.film.lab import lab_of

Array = NDArray[np.float64]

GREEN, RED, GRANITE, ICE, NAVY = (
    np.array(bgr, float)
    for bgr in ([60, 130, 25], [40, 40, 200], [125, 130, 130], [238, 240, 236], [120, 40, 20])
)
RADIUS = np.linspace(0.03, 0.15, 121)
BLUR = 0.006
RAYS = 32
BEHIND = 1.2 * directions(RAYS)[1][:, 0]
WITHIN = int(np.searchsorted(RADIUS, 0.88 * STONE.cap_radius))


def seen(cap: Array, strip: float, beyond: Array, blur: float = BLUR) -> tuple[Array, Rays]:
    """Give a cap, granite `strip` wide (m) and what is beyond, blurred."""
    ends = STONE.cap_radius, STONE.cap_radius + strip
    past = [
        np.array([0.5 + 0.5 * erf((r - end) / (blur * 2**0.5)) for r in RADIUS])[:, None]
        for end in ends
    ]
    mixed = cap + past[0] * (GRANITE - cap) + past[1] * (beyond - GRANITE)
    bgr = np.tile(np.round(mixed).astype(np.uint8), (1, RAYS, 1, 1))
    lab = lab_of(bgr[0])[None]
    colours = lab_of(np.array([[cap, GRANITE]], np.uint8))[0].astype(float)
    along = by_hue(colours[:1], colours[1:])[0]
    signal = (lab @ along - colours[1] @ along - 0.5).astype(np.float32)
    inside = np.ones(bgr.shape[:-1], bool)
    return signal, Rays(bgr, lab, inside, RADIUS, directions(RAYS)[0])


def ends(signal: Array) -> Array:
    """Radii at which signals on rays fall below 0, m."""
    after = (signal < 0).argmax(1)
    high, low = (np.take_along_axis(signal, (after - k)[:, None], 1)[:, 0] for k in (1, 0))
    return np.asarray(RADIUS[after - 1] + (RADIUS[1] - RADIUS[0]) * high / (high - low))


def told(cap: Array, strip: float, beyond: Array, blur: float = BLUR) -> tuple[Array, Array]:
    signal, rays = seen(cap, strip, beyond, blur)
    of_cap = np.ones((1, RAYS, WITHIN), bool)
    new = against_beyond(signal, rays, BEHIND[None], of_cap, STONE, np.array([2 * blur]))
    return ends(signal[0]) - STONE.cap_radius, ends(new[0]) - STONE.cap_radius


@pytest.mark.parametrize("cap", [GREEN, RED])
@pytest.mark.parametrize("beyond", [ICE, NAVY])
def test_a_cap_ends_where_half_of_the_colour_is_of_what_lies_beyond(
    cap: Array, beyond: Array
) -> None:
    before, after = told(cap, 0.0, beyond)
    over = BEHIND > 1.0
    assert (np.abs(after[over]) < 0.0004).all()
    np.testing.assert_array_equal(after[BEHIND < 0.85], before[BEHIND < 0.85])


@pytest.mark.parametrize("beyond", [ICE, NAVY])
def test_the_coarser_pixels_are_the_farther_off_is_looked_at_what_lies_beyond(
    beyond: Array,
) -> None:
    _, after = told(RED, 0.0, beyond, blur=2 * BLUR)
    assert (np.abs(after[BEHIND > 1.0]) < 0.0012).all()


def test_where_what_lies_beyond_is_not_in_the_picture_the_granite_counts() -> None:
    signal, rays = seen(GREEN, 0.0, ICE)
    rays.inside[..., RADIUS > 0.11] = False
    of_cap = np.ones((1, RAYS, WITHIN), bool)
    new = against_beyond(signal, rays, BEHIND[None], of_cap, STONE, np.array([0.012]))
    np.testing.assert_array_equal(new, signal)


def test_of_a_cap_before_dark_paint_half_the_hue_lies_inside() -> None:
    before, _ = told(GREEN, 0.0, NAVY)
    assert (before < -0.3 * BLUR).all()


def test_granite_that_shows_after_all_tells_the_edge_as_elsewhere() -> None:
    before, after = told(RED, 0.018, ICE)
    np.testing.assert_allclose(after, before, atol=2e-4)


def test_a_cap_before_its_own_colour_is_left_as_it_is() -> None:
    signal, rays = seen(GREEN, 0.0, GREEN)
    of_cap = np.ones((1, RAYS, WITHIN), bool)
    new = against_beyond(signal, rays, BEHIND[None], of_cap, STONE, np.array([0.012]))
    np.testing.assert_array_equal(new, signal)


@pytest.mark.parametrize(("apart", "told"), [(25.0, False), (60.0, True)])
def test_what_is_much_like_the_cap_tells_no_edge(apart: float, told: bool) -> None:
    signal, rays = seen(GREEN, 0.0, GREEN + apart / 3**0.5)
    of_cap = np.ones((1, RAYS, WITHIN), bool)
    new = against_beyond(signal, rays, BEHIND[None], of_cap, STONE, np.array([0.012]))
    assert (new != signal).any() == told
