from math import erf

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.data.sheet import STONE
from curlshot.vision.detection.mixture import GAMMA, CapRays, by_light
from curlshot.vision.detection.rays import Rays, directions
from curlshot.vision.video.colour import lab_of

Array = NDArray[np.float64]

RADIUS = np.linspace(0.0291, 0.1542, 44)
RAYS = 48
SLANT = 0.8
BEHIND = SLANT * directions(RAYS)[1][:, 1]
ALONG = 0.011
PIXEL = ALONG / (1 + SLANT**2) ** 0.25
FAR = BEHIND > 0.7 * SLANT
RING = slice(31, 39)
CAP, GRANITE, ICE = 30.0, 120.0, 236.0


def ramp(end: float, blur: float) -> Array:
    return np.array([0.5 + 0.5 * erf((r - end) / (blur * 2**0.5)) for r in RADIUS])


SLIM = np.array([(0.113, 0.009), (0.125, 0.022), (0.140, 0.040), (0.1455, 0.057)])
REAL = np.array([(0.1228, 0.0066), (0.130, 0.010), (0.1338, 0.0147), (0.1411, 0.027)])
AROUND = np.linspace(0.0, np.pi / 2, 200)
ROUND = np.stack([0.1055 + 0.04 * np.cos(AROUND), 0.063 - 0.057 * np.sin(AROUND)], axis=1)
"""Radii of the granite's shoulder and how far they lie below the cap's edge, m."""


def drawn(shoulder: Array, power: float = GAMMA, aside: float = 0.0) -> Rays:
    """Give the codes of a cap, the granite that is seen of a shoulder, and ice."""
    cap, granite, ice = (np.array([c]) ** power for c in (CAP, GRANITE, ICE))
    away = aside * directions(RAYS)[1][:, 1]
    light = np.empty((RAYS, len(RADIUS)))
    for k in range(RAYS):
        seen = (shoulder @ [1.0, -BEHIND[k]]).max() - STONE.cap_radius
        end, width = STONE.cap_radius + away[k], max(seen, 0.0) if BEHIND[k] > 0.2 else 0.2
        first, last = ramp(end, 0.7 * ALONG), ramp(end + width, 0.7 * ALONG)
        light[k] = cap + (granite - cap) * first + (ice - granite) * last
    codes = np.rint(light ** (1 / power))
    bgr = np.repeat(codes[None, ..., None], 3, axis=-1).astype(np.uint8)
    inside = np.ones(bgr.shape[:-1], bool)
    lab = lab_of(bgr.reshape(1, -1, 3)).reshape(bgr.shape)
    return Rays(bgr, lab, inside, RADIUS, directions(RAYS)[0])


def ends(signal: Array) -> Array:
    after = (signal < 0).argmax(1)
    high, low = (np.take_along_axis(signal, (after - k)[:, None], 1)[:, 0] for k in (1, 0))
    step = RADIUS[1] - RADIUS[0]
    return np.asarray(RADIUS[after - 1] + step * high / (high - low) - STONE.cap_radius)


def told(rays: Rays) -> Array:
    cap = np.ones((1, RAYS, 20), bool)
    ring = np.ones((1, RAYS, 8), bool) & (BEHIND < 0.2)[:, None]
    pixel = np.array([PIXEL])
    seen = CapRays(rays, rays, BEHIND[None], cap, RING, ring, STONE.cap_radius, pixel)
    return np.asarray(by_light(seen, STONE)[0])


def half_way(rays: Rays) -> Array:
    return np.asarray((CAP + GRANITE) / 2 - rays.bgr[0, ..., 0].astype(float))


@pytest.mark.parametrize("shoulder", [SLIM, ROUND, REAL])
def test_a_black_cap_ends_where_it_does_however_full_the_granite_s_shoulders_are(
    shoulder: Array,
) -> None:
    assert np.abs(ends(told(drawn(shoulder, power=GAMMA)))[FAR]).max() < 0.0015


@pytest.mark.parametrize("shoulder", [SLIM, ROUND, REAL])
def test_where_light_was_blurred_or_codes_it_lies_between(shoulder: Array) -> None:
    light, codes = (ends(told(drawn(shoulder, power=power)))[FAR] for power in (2.2, 1.0))
    assert (light < codes).all()
    assert light.min() > -0.4 * ALONG
    assert codes.max() < 0.4 * ALONG


def test_half_way_to_the_granite_lies_within_a_black_cap() -> None:
    assert ends(half_way(drawn(SLIM)))[FAR].mean() < -0.004


@pytest.mark.parametrize("aside", [-0.012, 0.012])
def test_a_cap_is_found_that_is_not_where_it_is_looked_for(aside: float) -> None:
    around = directions(RAYS)[1][FAR, 1]
    found = ends(told(drawn(SLIM, aside=aside)))[FAR]
    np.testing.assert_allclose(found, aside * around, atol=0.002)


def test_near_edges_are_half_way_in_light() -> None:
    assert np.abs(ends(told(drawn(ROUND)))[BEHIND < -0.3]).max() < 0.0005


def test_rays_that_show_something_else_say_what_they_did() -> None:
    rays = drawn(ROUND)
    for far in np.flatnonzero(FAR):
        rays.bgr[0, far, 25:35] = 30
        rays.bgr[0, far, 36:39] = 230
    light = (rays.bgr[0, ..., 0] / 255.0) ** GAMMA
    plain = 0.5 - (light - light[0, 0]) / (light[BEHIND < -0.3, 35].mean() - light[0, 0])
    np.testing.assert_allclose(told(rays)[FAR], plain[FAR], rtol=0.02, atol=0.02)
