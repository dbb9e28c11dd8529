from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.association.lead import DECELERATION, MEMORY, STEADY, Lead
from curlshot.vision.video.disk_cache import Cached

NEAR, STILL = 0.02, 0.004


def followed(places: list[tuple[float, float]], step: float = 0.04) -> Lead:
    lead = Lead.to(detection(places[0]), 0.0)
    for count, place in enumerate(places[1:], 1):
        lead = lead.on(detection(place), count * step, NEAR, STILL)
    return lead


@pytest.mark.parametrize("step", [0.04, -0.04])
def test_a_lead_points_to_where_a_stone_glides_to_or_came_from(step: float) -> None:
    start, velocity, slower = np.array([0.1, 0.0]), np.array([0.5, -1.2]), DECELERATION / 1.3

    def glided(t: float) -> tuple[float, float]:
        x, y = start + velocity * (t - 0.5 * slower * t**2)
        return float(x), float(y)

    lead = followed([glided(step * k) for k in range(12)], step)
    np.testing.assert_allclose(lead.velocity, velocity * (1 - slower * 11 * step), rtol=0.002)
    np.testing.assert_allclose(lead.at(20 * step), glided(20 * step), atol=1e-3)
    assert not lead.rests


def test_a_lead_goes_by_all_that_was_seen_on_its_course_of_late() -> None:
    at, ahead = np.arange(MEMORY), 8
    noise = np.random.default_rng(5).normal(0, 0.001, (500, MEMORY))
    leads = [followed([(x, 0.0) for x in row]) for row in (0.02 * at + noise).tolist()]
    expected = [lead.place[0] + ahead * 0.04 * lead.velocity[0] for lead in leads]
    # A straight line fitted to so many places is as unsure so far beyond them.
    beyond = MEMORY - 1 + ahead - at.mean()
    sd = 0.001 * np.sqrt(1 / MEMORY + beyond**2 / ((at - at.mean()) ** 2).sum())
    assert np.std(expected) == pytest.approx(sd, rel=0.1)


def test_a_new_course_is_taken_at_once() -> None:
    lead = followed([*((0.0, -0.05 * k) for k in range(8)), (0.1, -0.35)])
    assert lead.place == (0.1, -0.35)
    np.testing.assert_allclose(lead.velocity, (2.5, 0.0), atol=0.05)


def test_the_place_of_a_stone_that_stays_is_told_by_all_that_was_seen_of_it_of_late() -> None:
    lead = followed([(0.3, 0.2)] * (MEMORY - 1) + [(0.303, 0.2)])
    at = np.arange(MEMORY)
    line = np.polyfit(at, 0.003 * (at == at[-1]), 1)
    assert lead.place == pytest.approx((0.3 + np.polyval(line, at[-1]), 0.2))


def test_a_stone_that_stays_rests_until_it_leaves() -> None:
    places = [(0.3, 0.2)] * STEADY
    assert not followed(places).rests
    resting = followed([*places, (0.301, 0.2)])
    assert resting.rests and resting.anchor == (0.3, 0.2)
    gone = followed([*places, (0.3, 0.2), (0.3, 0.21)])
    assert not gone.rests and gone.anchor == (0.3, 0.21)


def test_what_is_half_covered_tells_not_that_a_stone_has_left_nor_that_it_rests() -> None:
    lead = followed([(0.3, 0.2)] * (STEADY + 1))
    aside = detection((0.3, 0.21))
    covered = aside._replace(score=0.8 * aside.score)
    half = lead.on(covered, 1.0, NEAR, STILL)
    assert half.rests and half.anchor == (0.3, 0.2) and half.steady == lead.steady
    assert not lead.on(aside, 1.0, NEAR, STILL).rests


def test_a_stone_found_anew_rests_if_it_did_before() -> None:
    new = Lead.to(detection((0.3, 0.2)), 1.0)
    back = [followed([(0.3, 0.2)] * (STEADY + 1), -0.04), followed([(0.3, 0.2), (0.3, 0.3)])]
    assert new.if_rested(back).rests
    assert not new.if_rested(back[1:]).rests
    assert not Lead.to(detection((0.3, 0.5)), 1.0).if_rested(back).rests


def test_a_cap_that_turns_on_the_spot_does_not_rest() -> None:
    rng = np.random.default_rng(3)
    cap = rng.normal(0, 1, (17, 4, 3)) + 1j * rng.normal(0, 1, (17, 4, 3))

    def facing(angle: float) -> np.ndarray:
        return (cap * np.exp(-1j * np.arange(1, 18) * angle)[:, None, None]).astype(np.complex64)

    for spin, rests in ((0.0, True), (0.5, False)):
        lead = Lead.to(detection((0.3, 0.2))._replace(spectrum=Cached(facing(0.0))), 0.0)
        for count in range(1, STEADY + 2):
            t = count / 25
            seen = detection((0.3, 0.2))._replace(spectrum=Cached(facing(spin * t)))
            lead = lead.on(seen, t, NEAR, STILL)
        assert lead.rests is rests


@pytest.mark.parametrize("t", [0.3, -0.3])
def test_a_lead_expects_the_ice_to_slow_a_stone(t: float) -> None:
    place = Lead((0.0, 0.0), (0.0, -2.0), 0.0, (0.0, 0.0), 2.0).at(t)
    np.testing.assert_allclose(place, (0.0, -2.0 * t + 0.5 * DECELERATION * t**2))


def test_a_lead_expects_no_stone_to_turn_back() -> None:
    crawling = Lead((0.0, 0.0), (0.01, 0.0), 0.0, (0.0, 0.0), 2.0)
    assert crawling.at(5.0) == crawling.at(0.1) == pytest.approx((0.5 * 0.01**2 / DECELERATION, 0))


@pytest.mark.parametrize(
    ("place", "near"),
    [
        ((0.4, 1.0), True),  # beside its way
        ((0.6, 1.0), False),
        ((0.0, 3.2), True),  # beyond where it is 1.5 s later, 2.9 m on
        ((0.0, 3.6), False),
        ((0.3, -0.3), True),
        ((0.0, -0.6), False),  # behind it
    ],
)
def test_a_stone_nears_what_is_beside_its_way_ahead(place: tuple[float, float], near: bool) -> None:
    comes = Lead((0.0, -2.0), (0.0, 2.0), 0.0, (0.0, -2.0), 2.0)
    then = 1.0263  # it is at (0, 0) then
    assert comes.nears(place, then, 0.5) is near
    rests = Lead((0.0, 0.0), (0.0, 0.0), 0.0, (0.0, 0.0), 2.0)
    assert rests.nears(place, 0.0, 0.5) is bool(np.hypot(*place) < 0.5)
