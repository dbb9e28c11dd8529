from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.data.sheet import STONE
from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.smeared import PATH, VIEW, learned, smeared
from curlshot.tests.helpers.vision.stones import CAMERA, RED, scene_of
from curlshot.vision.association.again import measure_again
from curlshot.vision.association.follower import StoneView
from curlshot.vision.detection.stones import FOLLOWING, search_picture
from curlshot.vision.video.frame import Frame


def test_stones_whose_motion_shows_only_later_are_measured_again() -> None:
    views = []
    for k, picture in enumerate(map(smeared, range(3))):
        found = search_picture(picture, VIEW, learned()).stones
        views.append(StoneView(Frame(k, 0.04 * k, picture), VIEW, list(found)))
        assert len(found) == 1 and not found[0].swept
    measure_again(views, learned(), STONE, FOLLOWING)
    for view, truth in zip(views, PATH, strict=True):
        assert view.detections[0].swept
        assert np.hypot(*(view.places[0] - truth)) < 0.0025


def test_a_stone_at_rest_is_smeared_by_a_camera_that_goes_past_it() -> None:
    views = []
    for k, picture in enumerate(map(smeared, range(3))):
        # The same pictures, of ice that goes with the stone.
        along, past = np.eye(3), VIEW.position
        along[:2, 2] = PATH[k] - PATH[0]
        assert past is not None
        homography = np.asarray(VIEW.homography @ along, np.float64)
        camera = replace(VIEW, homography=homography, position=past - [*along[:2, 2].tolist(), 0.0])
        found = search_picture(picture, camera, learned()).stones
        assert len(found) == 1
        before = views[-1].camera if views else None
        views.append(StoneView(Frame(k, 0.04 * k, picture), camera, list(found), before))
    places = views[1].places
    drift = views[1].drift_seen(places, np.zeros((1, 2)))
    np.testing.assert_allclose(drift, [PATH[1] - PATH[0]], atol=1e-9)
    np.testing.assert_allclose(views[1].drift_seen(places, PATH[:1] - PATH[1]), 0, atol=1e-9)
    measure_again(views, learned(), STONE, FOLLOWING)
    assert [view.detections[0].swept for view in views] == [False, True, True]
    for view in views[1:]:
        assert np.hypot(*(view.places[0] - PATH[0])) < 0.0025


def test_another_stone_in_the_next_picture_is_no_motion() -> None:
    views = []
    for k, place in enumerate([(0.3, 1.7), (0.3, 1.4)]):
        picture = render_still(scene_of([(*place, RED)]), CAMERA)
        found = search_picture(picture, VIEW, learned()).stones
        views.append(StoneView(Frame(k, 0.04 * k, picture), VIEW, list(found)))
    before = [list(view.detections) for view in views]
    measure_again(views, learned(), STONE, FOLLOWING)
    assert [view.detections for view in views] == before
