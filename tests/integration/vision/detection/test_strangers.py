from __future__ import annotations

from dataclasses import replace

import pytest

from curlshot.synthetic.scene import Colour
from curlshot.tests.helpers.vision.stones import (
    BLUE,
    YELLOW,
    look,
    misses,
)  # fmt: skip
from curlshot.tests.helpers.vision.strangers import (
    BLACK,
    MAROON,
    PLACES,
    WHITE,
    painted,
    seen,
)


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
