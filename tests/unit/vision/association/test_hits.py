from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from curlshot.vision.association.hits import RESTITUTION, struck

R = 0.1455


def met(
    places: Sequence[tuple[float, float]], t: float, told: tuple[bool, bool] = (True, True)
) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """Say where two stones are at t that were seen at 0; the first moves down at 2 m/s."""
    velocities = np.array([(0.0, -2.0), (0.0, 0.0)])
    return struck(np.array(places), velocities, np.zeros(2), np.array(told), t, R)


def test_full_on_the_struck_stone_takes_most_of_the_speed() -> None:
    out = met([(0.0, 1.0), (0.0, 1.0 - 2 * R - 0.1)], 0.15)  # they meet at 0.05 s
    (place, velocity), (there, speed) = out[0], out[1]
    given = 0.5 * (1 + RESTITUTION) * 2.0
    assert speed == pytest.approx([0, -given])
    assert velocity == pytest.approx([0, given - 2.0])
    assert there == pytest.approx([0, 0.9 - 2 * R - given * 0.1])
    assert place == pytest.approx([0, 0.9 - (2.0 - given) * 0.1])


def test_aslant_the_struck_stone_goes_along_the_line_of_centres() -> None:
    aside = R  # half a diameter: thirty degrees
    out = met([(0.0, 1.0), (aside, 0.3)], 1.0)
    velocity, speed = out[0][1], out[1][1]
    normal = np.array([0.5, -np.sqrt(0.75)])
    assert speed == pytest.approx(0.5 * (1 + RESTITUTION) * (2 * np.sqrt(0.75)) * normal)
    assert velocity + speed == pytest.approx([0, -2.0])  # equal masses


def test_of_two_stones_in_its_way_it_hits_the_nearer_one() -> None:
    places = np.array([(0.0, 1.0), (0.0, 0.2), (0.0, 0.6)])
    velocities = np.array([(0.0, -2.0), (0.0, 0.0), (0.0, 0.0)])
    assert struck(places, velocities, np.zeros(3), np.ones(3, bool), 0.3, R).keys() == {0, 2}


def test_stones_that_were_seen_at_two_times_meet_as_if_seen_at_one() -> None:
    velocities, told = np.array([(0.0, -2.0), (0.3, 0.5)]), np.ones(2, bool)
    places, since = np.array([(0.0, 1.0), (-0.1, 0.3)]), np.array([0.0, 0.1])
    out = struck(places, velocities, since, told, 0.4, R)
    at_once = places - since[:, None] * velocities
    for index, known in struck(at_once, velocities, np.zeros(2), told, 0.4, R).items():
        assert np.array(out[index]) == pytest.approx(np.array(known))
    assert out.keys() == {0, 1}


@pytest.mark.parametrize(
    ("aside", "t", "told"),
    [
        (2 * R + 0.01, 1.0, (True, True)),  # they pass
        (0.0, 0.04, (True, True)),  # not yet
        (0.0, 1.0, (True, False)),  # seen too little to say
        (0.0, -1.0, (True, True)),  # followed back
    ],
)
def test_no_hit_is_expected(aside: float, t: float, told: tuple[bool, bool]) -> None:
    places = [(0.0, 1.0), (aside, 1.0 - 2 * R - 0.1)]
    assert not met(places, t, told)
