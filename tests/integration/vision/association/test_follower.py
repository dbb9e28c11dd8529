from __future__ import annotations

from collections.abc import Sequence
from typing import Any

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
from curlshot.vision.association.expected import look_on_course
from curlshot.vision.association.follower import Follower, StoneView
from curlshot.vision.association.lead import Lead
from curlshot.vision.detection.appearance import learn
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import FOLLOWING, search_picture
from curlshot.vision.film.clip import Frame


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


def test_what_is_hidden_is_not_looked_for_again_where_it_was_just_missed(
    follower: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    def counted(looks: list[Look], *rest: Any) -> list[Detection | None]:
        looked.append(looks[0].places)
        return look_on_course(looks, *rest)

    looked: list[np.ndarray] = []
    leads = [Lead.to(s, 0.0) for s in follower.sought(view(START, 0))]
    drifts = [view([*START[:2], (0.9 + 0.005 * k, -0.6)], k) for k in (1, 2)]
    hidden = [view(START[:2], k) for k in (3, 4)]
    monkeypatch.setattr("curlshot.vision.association.follower.look_on_course", counted)
    left = follower.follow([*drifts, *hidden], leads)
    assert [lead.missed for lead in left] == [False, False, True]
    _, once = looked  # all at first, and it in the first picture without it
    assert once == pytest.approx(np.array([(0.914, -0.6)]), abs=2e-3)


def test_a_stone_that_sets_off_is_measured_in_the_next_pictures_at_once(
    follower: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    def counted(looks: Sequence[Look], *others: Any) -> list[Detection | None]:
        together.append(sum(len(look.places) > 0 for look in looks))
        return look_on_course(looks, *others)

    together: list[int] = []
    monkeypatch.setattr("curlshot.vision.association.follower.look_on_course", counted)
    true = [[(0.3, 0.2 - 0.04 * k), *START[1:]] for k in range(7)]
    views = [view(places, k) for k, places in enumerate(true)]
    follower.follow(views[1:], [Lead.to(s, views[0].frame.t) for s in follower.sought(views[0])])
    assert together[:2] == [6, 5]
    assert len(together) <= 3  # not one by one
    assert seen(views[1:], true[1:]).max() < 0.006


def test_a_stone_that_is_drawn_aside_bit_by_bit_is_found_again(
    follower: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fading(looks: list[Look], *_: object) -> list[Detection]:
        nonlocal share
        share *= 0.93
        places = np.concatenate([look.places for look in looks])
        near = [min(known, key=lambda s: np.hypot(s.x - x, s.y - y)) for x, y in places]
        return [s._replace(score=share * s.score) for s in near]

    share = 1.0
    known = follower.sought(view(START, 0))
    moved = [(x + 0.02, y) for x, y in START]
    views = [view(moved, k) for k in range(1, 6)]
    monkeypatch.setattr("curlshot.vision.association.follower.look_on_course", fading)
    leads = [Lead.to(s, 0.0) for s in known]
    for each in views:
        leads = follower.follow([each], leads)
    assert seen(views[:1], [moved]).min() > 0.015
    assert seen(views[-1:], [moved]).max() < 0.003
