from __future__ import annotations

from dataclasses import replace
from functools import cache, lru_cache
from math import inf

import cv2
import numpy as np
import pytest

from curlshot.synthetic import PAINTS, CameraPath, Light, Scene, render_still, still_camera
from curlshot.vision.optics.paint import EIGHT, FOUR, TWELVE
from curlshot.vision.optics.rig import POSITION
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit
from curlshot.vision.sheet.mixing import half_light, likely, lit, share_of_light
from curlshot.vision.sheet.outline import PaintEdge

TIMES = 3
SIZE = (640, 360)
AROUND = np.linspace(0, 2 * np.pi, 24, endpoint=False)
RIM = 1.829 * np.stack([np.cos(AROUND), np.sin(AROUND)], axis=-1)
SHARP = Light(softness=0.3, noise=0.0, glare=0.0, texture=0.0)


def camera(size: tuple[int, int]) -> CameraPath:
    px_per_m = 84 * size[0] / SIZE[0]
    return still_camera(size=size, position=(0.1, -0.1, 9.0), target=(0.1, 0.2), px_per_m=px_per_m)


@lru_cache(maxsize=4)
def large(paint: str, outline: bool) -> np.ndarray:
    dark = (25.0, 22.0, 20.0) if outline else None
    scene = replace(Scene(paint=replace(PAINTS[paint], outline=dark)), light=SHARP)
    return render_still(scene, camera((TIMES * SIZE[0], TIMES * SIZE[1])))


@cache
def picture(paint: str, gamma: float, outline: bool = False) -> np.ndarray:
    """A house drawn large and sharp, then blurred and reduced: codes, or light if gamma is 2.2."""
    codes = np.arange(256, dtype=np.float32) / 255
    light = cv2.LUT(large(paint, outline), codes**gamma)
    light = cv2.GaussianBlur(light, (0, 0), TIMES * 0.6)
    small = 255 * cv2.resize(light, SIZE, interpolation=cv2.INTER_AREA) ** (1 / gamma)
    noise = np.random.default_rng(5).normal(0, 1.0, small.shape)
    luma = cv2.cvtColor(np.clip(small + noise, 0, 255).round().astype(np.uint8), cv2.COLOR_BGR2YUV)
    chroma = cv2.resize(luma[..., 1:], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    luma[..., 1:] = cv2.resize(chroma, SIZE, interpolation=cv2.INTER_LINEAR)
    return cv2.cvtColor(luma, cv2.COLOR_YUV2BGR)


@cache
def house(paint: str, gamma: float, outline: bool = False) -> HouseFit:
    found = find_house(picture(paint, gamma, outline))
    assert found is not None
    return found


def larger(found: HouseFit) -> float:
    """How much larger the 12-ft circle is seen than it is, mm."""
    true = camera(SIZE).at(0.0).project(np.c_[RIM, np.zeros(len(RIM))])
    seen = found.camera.ice(true)
    return 1e3 * float(((seen - RIM) * RIM).sum(1).mean() / 1.829)


@pytest.mark.parametrize("paint", ["navy-orange", "teal-red", "purple-gold"])
def test_the_edge_is_where_half_of_the_light_is(paint: str) -> None:
    """Half way between the codes it would be 2.5 to 3.4 mm too large."""
    mixed = house(paint, 2.2)
    assert mixed.edge.light[TWELVE] < -0.08 and mixed.edge.light[EIGHT] > 0.08
    assert abs(larger(mixed)) < 1.2


@pytest.mark.parametrize("paint", ["navy-orange", "teal-red", "purple-gold"])
def test_or_half_way_between_codes_that_were_blurred(paint: str) -> None:
    coded = house(paint, 1.0)
    assert abs(coded.edge.light[TWELVE]) < 0.03
    assert abs(larger(coded)) < 0.6


@pytest.mark.parametrize("paint", ["navy-orange", "teal-red", "green-lime", "red-blue"])
def test_an_outline_is_not_taken_for_light(paint: str) -> None:
    found = house(paint, 1.0, outline=True)
    assert not any(found.edge.light)


def test_what_a_line_hides_is_left_open() -> None:
    image, found = picture("navy-orange", 2.2), house("navy-orange", 2.2)
    camera = found.view, found.rig, found.evidence
    plain, lined = (lit(PaintEdge(sd=0.01, line=line), image, *camera) for line in (0.0, 0.3))
    assert any(plain.light) and not any(lined.light)
    assert lined.sd > plain.sd > 0.01


@pytest.mark.parametrize("gamma", [1.0, 2.2])
def test_without_colour_the_edge_lies_between_the_two_and_as_unsure_as_that(gamma: float) -> None:
    """Half way between codes it would be 3.1 mm too large where light was blurred."""
    image = picture("navy-orange", gamma)
    grey = np.repeat(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)[..., None], 3, -1)
    found = find_house(grey)
    assert found is not None
    assert -0.12 < found.edge.light[TWELVE] < -0.05
    assert 0.6 < abs(larger(found)) < min(2.2, 2e3 * found.edge.sd / 84)


