from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tests.synthetic import PAINTS, render_still, sample_scene, tilted_camera
from vision.house import find_house
from vision.house_fit import HouseFit
from vision.picture import Image
from vision.pose import project
from vision.proof import is_house, worth

SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])


@pytest.fixture(scope="module")
def low() -> tuple[Image, HouseFit]:
    """A house from so near that circles about it run behind the camera."""
    camera = tilted_camera(np.deg2rad(50), height=3.4, px_per_m=110)
    picture = np.asarray(render_still(SCENE, camera, 0.0), np.uint8)
    found = find_house(picture)
    assert found is not None
    assert np.hypot(*found.rig[:2]) < 5.0
    return picture, found


def test_a_house_is_one_though_its_surroundings_reach_behind_the_camera(
    low: tuple[Image, HouseFit],
) -> None:
    picture, found = low
    assert worth(found.evidence) > 1.5
    assert is_house(picture, found.evidence, found.view, found.rig)


def test_a_circle_more_than_a_house_has_makes_a_target(low: tuple[Image, HouseFit]) -> None:
    picture, found = low
    angle = np.linspace(0, 2 * np.pi, 200)
    ring = 1.5 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    size = (picture.shape[1], picture.shape[0])
    line = project(ring, found.view.vector, found.rig, size)
    target = picture.copy()
    cv2.polylines(target, [np.round(line).astype(np.int32)], True, (30, 200, 230), 6)
    assert not is_house(target, found.evidence, found.view, found.rig)
