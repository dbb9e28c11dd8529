from __future__ import annotations

import pytest

from curlshot.data.sheet import STONE
from curlshot.tests.helpers.vision.follower import START, Places, seen, view
from curlshot.vision.association.follower import Follower, StoneView
from curlshot.vision.association.lead import Lead
from curlshot.vision.detection.appearance import learn
from curlshot.vision.detection.stones import FOLLOWING, search_picture
from curlshot.vision.video.frame import Frame


@pytest.fixture(scope="module")
def first() -> StoneView:
    return view(START, 0)


@pytest.fixture(scope="module")
def follower(first: StoneView) -> Follower:
    found = search_picture(first.frame.picture, first.camera).stones
    return Follower(learn(found), STONE, FOLLOWING)


def test_stones_are_sought_where_none_was_seen_yet(follower: Follower) -> None:
    shown = view(START, 0)
    found = follower.sought(shown)
    assert len(found) == 3
    shown.detections.extend(found[:2])
    again = follower.sought(shown)
    assert [round(s.x, 2) for s in again] == [round(found[2].x, 2)]


def test_a_stone_that_is_gone_is_waited_for_and_then_given_up(follower: Follower) -> None:
    start = view(START, 0)
    leads = [Lead.to(s, 0.0) for s in follower.sought(start)]
    bare = view(START[:2], 1)
    views = [StoneView(Frame(k, k / 10, bare.frame.picture), bare.camera) for k in (1, 2, 3, 4, 5)]
    waiting = follower.follow(views[:2], leads)
    assert sum(lead.missed for lead in waiting) == 1
    left = follower.follow(views[2:], waiting)
    assert len(left) == 2 and not any(lead.missed for lead in left)
    assert all(len(shown.detections) == 2 for shown in views)


def test_a_stone_that_was_hit_unseen_is_looked_for_where_the_hit_sends_it(
    follower: Follower,
) -> None:
    """Thrown down at 2 m/s it meets the one below at 0.05 s; that is hidden at 0.1 s."""
    x, y, resting = 0.3, 1.0, 1.0 - 2 * STONE.radius - 0.1
    leads = [
        Lead((x, y), (0.0, -2.0), 0.0, (x, y), 2.0, along=5),
        Lead((x, resting), (0.0, 0.0), 0.0, (x, resting), 2.0, steady=5),
    ]
    goes = 0.5 * (1 + 0.83) * 2.0
    true: list[Places] = [
        [(x, y - 0.1 - (2 - goes) * since), (x, resting - goes * since)]
        for since in (0.05, 0.15, 0.25)
    ]
    hidden, *shown = [view(places, k) for k, places in enumerate([true[0][:1], *true[1:]], 1)]
    left = follower.follow([hidden, *shown], leads)
    assert sum(not lead.missed for lead in left) == 2
    assert seen(shown, true[1:]).max() < 0.006


def test_a_stone_that_may_be_hit_is_measured_in_every_block(
    follower: Follower, first: StoneView
) -> None:
    still = [StoneView(Frame(k, k / 25, first.frame.picture), first.camera) for k in range(1, 25)]
    leads = follower.follow(still[:16], [Lead.to(s, 0.0) for s in follower.sought(view(START, 0))])
    # What comes is not in the picture yet, and passes two radii beside one, five beside the others.
    x, y = START[0]
    start = (x - 2 * STONE.radius, y - 3)
    comes = Lead(start, (0.0, 2.0), still[15].frame.t, start, leads[0].score)
    follower.follow(still[16:], [*leads, comes])
    assert all(len(shown.detections) == 3 for shown in still)
    assert sum(s.measured for shown in still[8:16] for s in shown.detections) == 0
    measured = [s for shown in still[16:] for s in shown.detections if s.measured]
    assert [(s.x, s.y) for s in measured] == [pytest.approx(START[0], abs=0.01)]
