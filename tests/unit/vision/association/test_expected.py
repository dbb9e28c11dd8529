from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
from curlshot.vision.association.expected import look_beside, look_on_course
from curlshot.vision.detection.appearance import learn
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import SEARCH, search_picture


def test_a_stone_seen_a_moment_ago_needs_less_evidence() -> None:
    scene = scene_of([(0.2, 0.9, RED), (-0.4, 0.2, YELLOW)])
    image, camera = np.asarray(render_still(scene, CAMERA), np.uint8), camera_of(CAMERA, scene)
    known = search_picture(image, camera).stones
    strict = replace(SEARCH, min_evidence=1 + max(stone.score for stone in known))
    assert search_picture(image, camera, search=strict).stones == ()
    looks = [Look(image, camera, np.array([(stone.x, stone.y) for stone in known]))]
    assert None not in look_on_course(looks, learn(known), search=strict)


def test_where_no_stone_is_none_is_seen() -> None:
    scene = scene_of([(0.2, 0.9, RED), (-0.4, 0.2, YELLOW)])
    image, camera = np.asarray(render_still(scene, CAMERA), np.uint8), camera_of(CAMERA, scene)
    learned = learn(search_picture(image, camera).stones)
    look = Look(image, camera, np.array([[0.2, 0.9], [1.2, 0.3], [0.2, 0.75]]))
    first, bare, beside = look_on_course([look], learned)
    assert first is not None
    assert bare is None
    assert beside is None  # a radius aside is no longer on course


def test_beside_a_stone_that_answers_where_it_was_seen_nothing_is_measured() -> None:
    scene = scene_of([(0.2, 0.9, RED), (-0.4, 0.2, YELLOW)])
    image, camera = np.asarray(render_still(scene, CAMERA), np.uint8), camera_of(CAMERA, scene)
    learned = learn(search_picture(image, camera).stones)
    look = Look(image, camera, np.array([[0.2, 0.9], [-0.4, 0.2]]))
    here = look_on_course([look], learned)
    aside = [None if s is None else s._replace(x=s.x + 0.02) for s in here]
    assert look_beside(look, [here[0], aside[1]], learned)[0] is None
    _, beside = look_beside(look, [here[0], aside[1]], learned)
    assert beside is not None
    assert np.hypot(beside.x + 0.4, beside.y - 0.2) < 0.008
