from __future__ import annotations

from collections.abc import Iterable

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
from curlshot.vision.detection.detection import Detection
from curlshot.vision.film.clip import Frame
from curlshot.vision.film.shelf import Shelf


@pytest.mark.parametrize(
    ("size", "kept"),
    [((640, 360), 24), ((1920, 1080), 24), ((1080, 1920), 24), ((2560, 1440), 13),
     ((3840, 2160), 8), ((7680, 4320), 8)],
)  # fmt: skip
def test_of_large_pictures_fewer_are_kept(size: tuple[int, int], kept: int) -> None:
    assert pictures_kept(size) == kept


def test_pictures_of_caps_are_left_where_they_were_put_aside(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shelf = Shelf()
    monkeypatch.setattr("curlshot.vision.association.watch.Shelf", lambda _: shelf)
    watch, camera, image = Watch(), camera_of(CAMERA, scene_of(AT_REST)), picture(AT_REST)
    for index in range(50):
        watch.look(Frame(index, index / 25, image), camera)
    found = [*watch.finish(lasting(camera))]
    first = [seen for _, _, detections in found[:16] for seen in detections]
    caps = [seen.spectrum for seen in first if seen.spectrum]
    assert len(caps) >= 3
    assert all(cap.place_on(shelf) is not None for cap in caps)


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


def test_tones_stay_where_no_stone_shows_once_they_are_lifted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Then it was something else that seemed to be too dark: stones are followed all the same."""
    image, camera = picture(AT_REST), camera_of(CAMERA, scene_of(AT_REST))
    lifted = np.arange(256, dtype=np.uint8) // 2
    monkeypatch.setattr("curlshot.vision.association.watch.tones", lambda *_: lifted)
    watch = Watch()
    of_any_colour = watch._of_any_colour

    def none_in_lifted(views: Iterable[StoneView], *radius_px: float) -> list[Detection]:
        views = list(views)
        seen = [view for view in views if np.max(view.frame.picture) > 128]  # type: ignore[arg-type]
        return of_any_colour(seen, *radius_px) if seen else []

    monkeypatch.setattr(watch, "_of_any_colour", none_in_lifted)
    for index in range(30):
        watch.look(Frame(index, index / 25, image), camera)
    assert [len(seen) for _, _, seen in watch.finish(lasting(camera))] == [3] * 30
