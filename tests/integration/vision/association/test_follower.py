from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.follower import START, seen, view
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
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


@pytest.mark.parametrize("step", [1, -1])
def test_a_stone_on_its_course_and_those_at_rest_are_seen_all_the_way(
    follower: Follower, step: int
) -> None:
    true = [[(0.3, 0.2 - 0.03 * k), *START[1:]] for k in range(6)][::step]
    views = [view(places, k) for k, places in enumerate(true)]
    leads = [Lead.to(s, views[0].frame.t) for s in follower.sought(views[0])]
    views[0].detections.extend(follower.sought(views[0]))
    left = follower.follow(views[1:], leads)
    assert len(left) == 3
    assert all(len(shown.detections) == 3 for shown in views)
    assert seen(views, true).max() < 0.006


def test_what_is_beside_a_hidden_stone_in_another_colour_is_not_that_stone(
    follower: Follower,
) -> None:
    """As a sleeve in the other team's colour over it: only a disc of its own may be it."""
    leads = [Lead.to(s, 0.0) for s in follower.sought(view(START, 0)) if s.x < 0]
    (x, y) = START[1]  # a yellow one
    for cap, aside in ((RED, 0.2), (YELLOW, 0.2)):
        scene = scene_of([(x + aside, y, cap)])
        image = np.asarray(render_still(scene, CAMERA), np.uint8)
        shown = StoneView(Frame(1, 0.1, image), camera_of(CAMERA, scene))
        follower.follow([shown], leads)
        assert len(shown.detections) == (cap == YELLOW)
