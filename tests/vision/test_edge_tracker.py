from __future__ import annotations

import numpy as np
import pytest

from tests.synthetic import PAINTS, Scene, render_still, still_camera
from tests.vision.places import RINGS
from vision.clip import Frame
from vision.edge_tracker import LONGEST_STRIDE, EdgeTracker
from vision.outline import Rim
from vision.paint import FIXED
from vision.pose import View, aim, camera
from vision.rig import OVERHEAD, start_rig

SIZE = (960, 540)
PAINT = PAINTS["navy-orange"]
POSITION, SCALE = (0.0, 0.0, 9.0), 90.0
PATH = still_camera(size=SIZE, position=POSITION, target=(0, 0), px_per_m=SCALE)


def rig() -> np.ndarray:
    found = start_rig(OVERHEAD, POSITION)
    found[3:6] = 0
    found[6:8] = PAINT.radii[1:3]
    found[8:10] = -2.375, 2.36
    return found


def view(aside: float = 0.0) -> View:
    """Where the camera is, or so many pixels aside."""
    middle = (np.array(SIZE) - 1) / 2
    return aim(middle + np.array([aside, 0.0]), SCALE, POSITION, SIZE)


def tracker() -> EdgeTracker:
    return EdgeTracker(SIZE, np.full((FIXED, 2, 3), np.nan), Rim())


@pytest.fixture(scope="module")
def frames() -> list[Frame]:
    picture = render_still(Scene(paint=PAINT), PATH)
    return [Frame(i, i / 25, np.asarray(picture, np.uint8)) for i in range(LONGEST_STRIDE)]


@pytest.mark.parametrize("aside", [0.0, 3.0, -5.0])
def test_a_view_is_refined_on_the_edges(frames: list[Frame], aside: float) -> None:
    edges = tracker()
    (seen,) = edges.settle(frames[:1], [view(aside)], rig())
    found = camera(seen.view, rig(), SIZE)
    pixels = PATH.at(0.0).project(np.c_[RINGS, np.zeros(len(RINGS))])
    off = np.linalg.norm(found.ice(pixels) - RINGS, axis=1)
    assert np.sqrt((off**2).mean()) < 0.003
    assert edges.support > 0.8


def test_well_predicted_frames_are_followed_together(frames: list[Frame]) -> None:
    edges = tracker()
    seen = edges.settle(frames, [view()] * len(frames), rig())
    assert [s.index for s in seen] == [f.index for f in frames]
    assert edges.stride == LONGEST_STRIDE


def test_from_a_badly_predicted_frame_on_they_are_looked_at_anew(frames: list[Frame]) -> None:
    edges = tracker()
    assert edges.settle(frames[:1], [view()], rig())
    seen = edges.settle(frames, [view(), view(), view(8.0), view()], rig())
    assert [s.index for s in seen] == [0, 1]
    assert edges.stride == 1


def test_bare_ice_is_not_followed() -> None:
    bare = Frame(0, 0.0, np.full((SIZE[1], SIZE[0], 3), 225, np.uint8))
    assert tracker().settle([bare], [view()], rig()) == []


def test_a_frame_that_shows_much_less_is_looked_at_by_itself(frames: list[Frame]) -> None:
    picture = frames[0].image.copy()
    picture[:, : SIZE[0] // 2 - 60] = 70
    covered = Frame(1, 0.04, picture)
    edges = tracker()
    assert edges.settle(frames[:1], [view()], rig())
    together = [frames[0], covered], [view(), view()]
    assert len(edges.settle(*together, rig())) == 1
    assert len(edges.settle([covered], [view()], rig())) == 1
    assert edges.support < 0.8
    assert len(edges.settle(*together, rig())) == 2
