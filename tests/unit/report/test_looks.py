from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.report.looks import (
    Look,
    check_lines,
    check_table,
    frames_to_show,
    numbered,
    way_of_play,
)
from curlshot.tests.helpers.report.looking import camera, stone, table
from curlshot.vision.detection.detection import Refusal
from curlshot.vision.optics.camera import CameraError
from curlshot.vision.video.frame import Frame


@pytest.mark.parametrize("worst", [0, 17, 59])
def test_the_worst_frame_is_shown_and_no_frame_twice(worst: int) -> None:
    shown = frames_to_show(table(60, worst))
    assert worst + 5 in shown
    assert shown == sorted(set(shown))
    assert len(shown) == 12
    assert {5, 64} <= {*shown}


@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_short_clip_is_shown_whole(count: int) -> None:
    assert frames_to_show(table(count, count - 1)) == list(range(5, 5 + count))


def test_numbers_of_reasons_do_not_lie_on_one_another() -> None:
    close = [Refusal(0.5 + 0.05 * k, 0.5, 0.3, "a broom") for k in range(4)]
    other = [Refusal(0.6, 0.5, 0.3, "too small"), Refusal(1.5, 0.5, 0.3, "a broom")]
    chosen = numbered([*close, *other], 0.29)
    assert chosen == [close[0], *other]


@pytest.mark.parametrize("sign", [1, -1])
def test_the_way_of_play_is_that_of_what_moves(sign: int) -> None:
    """One comes into view, goes on, and hits another; a third rests, a fourth is covered once."""
    thrown = [None, -2.0, -1.0, -0.9, -0.8]
    looks = []
    for k, y in enumerate(thrown):
        places = [(1.0, 0.9 + 0.01 * (k % 2)), (0.0, 0.2 * max(k - 2, 0))]
        places += [(0.1, y)] if y is not None else []
        places += [(-1.0, 1.5)] if k != 3 else []
        stones = [stone(x, sign * y) for x, y in places]
        looks.append(Look(Frame(k, k / 25, np.zeros((2, 2, 3), np.uint8)), camera(k), stones))
    assert way_of_play(looks, 0.1455) == sign
    assert way_of_play(looks[:1], 0.1455) == -1
    still = [[stone(0.0, 0.01 * k), stone(1.0, 0.02 * k)] for k in range(3)]
    rests = [replace(look, stones=lie) for look, lie in zip(looks, still, strict=False)]
    assert way_of_play(rests, 0.1455) == -1


def test_the_error_at_the_rim_is_that_of_the_ring() -> None:
    """A scale that is 1 % off puts a point of the ring 1 % of its radius off, along one axis."""
    error = CameraError(np.zeros((9, 9)), np.zeros((9, 9)), scale=0.01)
    far = {"f_px": 500.0, "position": np.array([0.0, 0.0, 10.0]), "error": error}
    rim = check_table([camera(0, **far), camera(1)], 1.829)["sd"]
    assert rim.to_numpy() == pytest.approx([0.01829 / np.sqrt(2), 0.0])


def test_the_lines_say_what_is_known_and_what_is_not() -> None:
    black, one = np.zeros((2, 2, 3), np.uint8), stone(0.0, 1.0)
    looks = [Look(Frame(k, k / 25, black), camera(k), [one] * k) for k in range(3)]
    lines = check_lines("a.mp4", 70, table(60, 17), looks, ["the picture shakes"])
    said = "\n".join(lines)
    assert "a.mp4: 70 frames" in said
    assert "edge residual 0.20 px, worst frame 0.90 px" in said
    assert "carried over in 9 of them" in said
    assert "2.0 mm at the 12-ft ring" in said
    assert "2 at most in one of 3 frames" in said
    assert lines[-1] == "warning     the picture shakes"
    blind = table(60, 17).assign(rms_px=np.nan, sd=0.0)
    assert "edges not measured" in check_lines("a.mp4", 70, blind, looks)[1]
    assert not any("12-ft" in line for line in check_lines("a.mp4", 70, blind, looks))
