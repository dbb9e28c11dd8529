from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.synthetic import PAINTS, Scene, render_still, still_camera, tilted_camera
from curlshot.synthetic.camera import CameraPath, Key
from curlshot.tests.helpers.vision.places import RINGS
from curlshot.vision.optics.pose import ROLL, camera
from curlshot.vision.optics.rig import ANYWHERE, OVERHEAD
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import RoughFit, fit_roughly, refine, start
from curlshot.vision.sheet.rings import Guess

SIZE = (640, 360)
OVER = still_camera(size=SIZE, position=(0.1, -0.1, 9.0), target=(0.1, 0.2), px_per_m=60)
TILTED = tilted_camera(np.deg2rad(40), size=SIZE, px_per_m=60)
SCENE = Scene(paint=PAINTS["navy-orange"])


def guess(path: CameraPath) -> Guess:
    """Where the tee is, with an error of a few pixels and per cent."""
    tee, right = path.at(0.0).project(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    scale = float(np.linalg.norm(right - tee))
    return Guess(tee + np.array([2.0, -1.0]), 1.03 * scale, 1.0 if path is OVER else 0.75, 0.0, 1.0)


def roughly(image: np.ndarray, path: CameraPath) -> RoughFit | None:
    here = guess(path)
    return fit_roughly(image, *start(here, SIZE), here.scale, float(here.centre[0]))


@pytest.mark.parametrize("path", [OVER, TILTED], ids=["overhead", "tilted"])
def test_it_starts_where_the_guess_is(path: CameraPath) -> None:
    here = guess(path)
    view, rig, prior = start(here, SIZE)
    assert prior is (OVERHEAD if path is OVER else ANYWHERE)
    tee, right, up = camera(view, rig, SIZE).project(0.1 * np.array([[0, 0], [1, 0], [0, 1]]))
    np.testing.assert_allclose(tee, here.centre, atol=0.01)
    assert np.linalg.norm(right - tee) == pytest.approx(0.1 * here.scale, rel=0.06)
    assert up[1] < tee[1] and abs(up[0] - tee[0]) < 0.1 * (tee[1] - up[1])
    short = np.linalg.norm(up - tee) / np.linalg.norm(right - tee)
    assert short == pytest.approx(here.foreshortening, rel=0.05)


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


def test_circles_alone_do_not_roll_a_view() -> None:
    begin, *_ = start(guess(OVER), SIZE)
    rough = roughly(render_still(SCENE, OVER), OVER)
    assert rough is not None
    assert abs(rough.view.vector[ROLL] - begin.vector[ROLL]) < 0.003


def test_what_lies_aside_is_worth_less() -> None:
    image, here = render_still(SCENE, OVER), guess(OVER)
    scores = []
    for x in (0.5, 0.9):
        fit = fit_roughly(image, *start(here, SIZE), here.scale, x * SIZE[0])
        assert fit is not None
        scores.append(fit.score)
    assert scores[0] > scores[1] + 0.5


def test_nothing_is_fitted_to_bare_ice() -> None:
    bare = render_still(SCENE, replace(OVER, keys=(replace(OVER.keys[0], y=9.0),)))
    assert roughly(bare, OVER) is None
