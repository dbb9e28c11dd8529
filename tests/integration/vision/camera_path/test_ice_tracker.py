from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.tests.helpers.vision.filmed import filmed, tracker
from curlshot.vision.camera_path.edge_tracker import EdgeTracker
from curlshot.vision.camera_path.ice_tracker import IceTracker
from curlshot.vision.camera_path.joint import Seen
from curlshot.vision.camera_path.landmarks import Landmarks
from curlshot.vision.sheet.house_fit import HouseFit
from curlshot.vision.video.frame import Frame


def started() -> tuple[list[Frame], HouseFit, EdgeTracker, Seen]:
    """Frames of a house, of which the first has been followed."""
    frames, house = filmed()
    edges = tracker(house)
    (first,) = edges.settle(frames[:1], [house.view], house.rig, house.view)
    return frames, house, edges, first


def covered(frame: Frame, house: HouseFit) -> Frame:
    """A frame with something large on the rings."""
    tee = np.round(house.camera.project([0.0, 0.0])).astype(int).tolist()
    image = frame.image.copy()
    cv2.circle(image, tee, 215, (90, 140, 60), -1)
    return replace(frame, picture=image)


def test_where_no_rings_are_in_view_what_is_fixed_to_the_ice_carries_on() -> None:
    frames, house, edges, first = started()
    ice = IceTracker()
    (carried,) = ice.settle(
        [covered(frames[1], house)], [first.view], first, frames[0].picture, house.rig, edges
    )
    assert ice.landmarks is not None
    assert not carried.found and carried.key is ice.landmarks.key
    assert ice.missed == 1  # the rings should be in view
    assert np.abs(carried.view.vector - first.view.vector).max() * house.view.focal < 8.0
    (again,) = ice.settle([frames[2]], [carried.view], carried, frames[1].picture, house.rig, edges)
    assert again.found and ice.landmarks is None and ice.missed == 0


def test_other_pictures_are_not_taken_for_the_same_ice() -> None:
    frames, house, edges, first = started()
    shape = frames[1].picture.shape
    noise = np.random.default_rng(0).integers(0, 255, shape, np.uint8)
    other = replace(frames[1], picture=noise)
    picture = frames[0].picture
    assert IceTracker().settle([other], [first.view], first, picture, house.rig, edges) == []


def test_frames_carried_together_are_placed_as_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    frames, house, edges, first = started()
    monkeypatch.setattr(EdgeTracker, "expects", lambda *_: False)
    block, picture = frames[1:5], frames[0].picture
    ice, views = IceTracker(), [first.view] * len(block)
    together = ice.settle(block, views, first, picture, house.rig, edges)
    assert [s.index for s in together] == [frame.index for frame in block]
    for frame, one in zip(block, together, strict=True):
        (other,) = ice.settle([frame], [first.view], first, picture, house.rig, edges)
        assert np.abs(one.view.vector - other.view.vector).max() * house.view.focal < 0.3


def test_frames_up_to_the_first_of_another_scene_are_placed() -> None:
    frames, house, edges, first = started()
    noise = np.random.default_rng(1).integers(0, 255, frames[2].picture.shape, np.uint8)
    block = [frames[1], replace(frames[2], picture=noise), frames[3]]
    seen = IceTracker().settle(block, [first.view] * 3, first, frames[0].picture, house.rig, edges)
    assert [s.index for s in seen] == [frames[1].index]


def test_where_a_keyframe_no_longer_does_the_frame_before_does() -> None:
    frames, house, edges, first = started()
    ice, picture = IceTracker(), covered(frames[1], house).picture
    (carried,) = ice.settle(
        [covered(frames[1], house)], [first.view], first, frames[0].picture, house.rig, edges
    )
    assert ice.landmarks is not None
    few = replace(ice.landmarks.key, ice=np.zeros((0, 2)), corners=np.zeros((0, 2)))
    ice.landmarks = Landmarks(few)
    after = [covered(frames[2], house)]
    (again,) = ice.settle(after, [carried.view], carried, picture, house.rig, edges)
    assert again.key is not None and again.key.frame == carried.index
    assert again.key.drift > few.drift