def test_rings_too_pale_tell_what_is_usual_of_light_and_rings_out_of_view_nothing() -> None:
    image, found = picture("navy-orange", 2.2), house("navy-orange", 2.2)
    view, rig = found.view, found.rig
    slope = found.evidence.steepness
    assert share_of_light(np.full_like(image, 230), view, rig, slope) == likely(0.0, inf)
    away = rig.copy()
    away[POSITION] += 9.0, 0.0, 0.0
    assert share_of_light(image, view, away, slope) is None


@pytest.mark.parametrize("measured", [-0.2, 0.05, 0.5, 0.9, 1.1])
def test_a_share_of_light_is_as_likely_as_among_those_measured_alike(measured: float) -> None:
    rng = np.random.default_rng(3)
    count, sd = 400_000, 0.25
    computer, lens, any_of_them = np.zeros(count), rng.uniform(0.8, 1, count), rng.random(count)
    share = np.concatenate([computer, lens, any_of_them])
    alike = share[np.abs(share + rng.normal(0, sd, share.shape) - measured) < 0.01]
    mean, spread = likely(measured, sd)
    assert mean == pytest.approx(alike.mean(), abs=0.02)
    assert spread == pytest.approx(alike.std(), abs=0.02)


@pytest.mark.parametrize(("measured", "nearest"), [(1.2, 1.0), (0.504, 0.5), (-0.01, 0.0)])
def test_a_share_of_light_that_is_measured_closely_is_the_nearest(
    measured: float, nearest: float
) -> None:
    assert likely(measured, 1e-4)[0] == pytest.approx(nearest)


@pytest.mark.parametrize("paint", ["navy-orange", "teal-red", "purple-gold", "blue-red"])
@pytest.mark.parametrize("gamma", [1.0, 2.2])
def test_the_scale_is_as_good_as_is_said_if_the_colours_tell_what_was_blurred(
    paint: str, gamma: float
) -> None:
    found = house(paint, gamma)
    stated = 1e3 * found.edge.sd / 84
    assert abs(larger(found)) < 2 * stated < 2.6


def test_half_of_the_light_lies_beside_the_brighter_side() -> None:
    palette = np.full((9, 2, 3), np.nan)
    palette[TWELVE] = [[230.0] * 3, [40.0] * 3]
    palette[EIGHT] = palette[TWELVE][::-1]
    level = half_light(palette)
    # Half of 230 ** 2.2 + 40 ** 2.2 is the light of code 169.5.
    assert level[TWELVE] == pytest.approx((135 - 169.46) / 190, abs=2e-4)
    assert level[EIGHT] == pytest.approx(-level[TWELVE])
    assert level[FOUR] == 0.0
