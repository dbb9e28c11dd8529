from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.synthetic.scene import Colour
from curlshot.tests.helpers.vision.stones import (
    BLUE,
    YELLOW,
    look,
    misses,
    scene_of,
)  # fmt: skip
from curlshot.tests.helpers.vision.strangers import (
    BLACK,
    MAROON,
    PLACES,
    WHITE,
    painted,
    seen,
)
from curlshot.vision.detection.appearance import BY_SHAPE
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.seek import Candidates
from curlshot.vision.detection.stones import Findings


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


@pytest.mark.parametrize(("lighter", "count"), [(0.0, 2), (40.0, 1)])
def test_stones_told_by_their_shape_tell_of_what_granite_others_are(
    lighter: float, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    sure, *_ = seen(painted(BLACK, WHITE, BLACK, WHITE))
    off = np.array([lighter, 0.0, 0.0])
    doubtful = sure._replace(x=sure.x + 1.0, score=1.5, granite_samples=sure.granite_samples + off)
    by_colour = sure._replace(score=1.2)  # does not convince

    def measured(look: Look, sought: Candidates, *_: object) -> Findings:
        return Findings((sure, doubtful) if sought.appearance is BY_SHAPE else (by_colour,), ())

    monkeypatch.setattr("curlshot.vision.detection.strangers.measured", measured)
    found = seen(scene_of([]))
    assert len(found) == count
    assert found[0].score > by_colour.score


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
