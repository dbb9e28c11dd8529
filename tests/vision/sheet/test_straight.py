from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.synthetic import PAINTS, CameraPath, Key, render_still, sample_scene
from vision.sheet.house import find_house

FAR = np.array([(x, y) for x in (-1.5, 0.0, 1.5) for y in (2.0, 4.0, 5.5)])
SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])


@pytest.mark.parametrize(
    ("height", "up", "target"),
    [(9.0, 1.2, 3.5), (9.5, 2.2, 3.5), (8.0, 3.6, 3.1), (9.0, -2.0, 3.9)],
)
def test_a_sliver_of_the_house_between_straight_sides_tells_where_the_camera_is(
    height: float, up: float, target: float
) -> None:
    """By the sliver alone places up the sheet are 9 to 84 cm off."""
    path = CameraPath((960, 540), (0.3, up, height), (Key(0.0, 0.1, target, 100),))
    house = find_house(np.asarray(render_still(SCENE, path), np.uint8))
    assert house is not None and house.evidence.visible[0] < 0.45
    pixels = path.at(0.0).project(np.c_[FAR, np.zeros(len(FAR))])
    seen = ((pixels > 0) & (pixels < path.size)).all(axis=1)
    assert seen.sum() >= 4
    assert np.hypot(*(house.camera.ice(pixels[seen]) - FAR[seen]).T).max() < 0.03
