from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.clip import render_still
from curlshot.synthetic.scene import Colour, Person
from curlshot.tests.helpers.vision.stones import (
    BLUE,
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    look,
    misses,
    scene_of,
    without_colours,
)  # fmt: skip  # fmt: skip
from curlshot.tests.helpers.vision.strangers import (
    BLACK,
    DULL,
    MAROON,
    PLACES,
    SLATE,
    WHITE,
    painted,
    seen,
)
from curlshot.vision.detection.appearance import CONVINCING
from curlshot.vision.detection.appearance import Colour as Granite
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import FOLLOWING, plain_disc
from curlshot.vision.detection.strangers import strangers, weighed


def test_black_and_white_caps_are_found() -> None:
    scene = painted(BLACK, WHITE, BLACK, WHITE)
    assert not look(scene)  # by colour none is told
    found = seen(scene)
    assert len(found) == len(scene.stones)
    assert misses(found, scene).max() < 0.010


def test_of_one_coloured_and_one_white_team_both_are_found() -> None:
    scene = painted(BLUE, WHITE, BLUE, WHITE)
    assert misses(seen(scene), scene).max() < 0.010
    assert len(seen(scene, PLACES[1:])) == 1  # nothing twice, and nothing of what is known


@pytest.mark.parametrize(("paint", "count"), [((225, 60, 200), 0), ((120, 122, 124), 4)])
def test_round_marks_on_vivid_paint_are_no_stones(paint: Colour, count: int) -> None:
    scene = painted(BLACK, WHITE, BLACK, WHITE)
    scene = replace(scene, stones=tuple(replace(one, granite=paint) for one in scene.stones))
    assert len(seen(scene)) == count


def test_dull_caps_are_found_beside_vivid_ones_by_what_they_differ_from_the_granite() -> None:
    scene = painted(BLUE, MAROON, BLUE, MAROON)
    assert len(look(scene)) == 2
    found = seen(scene)
    assert len(found) == len(scene.stones)
    assert misses(found, scene).max() < 0.010


@pytest.mark.parametrize("other", [BLACK, WHITE])
def test_black_and_white_caps_are_found_in_haze_beside_vivid_ones(other: Colour) -> None:
    scene = painted(YELLOW, other, YELLOW, other)
    found = seen(scene, contrast=0.45)
    assert len(found) == len(scene.stones)
    assert misses(found, scene).max() < 0.010


def test_caps_little_darker_than_granite_are_found_beside_light_ones() -> None:
    scene = painted(WHITE, DULL, WHITE, DULL)
    found = seen(scene)
    assert len(found) == len(scene.stones)
    assert misses(found, scene).max() < 0.010


def test_black_caps_in_light_granite_are_found_beside_vivid_ones_in_dark_granite() -> None:
    scene = painted(BLUE, (84, 84, 84), BLUE, (84, 84, 84))
    lit = [
        replace(stone, granite=(150, 152, 153) if stone.cap != BLUE else stone.granite)
        for stone in scene.stones
    ]
    scene = replace(scene, stones=tuple(lit))
    found = seen(scene)
    assert len(found) == len(scene.stones)
    assert misses(found, scene).max() < 0.010


def test_granite_that_others_have_makes_a_doubtful_stone_one() -> None:
    """Evidence by shape that convinces beside stones of such granite, and not alone."""
    scene = painted(BLUE, DULL, BLUE, DULL)
    image, camera = render_still(scene, CAMERA), camera_of(CAMERA, scene)
    (found,), _ = strangers([Look(image, camera, np.empty((0, 2)))], STONE, FOLLOWING)
    granite = Granite(np.array([118.0, 128.0, 128.0]), np.eye(3))
    doubtful = found.stones[0]._replace(score=1.5, granite_samples=np.tile(granite.mean, (9, 1)))
    assert weighed(doubtful, granite).score > CONVINCING > weighed(doubtful, None).score
    lighter = np.tile(granite.mean + np.array([40.0, 0, 0]), (9, 1))
    other = doubtful._replace(granite_samples=lighter)
    assert weighed(other, granite).score < CONVINCING


def test_dull_caps_of_both_teams_are_found() -> None:
    scene = painted(MAROON, SLATE, MAROON, SLATE)
    found = seen(scene)
    assert len(found) == len(scene.stones)
    assert misses(found, scene).max() < 0.010


def test_beside_one_vivid_team_no_person_in_dull_clothes_is_a_stone() -> None:
    scene = scene_of([(x, y, BLUE) for x, y in PLACES[:2]])
    people = tuple(
        Person(((0.0, x, y, 1.0),), shirt=MAROON, trousers=(96, 94, 92)) for x, y in PLACES[2:]
    )
    assert len(seen(replace(scene, people=people))) == 2


def test_caps_are_found_where_the_picture_has_lost_half_its_contrast() -> None:
    scene = painted(RED, YELLOW, BLUE, RED)
    found = seen(scene, contrast=0.5)
    assert len(found) == len(scene.stones)
    assert misses(found, scene).max() < 0.010


def test_pale_ice_without_stones_stays_empty() -> None:
    assert not seen(scene_of([]), contrast=0.5)


@pytest.mark.parametrize("third", [YELLOW, BLUE])
def test_two_colours_are_both_teams(third: Colour) -> None:
    scene = painted(RED, YELLOW, BLACK, third)
    assert len(seen(scene)) == 3


def test_people_are_no_stones_whatever_their_lightness() -> None:
    scene = scene_of([(0.3, 0.2, RED)], people=(Person(((0.0, 0.5, 0.2, 1.0),)),))
    assert len(seen(scene)) == 1


def test_a_disc_without_a_cap_is_sought_by_its_rim() -> None:
    # With the noise of the first seed one of the rims is at the edge of what convinces.
    scene = replace(painted(RED, RED, RED, RED), seed=2)
    image = without_colours(scene)
    none = np.empty((0, 2))
    disc = plain_disc(STONE.radius)
    (found,), _ = strangers([Look(image, camera_of(CAMERA, scene), none)], disc, FOLLOWING)
    assert len(found.stones) == len(scene.stones)
    assert all(not stone.cap_samples.size for stone in found.stones)
