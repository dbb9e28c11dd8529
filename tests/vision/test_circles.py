from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from vision.circles import Fits, Rim, falls_along, fit_circles, summed
from vision.rays import Rays, directions

RADIUS, RAYS = 0.14, 48
STEPS = np.linspace(0.08, 0.20, 61)


def rim_of(edge: np.ndarray, inside: np.ndarray) -> tuple[Rays, Rim]:
    """Rays from one place on which the light goes out at these radii, shape (rays,), m."""
    light = 200 / (1 + np.exp((STEPS - edge[:, None]) / 0.002))
    lab = np.repeat(light[None, :, :, None], 3, axis=-1).astype(np.float32)
    shown = np.repeat(inside[None, :, None], len(STEPS), axis=2)
    bgr = lab.astype(np.uint8)
    rays = Rays(bgr, bgr, shown, STEPS, directions(RAYS)[0])
    use = inside[None]
    fall = falls_along(lab)[..., 0]
    return rays, Rim(fall, use, use, RADIUS, 0.02, 2.0, np.ones(1))


def fitted(edge: np.ndarray, inside: np.ndarray) -> Fits:
    rays, rim = rim_of(edge, inside)
    return fit_circles(rays, (rim,), slack=0.05, reach=0.035, noise=np.array([0.0005]))


@settings(deadline=None, max_examples=30)
@given(x=st.floats(-0.01, 0.01), y=st.floats(-0.01, 0.01), growth=st.floats(-0.004, 0.004))
def test_a_circle_aside_is_found_where_it_is(x: float, y: float, growth: float) -> None:
    around = directions(RAYS)[1]
    along = around @ [x, y]
    edge = along + np.sqrt(along**2 - x * x - y * y + (RADIUS + growth) ** 2)
    fits = fitted(edge, np.ones(RAYS, bool))
    assert fits.ok[0]
    np.testing.assert_allclose(fits.shift[0], (x, y), atol=0.0008)
    np.testing.assert_allclose(fits.radii[0, 0], RADIUS + growth, atol=0.0015)
    assert fits.shares[0, 0] > 0.9


def test_what_covers_a_part_of_the_circle_does_not_draw_it_aside() -> None:
    edge = np.full(RAYS, RADIUS)
    edge[:10] = 0.125
    fits = fitted(edge, np.ones(RAYS, bool))
    assert np.hypot(*fits.shift[0]) < 0.001
    assert abs(fits.shares[0, 0] - 38 / 48) < 0.03


def test_half_a_circle_is_known_less_well_across() -> None:
    inside = directions(RAYS)[1][:, 0] > 0.1
    fits = fitted(np.full(RAYS, RADIUS), inside)
    assert fits.ok[0]
    sd = np.sqrt(np.diag(fits.covariance[0]))
    assert sd[0] > 1.3 * sd[1]
    inside[:] = False
    inside[:6] = True
    assert not fitted(np.full(RAYS, RADIUS), inside).ok[0]


def test_falls_are_slopes_downwards() -> None:
    ramp = np.broadcast_to(100 - 2.5 * np.arange(40.0)[:, None], (1, 12, 40, 2))
    falls = falls_along(ramp.astype(np.float32))
    np.testing.assert_allclose(falls[:, :, 8:-8], 2.5, atol=1e-4)
    np.testing.assert_array_equal(summed(np.ones((2, 3, 7), bool)), np.full((2, 3), 7.0))
