"""What is held of a clip while it is read: a few pictures, however long it is."""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.synthetic.camera import still_camera
from tests.synthetic.clip import render_still
from tests.vision.detection.test_stones import RED, YELLOW, scene_of
from vision.association.watch import Watch
from vision.camera_path.follow_house import follow_house
from vision.film.clip import Clip, Frame, Image

PLACES = [(0.3, 0.2, RED), (-0.8, 1.0, YELLOW), (0.9, -0.6, RED)]


class Counted(Clip):
    """A clip of one picture over and over, which counts how many of its copies are held."""

    def __init__(self, picture: Image, frames: int) -> None:
        height, width, _ = picture.shape
        super().__init__((Path("again.mp4"),), (width, height), 25.0, frames)
        self.picture, self.held, self.most = picture, 0, 0

    def __iter__(self) -> Iterator[Frame]:
        for index in range(self.frames):
            copy = self.picture.copy()
            weakref.finalize(copy, self._let_go)
            self.held += 1
            self.most = max(self.most, self.held)
            yield Frame(index, index / 25, copy)

    def _let_go(self) -> None:
        self.held -= 1


def most_held(picture: Image, frames: int) -> int:
    clip = Counted(picture, frames)
    watch = Watch()
    follow_house(clip, placed=watch.look)
    assert [len(seen) for _, _, seen in watch.finish()] == [len(PLACES)] * frames
    return clip.most


def test_a_longer_clip_needs_no_more_pictures() -> None:
    camera = still_camera(size=(640, 360), px_per_m=75.0, target=(0.0, 0.3))
    picture = np.asarray(render_still(scene_of(PLACES), camera), np.uint8)
    short = most_held(picture, 50)
    assert most_held(picture, 150) <= short < 45
