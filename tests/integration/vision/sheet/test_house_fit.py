from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.synthetic import render_still, still_camera
from curlshot.synthetic.camera import CameraPath, Key
from curlshot.tests.helpers.vision.house_fit import OVER, SCENE, TILTED, roughly
from curlshot.tests.helpers.vision.places import RINGS
from curlshot.vision.optics.rig import OVERHEAD
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import refine


@pytest.mark.parametrize("path", [OVER, TILTED], ids=["overhead", "tilted"])
def test_a_rough_fit_is_refined_to_millimetres(path: CameraPath) -> None:
    image = render_still(SCENE, path)
    rough = roughly(image, path)
    assert rough is not None
    fit = refine(image, rough, 1.0, 7, 0.28)
    assert fit is not None
    assert (fit.camera.frame, fit.camera.t) == (7, 0.28)
    assert (fit.prior is OVERHEAD) == (path is OVER)
    pixels = path.at(0.0).project(np.c_[RINGS, np.zeros(len(RINGS))])
    off = np.linalg.norm(fit.camera.ice(pixels) - RINGS, axis=1)
    assert np.sqrt((off**2).mean()) < 0.006
    assert fit.rms_px < 0.6


@pytest.mark.parametrize(
    ("place", "target"),
    [
        ((0.0, -2.5), (0.0, -1.5)),
        ((-0.9, -2.5), (-0.5, -1.5)),
        ((0.9, -1.75), (0.5, -1.5)),
        ((0.0, 2.5), (0.0, 1.5)),
        ((1.75, -0.5), (1.2, -0.3)),
        ((-1.75, 0.5), (-1.2, 0.3)),
    ],
)
def test_a_camera_10_to_15_degrees_aslant_is_told_where_the_tee_is_off_the_middle(
    place: tuple[float, float], target: tuple[float, float]
) -> None:
    """From straight above the fit ended 5 cm and more off, where guards lie."""
    position = (*place, 9.5)
    path = still_camera(size=(1280, 720), position=position, target=target, px_per_m=115)
    image = render_still(SCENE, path)
    found = find_house(image)
    assert found is not None and found.prior is not OVERHEAD
    ice = np.array([[x, y] for x in (-1.5, 0.0, 1.5) for y in (-3.0, -1.5, 0.0, 1.0)])
    pixels = path.at(0.0).project(np.c_[ice, np.zeros(len(ice))])
    off = np.linalg.norm(found.camera.ice(pixels) - ice, axis=1)
    assert off.max() < 0.02


@pytest.mark.parametrize(("k1", "k2", "y"), [(-0.24, 0.055, -0.8), (-0.2, 0.04, -1.2)])
def test_a_wide_lens_is_told_without_a_hog_line(k1: float, k2: float, y: float) -> None:
    """With what is expected of broadcasts' lenses guards were 60 to 150 mm off."""
    path = CameraPath((480, 760), (0.03, y, 4.5), (Key(0.0, 0.05, 1.2, 100.0, k1=k1, k2=k2),))
    sheet = replace(SCENE.sheet, hog_line=SCENE.sheet.ice)
    found = find_house(np.asarray(render_still(replace(SCENE, sheet=sheet), path), np.uint8))
    assert found is not None
    guards = np.array([(x, y) for x in (-1.0, 0.0, 1.0) for y in (2.5, 3.5, 4.5)])
    pixels = path.at(0.0).project(np.c_[guards, np.zeros(len(guards))])
    assert np.linalg.norm(found.camera.ice(pixels) - guards, axis=1).max() < 0.008
