"""What is held of a clip while it is read: a few pictures, however long it is, and few numbers."""

from __future__ import annotations

import gc
import tracemalloc
import weakref
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from curlshot.synthetic.camera import still_camera
from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import RED, YELLOW, scene_of
from curlshot.vision.association.watch import Watch
from curlshot.vision.camera_path.follow_house import follow_house
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Image
from curlshot.vision.video.reader import Video
from curlshot.vision.video.source import ImageFiles

PLACES = [(0.3, 0.2, RED), (-0.8, 1.0, YELLOW), (0.9, -0.6, RED)]


class Counted(Video):
    """A clip of one picture over and over, which counts how many of its copies are held.

    `traced` is the memory in use before two of the frames, bytes, if it is traced.
    """

    def __init__(self, picture: Image, frames: int) -> None:
        height, width, _ = picture.shape
        super().__init__(ImageFiles((Path("again.png"),), (width, height), 25.0, frames))
        self.picture, self.held, self.most = picture, 0, 0
        self.traced: list[int] = []

    def __iter__(self) -> Iterator[Frame]:
        for index in range(self.expected):
            if index in (72, 144):
                gc.collect()
                self.traced.append(tracemalloc.get_traced_memory()[0])
            copy = self.picture.copy()
            weakref.finalize(copy, self._let_go)
            self.held += 1
            self.most = max(self.most, self.held)
            yield Frame(index, index / 25, copy)

    def _let_go(self) -> None:
        self.held -= 1


def watched(frames: int) -> Counted:
    """Go through such a clip; while its stones are placed no picture is held."""
    camera = still_camera(size=(640, 360), px_per_m=75.0, target=(0.0, 0.3))
    picture = np.asarray(render_still(scene_of(PLACES), camera), np.uint8)
    clip, watch = Counted(picture, frames), Watch()
    house = follow_house(clip, placed=watch.look)
    counts = []
    for _, _, seen in watch.finish(house.cameras):
        counts.append(len(seen))
        assert clip.held == 0
    assert counts == [len(PLACES)] * frames
    return clip


def test_a_longer_clip_needs_no_more_pictures() -> None:
    assert watched(150).most <= watched(50).most < 45


def test_of_a_frame_few_numbers_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where its marks and detections lie, and its view."""
    for module in ("association.watch", "camera_path.follow_house"):
        monkeypatch.setattr(f"curlshot.vision.{module}.ROOM", 0)
    tracemalloc.start()
    early, late = watched(150).traced
    tracemalloc.stop()
    assert late - early < 72 * 1_200
