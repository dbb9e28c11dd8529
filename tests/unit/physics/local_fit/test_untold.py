"""Hits out of sight, and soft ones, that are not told are said; nothing else is."""

from __future__ import annotations

import re

import numpy as np
import pytest

from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import estimate_locally
from curlshot.tests.helpers.physics.untold import FPS, Floats, R, glide, hit, said, table


def test_hit_whose_stone_is_not_seen_again_is_said() -> None:
    (text,) = said(table(*hit(1.0), {"A": (1.2, 9.0), "B": (1.0, 2.2)}))
    assert "A and B" in text and "out of sight between 0.97" in text and "its e" in text


def test_stone_struck_in_sight_by_one_out_of_sight_is_said() -> None:
    (text,) = said(table(*hit(1.0), {"A": (1.2, 9.0)}))
    assert text.startswith("A, out of sight, apparently hit B at 1.5")


def test_ways_that_meet_where_one_is_lost_and_one_found_are_said() -> None:
    (text,) = said(table(*hit(1.0), {"A": (1.2, 9.0), "B": (-1.0, 2.2)}))
    assert "A was last detected at 1.17" in text and "B first at 2.2" in text


def test_change_by_what_is_never_seen_is_said() -> None:
    t, places = hit(1.0)
    del places["A"]
    (text,) = said(table(t, places, {"B": (1.0, 2.0)}))
    assert text.startswith("something hit B out of sight between 0.97 and 2.03")
    (text,) = said(table(t, places, {}))
    assert "the velocity of B changes at 1.5" in text


def test_stone_that_stops_touching_is_said_with_its_time() -> None:
    t = np.arange(0.0, 5.0, 1 / FPS)
    rest = np.array([0.0, 2 * R + 0.0005])
    speed = 0.2  # rests after two seconds, 20 cm on
    places = {
        "A": glide(rest + np.array([0.0, 0.2]), np.array([0.0, -speed]), t),
        "B": np.zeros((len(t), 2)),
    }
    (text,) = [w for w in said(table(t, places, {})) if "whole" not in w and "friction" not in w]
    assert "A came to rest at, or almost at, B at 1." in text
    places["B"] -= [0.0, 0.05]  # 5 cm short of it
    assert not any("came to rest at" in w for w in said(table(t, places, {})))


def alone(places: Floats, t: Floats, hidden: tuple[float, float] | None = None) -> list[str]:
    """What is said of one stone that goes past others far away."""
    others = {"B": np.tile([2.0, 4.0], (len(t), 1))}
    return said(table(t, {"A": places, **others}, {"A": hidden} if hidden else {}))


@pytest.mark.parametrize(("slowing", "hits"), [(0.05, 0), (0.2, 0), (0.5, 1)])
def test_what_ice_and_brooms_do_out_of_sight_is_no_hit(slowing: float, hits: int) -> None:
    t = np.arange(0.0, 5.0, 1 / FPS)
    speed = np.where(t < 1.2, 2.0 - 0.1 * t, 1.88 - slowing * (t - 1.2))
    way = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) / FPS)])
    assert len(alone(np.outer(way, [0.0, -1.0]), t, (1.2, 3.0))) == hits


@pytest.mark.parametrize(("turn", "hits"), [(0.04, 0), (0.2, 1)])
def test_turn_in_sight_that_ice_cannot_give_is_said(turn: float, hits: int) -> None:
    t = np.arange(0.0, 4.0, 1 / FPS)
    start = np.array([0.0, -1.0])
    at = glide(np.zeros(2), start, np.array([2.0]))[0]
    after = glide(at, np.array([turn, -0.8]), t - 2.0)
    places = np.where((t < 2.0)[:, None], glide(np.zeros(2), start, t), after)
    assert len(alone(places, t)) == hits


