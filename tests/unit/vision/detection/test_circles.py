from __future__ import annotations

from dataclasses import astuple, replace

import numpy as np

from curlshot.tests.helpers.vision.circles import fitted
from curlshot.tests.helpers.vision.rims import RADIUS, RAYS, rim_of
from curlshot.vision.detection.circles import fit_circles
from curlshot.vision.detection.rays import directions


def test_what_covers_a_part_of_the_circle_does_not_draw_it_aside() -> None:
    edge = np.full(RAYS, RADIUS)
    edge[:10] = 0.125
    fits = fitted(edge, np.ones(RAYS, bool))
    assert np.hypot(*fits.shift[0]) < 0.001
    assert abs(fits.shares[0, 0] - 38 / 48) < 0.03


def test_places_are_fitted_alike_one_by_one_and_several_together() -> None:
    edge = RADIUS + 0.003 * directions(RAYS)[1][:, 0]
    rays, rim = rim_of(edge, np.arange(RAYS) < 40, np.full((1, RAYS), 0.2))
    noise, walls = np.array([0.0005, 0.0005, 0.002]), np.array([0.004, 0.001, 0.004])
    three = np.zeros(3, np.intp)
    together = fit_circles(
        rays.at_places(three), (rim.at_places(three),), 0.05, 0.035, noise, wall=(0.001, walls)
    )
    for k in range(3):
        alone = fit_circles(rays, (rim,), 0.05, 0.035, noise[k : k + 1], wall=(0.001, walls[k]))
        for one, all_three in zip(astuple(alone), astuple(together), strict=True):
            np.testing.assert_allclose(all_three[k], one[0], rtol=1e-9, atol=1e-12)
    later = together.at_places(slice(1, None))
    np.testing.assert_array_equal(later.shift, together.shift[1:])
    assert abs(later.wall[0] - together.wall[0]) > 1e-5


def test_what_agrees_on_one_side_is_told_from_as_much_here_and_there() -> None:
    everywhere = np.ones(RAYS, bool)
    edge = np.full(RAYS, RADIUS)
    assert fitted(edge, everywhere).unbroken[0] > 0.9
    one_side, scattered = edge.copy(), edge.copy()
    one_side[:24] = 0.16
    scattered[0::4] = scattered[1::4] = 0.16
    across = np.roll(one_side, 36)  # seen on either side of where rays begin
    seen = [float(fitted(e, everywhere).unbroken[0]) for e in (one_side, across, scattered)]
    np.testing.assert_allclose(seen[:2], 0.5, atol=0.07)
    assert seen[2] < 0.2


def test_half_a_circle_is_known_less_well_across() -> None:
    inside = directions(RAYS)[1][:, 0] > 0.1
    fits = fitted(np.full(RAYS, RADIUS), inside)
    assert fits.ok[0]
    sd = np.sqrt(np.diag(fits.covariance[0]))
    assert sd[0] > 1.3 * sd[1]
    inside[:] = False
    inside[:6] = True
    assert not fitted(np.full(RAYS, RADIUS), inside).ok[0]


def test_a_wall_seen_on_the_near_side_does_not_draw_the_circle_there() -> None:
    tilt, wall = 1.3, 0.007
    seen = tilt * np.maximum(directions(RAYS)[1] @ [0.0, -1.0], 0)
    edge, everywhere = RADIUS + wall * seen, np.ones(RAYS, bool)
    assert fitted(edge, everywhere).shift[0, 1] < -0.004
    fits = fitted(edge, everywhere, seen[None])
    np.testing.assert_allclose(fits.shift[0], 0, atol=0.0015)
    np.testing.assert_allclose(fits.radii[0, 0], RADIUS, atol=0.0015)
    # From above, what is known of walls beforehand counts, and little depends on it.
    above = fitted(np.full(RAYS, RADIUS), everywhere, 0.1 * seen[None] / tilt)
    np.testing.assert_allclose(above.shift[0], 0, atol=0.0003)


def test_a_wall_whose_height_is_known_is_held_to_it() -> None:
    seen = 1.3 * np.maximum(directions(RAYS)[1] @ [0.0, -1.0], 0)
    rays, rim = rim_of(RADIUS + 0.007 * seen, np.ones(RAYS, bool), seen[None])
    noise = np.array([0.0005])
    free, held, none = (
        fit_circles(rays, (rim,), 0.05, 0.035, noise, wall=(height, sd))
        for height, sd in ((0.0, 0.004), (0.007, 1e-5), (0.0, 1e-5))
    )
    np.testing.assert_allclose(free.wall, 0.007, atol=0.0015)
    np.testing.assert_allclose(held.wall, 0.007, atol=1e-4)
    np.testing.assert_allclose(held.shift, 0, atol=0.001)
    assert none.shift[0, 1] < -0.004


def test_bends_are_the_waves_of_the_edge_about_its_circle() -> None:
    angle = directions(RAYS)[0]
    edge = RADIUS + 0.002 * np.cos(3 * angle) - 0.001 * np.sin(2 * angle)
    fits = fitted(edge, np.ones(RAYS, bool))
    np.testing.assert_allclose(fits.bends[0], [0, 0.002, 0, -0.001, 0, 0], atol=0.0003)
    np.testing.assert_allclose(fits.shift[0], 0, atol=0.0003)


def test_a_circle_that_says_little_hardly_draws_the_centre_to_its_own() -> None:
    everywhere, aside = np.ones(RAYS, bool), 0.006
    rays, inner = rim_of(np.full(RAYS, RADIUS), everywhere)
    _, outer = rim_of(RADIUS + aside * directions(RAYS)[1][:, 0], everywhere)
    noise = np.array([0.0005])
    alike, less = (
        fit_circles(rays, (inner, replace(outer, say=say)), 0.05, 0.035, noise)
        for say in (1.0, 0.1)
    )
    assert abs(alike.shift[0, 0] - aside / 2) < 0.001
    assert abs(less.shift[0, 0]) < 0.001
    # Whether there are circles is asked of both.
    np.testing.assert_allclose(less.shares, alike.shares)
