from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.vision.optics.stick import stick_camera, stick_cameras
from curlshot.vision.video.reader import open_video


def test_y_points_up_in_the_picture() -> None:
    camera = stick_camera((100, 100, 200, 100, 1.0), (320, 240))
    assert camera.ice(np.array([100.0, 0.0])) == pytest.approx([0.0, 1.0])
    assert camera.ice(np.array([200.0, 100.0])) == pytest.approx([1.0, 0.0])


@pytest.mark.parametrize(
    "stick", [(1, 1, 1, 1, 1), (0, 0, 100, 0, 0), (0, 0, 100, 0, -1), (0, 0, math.nan, 0, 1)]
)
def test_a_stick_without_a_length_is_refused(
    stick: tuple[float, float, float, float, float],
) -> None:
    with pytest.raises(InputError, match=r"stick .*px apart"):
        stick_camera(stick, (320, 240))


@pytest.mark.parametrize("beside", [(-1, 10), (65, 10), (10, -1), (10, 49), (math.nan, 10)])
def test_a_stick_beside_the_picture_is_refused(tmp_path: Path, beside: tuple[float, float]) -> None:
    cv2.imwrite(str(tmp_path / "0.png"), np.full((48, 64, 3), 90, np.uint8))
    clip = open_video([tmp_path / "0.png"], VideoConfig(fps=10.0))
    for stick in ((30.0, 30.0, *beside, 0.5), (*beside, 30.0, 30.0, 0.5)):
        with pytest.raises(InputError, match=r"stick .*outside a frame of 64 × 48 px"):
            stick_cameras(clip, stick)
    assert len(stick_cameras(clip, (0.0, 0.0, 64.0, 48.0, 0.5))) == 1


def test_every_frame_has_the_camera_of_the_stick(tmp_path: Path) -> None:
    files = [tmp_path / f"{k}.png" for k in range(3)]
    for file in files:
        cv2.imwrite(str(file), np.full((48, 64, 3), 90, np.uint8))
    told: list[tuple[int, float]] = []
    stick = (10.0, 10.0, 60.0, 10.0, 0.5)
    cameras = stick_cameras(
        open_video(files, VideoConfig(fps=10.0)),
        stick,
        placed=lambda frame, _: told.append((frame.index, frame.t)),
    )
    assert [(c.frame, c.t) for c in cameras] == told == [(0, 0.0), (1, 0.1), (2, 0.2)]
    for camera in cameras:
        assert camera.size == (64, 48)
        assert camera.ice([10.0, 0.0]) == pytest.approx([0.0, 0.1])
