from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.synthetic import PAINTS, Key, Paint, render_still, sample_scene
from curlshot.synthetic.camera import CameraPath
from curlshot.tests.helpers.vision.filmed import SIZE, filmed, smeared_evidence, tracker
from curlshot.vision.camera_path.edge_tracker import LONGEST_STRIDE, SHARPER, EdgeTracker, put_right
from curlshot.vision.optics.paint import CENTRE_LINE, CIRCLES, EIGHT, FOUR, HOG_LINE, TWELVE
from curlshot.vision.optics.pose import View, project
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.outline import PaintEdge
from curlshot.vision.video.frame import Frame

ANGLE = np.arange(16) * np.pi / 8


def test_frames_followed_together_are_placed_as_alone() -> None:
    frames, house = filmed()
    together, alone = tracker(house), tracker(house)
    block = frames[: LONGEST_STRIDE // 2]
    seen = together.settle(block, [house.view] * len(block), house.rig, house.view)
    assert [s.index for s in seen] == [frame.index for frame in block]
    for frame, one in zip(block, seen, strict=True):
        (other,) = alone.settle([frame], [house.view], house.rig, house.view)
        assert np.abs(one.view.vector - other.view.vector).max() * one.view.focal < 0.3


def test_the_stride_grows_while_views_are_foretold_and_shrinks_when_not() -> None:
    frames, house = filmed()
    edges = tracker(house)
    edges.settle(frames[:1], [house.view], house.rig, house.view)
    assert edges.stride == 2
    edges.settle(frames[1:3], [house.view] * 2, house.rig, house.view)
    assert edges.stride == 4 <= LONGEST_STRIDE
    aside = View(house.view.vector + np.array([0.0, 9.0 / house.view.focal, 0.0, 0.0]))
    (found,) = edges.settle(frames[3:4], [aside], house.rig, house.view)
    assert edges.stride == 1
    assert np.abs(found.view.vector - house.view.vector)[1] * house.view.focal < 6.0


def test_up_to_the_first_that_does_not_show_the_house() -> None:
    frames, house = filmed()
    bare = Frame(2, 0.08, np.full((SIZE[1], SIZE[0], 3), 230, np.uint8))
    edges = tracker(house)
    views = [house.view] * 4
    seen = edges.settle([*frames[:2], bare, frames[3]], views, house.rig, house.view)
    assert [s.index for s in seen] == [0, 1]
    assert edges.settle([bare], [house.view], house.rig, house.view) == []


def test_where_the_circles_are_out_of_view_there_are_still_lines() -> None:
    frames, house = filmed()
    edges = tracker(house)
    assert edges.expects(house.view, house.rig)
    (lines,) = edges.lines([frames[0].picture], [house.view], house.rig)
    assert len(lines) > 10 and (lines.line >= CIRCLES).all()
    away = View(house.view.vector + np.array([1.0, 0.0, 0.0, 0.0]))
    assert not edges.expects(away, house.rig)


def test_the_hog_line_counts_once_it_is_known_where_no_pan_smears_it() -> None:
    path = CameraPath(SIZE, (0.0, 0.0, 9.0), (Key(0.0, 0.0, 3.2, 72),))
    image = render_still(replace(sample_scene(), paint=PAINTS["navy-orange"]), path, 0.0)
    house = find_house(image)
    assert house is not None
    known, unknown, smeared = (tracker(house) for _ in range(3))
    unknown.palette = house.evidence.palette.copy()
    unknown.palette[HOG_LINE] = np.nan
    smeared.sweep = np.array([0.0, 12.0])
    shown = []
    for edges in (known, unknown, smeared):
        (lines,) = edges.lines([image], [house.view], house.rig)
        assert CENTRE_LINE in lines.line
        shown.append(HOG_LINE in lines.line)
    assert shown == [True, False, False]


def test_a_house_of_other_colours_is_told() -> None:
    _, house = filmed()
    edges = tracker(house)
    assert edges.looks_like(house.evidence.palette)
    assert edges.looks_like(0.4 * house.evidence.palette)  # faded
    assert not edges.looks_like(house.evidence.palette[:, ::-1])


def test_outlines_alone_that_are_wider_than_usual_normals_are_followed() -> None:
    path = CameraPath(SIZE, (0.0, 0.0, 9.0), (Key(0.0, 0.0, 0.3, 175),))
    bare = Paint(*[(222, 226, 226)] * 4, outline=(150, 60, 30), outline_width=0.045)
    image = render_still(replace(sample_scene(), paint=bare), path, 0.0)
    house = find_house(image)
    assert house is not None
    aside = View(house.view.vector + np.array([0.0, 3.0 / house.view.focal, 0.0, 0.0]))
    (seen,) = tracker(house).settle([Frame(0, 0.0, image)], [aside], house.rig, house.view)
    rim = 1.829 * np.stack([np.cos(ANGLE), np.sin(ANGLE)], -1)
    true = path.at(0.0).project(np.c_[rim, 0 * ANGLE])
    assert np.abs(project(rim, seen.view.vector, house.rig, SIZE) - true).max() < 0.2


def test_a_sharper_frame_tells_anew_where_circles_are() -> None:
    """A smeared one said that they lie a fifth of a step from half way; codes were blurred."""
    frames, house = filmed()
    wrong = PaintEdge(light=(-0.2, 0.2, -0.2))
    for smeared, again in ((0.9 / SHARPER, True), (1.1 / SHARPER, False)):
        told = smeared_evidence(wrong, smeared)
        edges = EdgeTracker(SIZE, house.evidence.palette, wrong, told)
        (seen,) = edges.settle(frames[:1], [house.view], house.rig, house.view)
        assert bool(edges.moved.any()) == again
        right = put_right(seen.marks.get(), edges.moved)
        (true,) = tracker(house).settle(frames[:1], [house.view], house.rig, house.view)
        for circle in (TWELVE, EIGHT, FOUR):
            near, far = (m.pixel[m.line == circle] for m in (right, true.marks.get()))
            aside = np.linalg.norm(near[:, None] - far, axis=2).min(1)
            assert (np.median(aside) < 0.15) == again
