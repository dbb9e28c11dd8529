from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.synthetic import PAINTS, CameraPath, Key, render_still, sample_scene
from curlshot.vision.optics.rig import OVERHEAD
from curlshot.vision.sheet.house import find_house

FAR = np.array([(x, y) for x in (-1.5, 0.0, 1.5) for y in (2.0, 4.0, 5.5)])
SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])


@pytest.mark.parametrize("quarters", [0, 1, 2])
@pytest.mark.parametrize(
    ("height", "up", "target"), [(9.0, 1.2, 3.5), (9.5, 2.2, 3.5), (8.0, 3.6, 3.1)]
)
def test_a_sliver_of_the_house_between_straight_sides_tells_where_the_camera_is(
    height: float, up: float, target: float, quarters: int
) -> None:
    """By the sliver alone places up the sheet are 30 to 84 cm off."""
    path = CameraPath((960, 540), (0.3, up, height), (Key(0.0, 0.1, target, 100),))
    image = np.rot90(np.asarray(render_still(SCENE, path), np.uint8), quarters)
    house = find_house(np.ascontiguousarray(image))
    assert house is not None and house.evidence.visible[0] < 0.45 and house.prior is not OVERHEAD
    pixels = path.at(0.0).project(np.c_[FAR, np.zeros(len(FAR))])
    seen = ((pixels > 0) & (pixels < path.size)).all(axis=1)
    assert seen.sum() >= 4
    pixels = pixels[seen]
    for width in (path.size * 2)[:quarters]:
        pixels = np.stack([pixels[:, 1], width - 1 - pixels[:, 0]], axis=-1)
    # However the axes lie, these are as far from the tee and from each other.
    true, found = FAR[seen], house.camera.ice(pixels)
    off = [np.linalg.norm(found, axis=1) - np.linalg.norm(true, axis=1)]
    off += [np.linalg.norm(found - one, axis=1) - np.linalg.norm(true - other, axis=1)
            for one, other in zip(found, true, strict=True)]  # fmt: skip
    assert np.abs(off).max() < 0.04


def test_a_camera_overhead_is_one_though_the_sides_have_told_it() -> None:
    path = CameraPath((960, 540), (0.3, 0.3, 7.2), (Key(0.0, 0.1, 3.4, 100, roll=0.1),))
    house = find_house(np.asarray(render_still(SCENE, path), np.uint8))
    assert house is not None and house.prior is OVERHEAD
