from __future__ import annotations

import cv2
import numpy as np
import pytest

from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    camera_of,
    scene_of,
)
from curlshot.tests.helpers.vision.watch import AT_REST, lasting, picture
from curlshot.vision.association.follower import StoneView
from curlshot.vision.association.lead import Lead
from curlshot.vision.association.watch import Watch, pictures_kept
from curlshot.vision.video.frame import Frame


@pytest.mark.parametrize(
    ("size", "kept"),
    [((640, 360), 24), ((1920, 1080), 24), ((1080, 1920), 24), ((2560, 1440), 13),
     ((3840, 2160), 8), ((7680, 4320), 8)],
)  # fmt: skip
def test_of_large_pictures_fewer_are_kept(size: tuple[int, int], kept: int) -> None:
    assert pictures_kept(size) == kept


def test_a_cap_of_which_little_is_coloured_is_seen_from_the_first_picture_on() -> None:
    image, camera = picture(AT_REST), camera_of(CAMERA, scene_of(AT_REST))
    x, y = camera.project(np.array(AT_REST[0][:2]), 0.12).astype(int).tolist()
    cv2.circle(image, (x, y), 9, (150, 150, 150), -1)
    watch = Watch()
    for index in range(24):
        watch.look(Frame(index, index / 25, image), camera)
    assert [len(detections) for _, _, detections in watch.finish(lasting(camera))] == [3] * 24


def test_stones_out_of_the_picture_are_not_hidden() -> None:
    camera = camera_of(CAMERA, scene_of(AT_REST))
    view = StoneView(Frame(0, 0.0, picture(AT_REST)), camera)
    watch = Watch()
    hidden = []
    for place in ((0.3, 0.2), (9.0, 0.2)):
        lead = Lead(place, (0.0, 0.0), 0.0, place, 1.0, missed=True)
        watch._leads = [lead]
        hidden.append(watch._misses(view))
    assert hidden == [True, False]
