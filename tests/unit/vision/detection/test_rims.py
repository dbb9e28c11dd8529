from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.rims import RADIUS, RAYS, rim_of
from curlshot.vision.detection.rays import directions
from curlshot.vision.detection.rims import Bands, Rim, falls_along, summed


def test_edges_lie_where_the_light_goes_out_and_what_is_far_off_is_another_edge() -> None:
    true = RADIUS + 0.006 * np.cos(directions(RAYS)[0])
    rays, rim = rim_of(true, np.ones(RAYS, bool))
    expected = np.full((1, 1, RAYS), RADIUS)
    edge, strength = Bands.of([rim], rays).edges(expected)
    np.testing.assert_allclose(edge[0, 0], true, atol=0.0004)
    assert strength.min() > 100
    # With two edges on each ray, the one that is expected is taken.
    farther, _ = rim_of(true + 0.03, np.ones(RAYS, bool))
    both = (rays.lab // 2 + farther.lab // 2).astype(np.float32)
    rim = Rim(falls_along(both)[..., 0], rim.use, rim.inside, RADIUS, 0.02, 2.0, np.ones(1))
    near, _ = Bands.of([rim], rays).edges(true[None, None])
    np.testing.assert_allclose(near[0, 0], true, atol=0.0006)


def test_beyond_the_picture_there_are_no_edges() -> None:
    inside = np.arange(RAYS) < 20
    rays, rim = rim_of(np.full(RAYS, RADIUS), inside)
    _, strength = Bands.of([rim], rays).edges(np.full((1, 1, RAYS), RADIUS))
    np.testing.assert_array_equal(strength[0, 0] > 1, inside)


def test_falls_are_slopes_downwards() -> None:
    ramp = np.broadcast_to(100 - 2.5 * np.arange(40.0)[:, None], (1, 12, 40, 2))
    falls = falls_along(ramp.astype(np.float32))
    np.testing.assert_allclose(falls[:, :, 8:-8], 2.5, atol=1e-4)
    np.testing.assert_array_equal(summed(np.ones((2, 3, 7), bool)), np.full((2, 3), 7.0))
