from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.cameras import SIZE, true_rig
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.paint import CIRCLES
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.quality import ARC, POOR, POOR_OFF, edges_off, quality, warnings
from curlshot.vision.optics.rig import OVERHEAD
from curlshot.vision.optics.shared import BINS

RIG = true_rig()
VIEW = View(np.array([0.0, 0.0, 0.0, np.log(1000.0)]))
EVERY = np.concatenate([kind * BINS + BINS // 2 + np.arange(-12, 12) for kind in range(CIRCLES)])
"""All pieces of the circles, all of which this camera shows."""


def test_a_house_explained_to_the_last_piece_is_perfect() -> None:
    assert len(EVERY) == CIRCLES * round(2 * np.pi / ARC)
    assert quality(np.repeat(EVERY, 3), 0.0, VIEW, RIG, SIZE) == 1.0


def test_quality_is_the_share_that_is_explained_halved_where_edges_are_far_off() -> None:
    assert quality(EVERY[::2], 0.0, VIEW, RIG, SIZE) == pytest.approx(0.5)
    assert quality(EVERY, POOR_OFF, VIEW, RIG, SIZE) == pytest.approx(0.5)
    assert quality(EVERY[:0], 0.0, VIEW, RIG, SIZE) == 0.0


def test_what_is_out_of_the_picture_need_not_be_explained() -> None:
    aside = View(np.array([0.0, -0.5, 0.0, np.log(1000.0)]))
    shown = [quality(EVERY[k : k + 1], 0.0, aside, RIG, SIZE) for k in range(len(EVERY))]
    assert 1 / 60 < shown[0] < 1 / 20
    assert quality(EVERY, 0.0, aside, RIG, SIZE) == 1.0


def test_a_carried_camera_has_none() -> None:
    assert quality(EVERY, float("nan"), VIEW, RIG, SIZE) == 0.0


def test_edges_are_off_by_what_camera_and_paint_leave_each_as_it_counts() -> None:
    sd = np.full(4, 0.001)
    assert edges_off(np.full(4, 0.003), np.array([0.004, -0.004] * 2), sd) == pytest.approx(0.005)
    ragged, left = np.repeat([0.001, 0.030], 50), np.repeat([0.001, 0.030], 50)
    assert edges_off(left, 0 * left, ragged) == pytest.approx(0.0014, abs=0.0001)
    assert np.isnan(edges_off(sd[:0], sd[:0], sd[:0]))


def cameras(qualities: list[float]) -> list[Camera]:
    return [Camera(k, k / 25, np.eye(3), SIZE, quality=q, found=q > 0)
            for k, q in enumerate(qualities)]  # fmt: skip


def test_a_good_clip_has_no_warnings() -> None:
    for clip in (cameras([0.9] * 20), cameras([0.9] * 19 + [POOR / 2])):
        assert warnings(clip, 8.0, 0.1, OVERHEAD, lined=True, cropped=False) == ()


@pytest.mark.parametrize(
    ("qualities", "sd", "lined", "cropped", "told"),
    [
        (
            [0.9, POOR / 2, 0.9],
            0.1,
            True,
            False,
            "in 1 of 3 frames (1 to 1) the camera model explains little",
        ),
        ([0.9, 0.0, 0.0], 0.1, True, False, "2 of 3 frames do not show the rings"),
        (
            [0.9] * 3,
            1.4,
            True,
            False,
            "height is not identifiable from this view (8.0 ± 1.4 m assumed)",
        ),
        ([0.9] * 3, 0.1, False, False, "neither centre line nor tee line is visible"),
        ([0.9] * 3, 0.1, True, True, "cropped off-centre or stretched"),
    ],
)
def test_what_is_doubtful_is_told(
    qualities: list[float], sd: float, lined: bool, cropped: bool, told: str
) -> None:
    (text,) = warnings(cameras(qualities), 8.0, sd, OVERHEAD, lined, cropped)
    assert told in text


def test_a_height_that_is_said_is_not_assumed_but_may_be_at_odds_with_the_view() -> None:
    said = OVERHEAD.at_height(5.6)
    assert warnings(cameras([0.9] * 3), 5.65, 0.1, said, lined=True, cropped=False) == ()
    (text,) = warnings(cameras([0.9] * 3), 6.1, 0.1, said, lined=True, cropped=False)
    assert "5.6 m, does not fit this view; the view suggests a higher camera" in text
