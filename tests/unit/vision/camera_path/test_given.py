from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.tests.helpers.vision.given import SMALL, textured
from curlshot.vision.camera_path.given import GivenHouse, follow_given, hypotheses
from curlshot.vision.video.reader import open_video


def test_without_edges_the_points_stand_where_the_picture_does(tmp_path: Path) -> None:
    clip = textured(tmp_path, (0.0, 0.4, 20.0, 0.0))
    house = GivenHouse.of((320, 180, 420, 180, 320, 80), 1)
    track = follow_given(clip, house)
    assert [c.frame for c in track.cameras] == [0, 1, 3]
    assert [c.found for c in track.cameras] == [False, True, False]
    for camera in track.cameras:
        points = camera.ice([[320.0, 180.0], [420.0, 180.0], [320.0, 80.0]])
        expected = np.array([[0.0, 0.0], [1.829, 0.0], [0.0, 1.829]])
        np.testing.assert_allclose(points, expected, atol=0.02)
        assert np.isnan(camera.rms_px) and camera.quality == 0
    assert "no rings found" in track.warnings[0]
    assert "only the 3 frames" in track.warnings[0]


@pytest.mark.parametrize("points", [(420, 180, 320, 100), (390, 180, 320, 90)])
def test_y_is_up_whichever_way_the_circle_is_foreshortened(
    points: tuple[float, ...], tmp_path: Path
) -> None:
    track = follow_given(textured(tmp_path, (0.0,)), GivenHouse.of((320, 180, *points)))
    tee, ahead = track.cameras[0].project([[0.0, 0.0], [0.0, 0.2]])
    np.testing.assert_allclose(tee, [320, 180], atol=1)
    assert abs(ahead[0] - tee[0]) < 0.5 and ahead[1] < tee[1] - 5


@pytest.mark.parametrize(
    ("points", "match"),
    [
        ((320, 180, 320, 180, 320, 80), "at least 13 px from the tee"),
        ((320, 180, 325, 180, 320, 80), "at least 13 px from the tee"),
        ((320, 180, 620, 180, 320, 140), "7.5 times as far"),
        ((320, 180, np.nan, 180, 320, 80), "outside a frame of 640 × 360"),
        ((1e9, 180, 420, 180, 320, 80), "outside a frame of 640 × 360"),
    ],
)
def test_points_that_no_house_has_are_refused(points: tuple[float, ...], match: str) -> None:
    with pytest.raises(InputError, match=match):
        hypotheses(GivenHouse.of(points), SMALL)


def test_a_frame_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="frame 9 is not among"):
        follow_given(textured(tmp_path, (0.0,)), GivenHouse.of((320, 180, 420, 180, 320, 80), 9))


def test_a_clip_of_which_nothing_can_be_read_says_so(tmp_path: Path) -> None:
    textured(tmp_path, (0.0,))
    (tmp_path / "1.png").write_bytes(b"no picture")
    clip = open_video(
        [tmp_path / "0.png", tmp_path / "1.png"], VideoConfig(fps=25.0, frames=(1, 1))
    )
    with pytest.raises(InputError, match="none of the selected frames can be read"):
        follow_given(clip, GivenHouse.of((320, 180, 420, 180, 320, 80)))