@pytest.mark.parametrize(("moved", "hits"), [(0.003, 0), (0.012, 1)])
def test_stone_at_rest_that_was_moved_out_of_sight_is_said(moved: float, hits: int) -> None:
    t = np.arange(0.0, 4.0, 1 / FPS)
    places = np.where((t < 2.0)[:, None], [0.0, 0.0], [moved, 0.0])
    assert len(alone(places, t, (1.0, 2.5))) == hits


@pytest.mark.parametrize(("moved", "hits"), [(0.012, 0), (0.05, 1)])
def test_stone_at_rest_that_lies_elsewhere_after_a_blink_is_said(moved: float, hits: int) -> None:
    """A centimetre may be light; of a short time it is not said that the stone was out of sight."""
    t = np.arange(0.0, 4.0, 1 / FPS)
    places = np.where((t < 2.0)[:, None], [0.0, 0.0], [moved, 0.0])
    assert len(alone(places, t, (1.85, 2.2))) == hits


@pytest.mark.parametrize(("wait", "hits"), [(2.0, 1), (6.0, 0)])
def test_who_is_lost_too_long_is_nobody_who_hit(wait: float, hits: int) -> None:
    t = np.arange(0.0, 1.5 + wait + 1.5, 1 / FPS)
    lost = np.array([0.0, -0.6])
    places = {"A": glide(np.zeros(2), lost, t)}
    end = glide(np.zeros(2), lost, np.array([1.5 + 0.5 * wait]))[0]
    places["B"] = glide(end - np.array([0.0, 2 * R]), np.array([0.05, -0.5]), t - 1.5 - 0.5 * wait)
    detections = table(t, places, {"A": (1.5, 99.0), "B": (-1.0, 1.5 + wait)})
    assert len(said(detections)) == hits


@pytest.mark.parametrize(("before", "after"), [(0.3, 0.65), (0.6, 1.05)])
def test_stone_that_comes_faster_out_of_sight_than_it_went_is_said(
    before: float, after: float
) -> None:
    t = np.arange(0.0, 5.0, 1 / FPS)
    way = glide(np.zeros(2), np.array([0.0, -before]), t)
    hit_at = int(np.searchsorted(t, 2.0))
    onward = glide(way[hit_at], np.array([0.0, -after]), t - 2.0)
    (text,) = alone(np.where((t < 2.0)[:, None], way, onward), t, (1.0, 3.0))
    assert text.startswith("something hit A out of sight between 0.97 and 3.0")


def test_each_change_of_a_stone_s_motion_is_said() -> None:
    t = np.arange(0.0, 5.0, 1 / FPS)
    way = np.where((t > 1.0)[:, None], glide(np.zeros(2), np.array([0.0, -0.8]), t - 1.0), 0.0)
    turned = glide(way[int(np.searchsorted(t, 3.0))], np.array([0.6, -0.2]), t - 3.0)
    (text,) = alone(np.where((t > 3.0)[:, None], turned, way), t)
    assert "the velocity of A changes at 1.0" in text and " and at 3.0" in text


def test_many_changes_of_a_motion_are_counted() -> None:
    t = np.arange(0.0, 8.0, 1 / FPS)
    zigzag = np.column_stack([0.3 * np.abs((t + 0.5) % 2 - 1), -0.5 * t])
    (text,) = alone(zigzag, t)
    assert "the velocity of A changes 8 times between 0.4" in text


def test_stone_that_goes_on_under_another_name_hits_nothing() -> None:
    t = np.arange(0.0, 5.0, 1 / FPS)
    way = glide(np.zeros(2), np.array([0.0, -1.5]), t)
    places = {"A": way, "B": way.copy(), "C": np.tile([1.5, 1.0], (len(t), 1))}
    assert said(table(t, places, {"A": (1.5, 99.0), "B": (-1.0, 3.0)})) == []


