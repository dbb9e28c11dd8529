"""What tests of shutter share."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from curlshot.synthetic import PAINTS, CameraPath, Light, Scene, render_still, still_camera
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit

SIZE = (960, 540)
HEIGHT, PX_PER_M = 9.0, 100.0
BEFORE, MIDDLE, SWEPT = 0.05, 0.35, 0.15
"""Where the camera looks, m: in the frame before, at mid-exposure, and how far it goes in one."""
OUTLINED = replace(PAINTS["navy-orange"], outline=(25.0, 22.0, 20.0))
SCENE = replace(Scene(paint=OUTLINED), light=Light(noise=0.0, glare=0.0))


def looking(y: float) -> CameraPath:
    return still_camera(size=SIZE, position=(0.1, -0.1, HEIGHT), target=(0.1, y), px_per_m=PX_PER_M)


@cache
def before() -> HouseFit:
    found = find_house(render_still(SCENE, looking(BEFORE)))
    assert found is not None
    return found
