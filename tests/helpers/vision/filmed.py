"""A rendered clip of a house, and a tracker that starts from it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from curlshot.synthetic import PAINTS, Key, cached_clip, sample_scene
from curlshot.synthetic.camera import CameraPath
from curlshot.vision.camera_path.edge_tracker import EdgeTracker
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit
from curlshot.vision.sheet.marks import Evidence, measure_marks
from curlshot.vision.sheet.outline import PaintEdge
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.reader import open_video

SIZE = (1280, 720)


@cache
def filmed() -> tuple[list[Frame], HouseFit]:
    """Frames of a camera that turns slowly, and the house in the first."""
    scene = replace(sample_scene(), paint=PAINTS["navy-orange"])
    keys = (Key(0.0, 0.0, 0.3, 110), Key(2.0, 0.2, 0.6, 116, 0.02))
    file, _ = cached_clip(scene, CameraPath(SIZE, (-0.1, 0.1, 8.5), keys, 0.2), duration=0.6)
    frames = list(open_video([file]))
    house = find_house(frames[0].image)
    assert house is not None
    return frames, house


def tracker(house: HouseFit) -> EdgeTracker:
    return EdgeTracker(SIZE, house.evidence.palette, house.edge)


def smeared_evidence(edge: PaintEdge, steeper: float) -> Evidence:
    """What the first frame shows, with its edges so much steeper."""
    frames, house = filmed()
    camera = house.view.vector, house.rig
    shown = measure_marks(frames[0].image, *camera, reach=9.0, lines=False, edge=edge)
    return replace(shown, slope=steeper * shown.slope)