def test_touching_stones_of_which_light_moves_one_for_a_while_have_not_come_to_rest() -> None:
    t = np.arange(0.0, 5.0, 1 / FPS)
    touching = np.tile([0.0, 2 * R + 0.0005], (len(t), 1))
    touching[(t > 2.0) & (t < 2.5), 1] += 0.013
    places = {
        "A": touching,
        "B": np.zeros((len(t), 2)),
        "C": glide(np.array([1.5, 1.0]), np.array([0.0, -1.0]), t),
    }
    assert not any("came to rest" in text for text in said(table(t, places, {})))


def test_stone_moved_after_a_hit_that_is_told_is_not_said_to_be_moved_by_it() -> None:
    t, places = hit(1.0)
    at = int(np.searchsorted(t, 1.8))  # a hand pushes B on its way, A still near it
    pushed = glide(places["B"][at], np.array([0.9, -0.3]), t - t[at])
    places["B"] = np.where((t < t[at])[:, None], places["B"], pushed)
    texts = [text for text in said(table(t, places, {})) if "B" in text]
    assert len(texts) == 1 and "without a visible stone" in texts[0]


@pytest.mark.parametrize("times", [0.3, 3.0])
def test_hit_that_discs_of_this_radius_cannot_make_asks_for_the_scale(times: float) -> None:
    t, places = hit(1.0)
    seen = table(t, places, {})
    contacts = detect_hits(seen, R * times)
    assert contacts == ()
    warnings = estimate_locally(seen, contacts, radius=R * times).warnings
    (text,) = [text for text in warnings if "velocities" in text]
    assert text.startswith(("the velocities of A and B change at 1.", "the velocities of B and A"))
    assert re.search(
        r"as if they hit each other, but 0\.(29|3|31) m apart, where two radii are", text
    )
    assert text.endswith("check scale, unit and radius")


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ([0.0, -0.8], [0.0, -0.8]),
        ([0.0, 0.8], [0.0, -0.8]),
        ([0.5, 0.0], [-0.5, 0.0]),
        ([0.5, 0.3], [0.2, -0.6]),
    ],
)
def test_stones_that_hands_clear_at_one_time_ask_for_no_scale(
    first: list[float], second: list[float]
) -> None:
    t = np.arange(0.0, 5.0, 1 / FPS)
    places = {
        name: np.where((t > 2.0)[:, None], glide(at, np.array(way), t - 2.0), at)
        for name, at, way in (
            ("A", np.array([0.0, 1.5]), first),
            ("B", np.array([0.3, -1.5]), second),
        )
    }
    texts = said(table(t, places, {}))
    assert not any("scale" in text for text in texts)
    assert sum("without a visible stone that hit it" in text for text in texts) == 2


def test_one_stone_under_two_names_at_once_asks_for_no_scale() -> None:
    t = np.arange(0.0, 5.0, 1 / FPS)
    way = np.where((t > 2.0)[:, None], glide(np.zeros(2), np.array([0.1, -0.8]), t - 2.0), 0.0)
    assert not any("scale" in text for text in said(table(t, {"A": way, "A2": way + 0.002}, {})))


@pytest.mark.parametrize("count", [2, 3, 4])
def test_several_stones_that_move_at_once_ask_for_the_camera(count: int) -> None:
    """A camera that is shoved: all that lie there go the same way for a moment."""
    t = np.arange(0.0, 5.0, 1 / FPS)
    shove = 0.25 * np.clip((t - 2.0) / 0.5, 0, 1)[:, None] * [1.0, 0.0]
    corners = [(-1.5, 1.0), (1.0, 1.5), (0.9, -1.0), (-1.0, -1.2)]
    places = {name: at + shove for name, at in zip("ABCD"[:count], corners, strict=False)}
    texts = said(table(t, places, {}))
    asked = [text for text in texts if "did the camera move" in text]
    lone = [text for text in texts if "without a visible stone that hit it" in text]
    assert (len(asked), len(lone)) == ((0, 2) if count < 3 else (2, 0))
    for text in asked:
        assert (
            ", ".join("ABCD"[: count - 1]) + f" and {'ABCD'[count - 1]} change together at" in text
        )
