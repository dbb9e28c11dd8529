from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.clip import render_still
from curlshot.tests.unit.vision.detection.test_stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
from curlshot.vision.association.expected import look_on_course
from curlshot.vision.association.follower import Follower, StoneView
from curlshot.vision.association.lead import Lead
from curlshot.vision.association.still import Portrait, portraits
from curlshot.vision.detection.appearance import learn
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import FOLLOWING, search_picture
from curlshot.vision.video.frame import Frame

Places = list[tuple[float, float]]
CAPS = (RED, YELLOW, RED)
START: Places = [(0.3, 0.2), (-0.8, 1.0), (0.9, -0.6)]


def view(places: Places, index: int) -> StoneView:
    scene = scene_of([(x, y, cap) for (x, y), cap in zip(places, CAPS, strict=False)])
    image = np.asarray(render_still(scene, CAMERA), np.uint8)
    return StoneView(Frame(index, index / 10, image), camera_of(CAMERA, scene))


@pytest.fixture(scope="module")
def first() -> StoneView:
    return view(START, 0)


@pytest.fixture(scope="module")
def follower(first: StoneView) -> Follower:
    found = search_picture(first.frame.picture, first.camera).stones
    return Follower(learn(found), STONE, FOLLOWING)


def seen(views: list[StoneView], true: list[Places]) -> np.ndarray:
    """Distance of the nearest detection to each true place, m, shape (views, stones)."""
    return np.array(
        [
            [np.hypot(*(shown.places - place).T).min() for place in places]
            for shown, places in zip(views, true, strict=True)
        ]
    )


def test_stones_are_sought_where_none_was_seen_yet(follower: Follower) -> None:
    shown = view(START, 0)
    found = follower.sought(shown)
    assert len(found) == 3
    shown.detections.extend(found[:2])
    again = follower.sought(shown)
    assert [round(s.x, 2) for s in again] == [round(found[2].x, 2)]


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


def test_stones_at_rest_are_portrayed_where_they_will_not_be_measured_next(
    follower: Follower, first: StoneView, monkeypatch: pytest.MonkeyPatch
) -> None:
    def counted(*about: Any) -> list[Portrait | None]:
        taken.append(len(about[3]))
        return portraits(*about)

    taken: list[int] = []
    monkeypatch.setattr("curlshot.vision.association.follower.portraits", counted)
    frames = [replace(first.frame, index=k, t=k / 10) for k in range(1, 15)]
    views = [StoneView(frame, first.camera) for frame in frames]
    leads = [Lead.to(s, 0.0) for s in follower.sought(view(START, 0))]
    left = follower.follow(views, leads)
    # The first eight are measured together; what looks the same later is not.
    assert taken == [*[0] * 7, 3, *[0] * 6]
    assert all(lead.portrait is not None for lead in left)
    assert [sum(s.measured for s in shown.detections) for shown in views] == [*[3] * 8, *[0] * 6]


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


def test_what_shows_clearly_less_than_a_moment_ago_is_looked_for_beside_too(
    follower: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    def doubted(looks: list[Look], *_: object) -> list[Detection]:
        places = np.concatenate([look.places for look in looks])
        near = [min(known, key=lambda s: np.hypot(s.x - x, s.y - y)) for x, y in places]
        return [s._replace(score=0.7 * s.score) for s in near]

    known = follower.sought(view(START, 0))
    moved = [(x + 0.02, y) for x, y in START]
    after = view(moved, 1)
    monkeypatch.setattr("curlshot.vision.association.follower.look_on_course", doubted)
    follower.follow([after], [Lead.to(s, 0.0) for s in known])
    assert seen([after], [moved]).max() < 0.003


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


def test_what_is_beside_a_stone_must_show_clearly_more(
    follower: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    def little_more(look: Look, *_: object) -> list[Detection]:
        near = [min(known, key=lambda s: np.hypot(s.x - x, s.y - y)) for x, y in look.places]
        return [s._replace(x=s.x + 0.02, score=1.1 * s.score) for s in near]

    known = follower.sought(view(START, 0))
    after = view(START, 1)
    monkeypatch.setattr("curlshot.vision.association.follower.look_beside", little_more)
    follower.follow([after], [replace(Lead.to(s, 0.0), score=2 * s.score) for s in known])
    assert seen([after], [START]).max() < 0.003
