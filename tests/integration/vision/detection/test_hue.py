from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.camera import still_camera
from curlshot.synthetic.clip import render_still
from curlshot.synthetic.scenes import PAINTS
from curlshot.tests.helpers.vision.stones import RED, YELLOW, camera_of, scene_of
from curlshot.vision.detection.appearance import Appearance, learn
from curlshot.vision.detection.hue import sharpened
from curlshot.vision.detection.measure import Measures, _better, _on_paint, measure_discs
from curlshot.vision.detection.rays import Look, Rays
from curlshot.vision.detection.stones import SEARCH, search_picture

CAMERA = still_camera(px_per_m=110.0, target=(0.0, 0.6))
ON_PAINT = np.array([[0.0, 0.36], [-0.3, -0.2], [0.36, 0.0]])
ON_ICE = [(1.0, 0.1, RED), (0.8, 2.3, YELLOW), (-0.9, 2.6, RED), (-0.95, 0.3, YELLOW)]
CAPS = (RED, RED, YELLOW)
SCENE = scene_of(
    [*((x, y, cap) for (x, y), cap in zip(ON_PAINT.tolist(), CAPS, strict=True)), *ON_ICE],
    paint=PAINTS["teal-red"],
)
BLUR = 3.5
"""Of hue, px: wider than what is undone. At 2.5 these stones, cleaner than any real one, are told
as they are."""
VIEW = camera_of(CAMERA, SCENE)


def coded(picture: np.ndarray, blur: float) -> np.ndarray:
    """A picture with its hue blurred, as coding does, px."""
    told = cv2.cvtColor(np.asarray(picture, np.uint8), cv2.COLOR_BGR2YCrCb)
    told[..., 1:] = cv2.GaussianBlur(told[..., 1:], (0, 0), blur)
    return np.asarray(cv2.cvtColor(told, cv2.COLOR_YCrCb2BGR))


def learned(picture: np.ndarray) -> Appearance:
    known = learn(search_picture(picture, VIEW).stones)
    assert known is not None
    return known


def measures(picture: np.ndarray, places: np.ndarray) -> Measures:
    return measure_discs([Look(picture, VIEW, places)], learned(picture), STONE)


def test_caps_on_paint_of_their_hue_are_told_where_coding_tinges_their_granite() -> None:
    picture = coded(render_still(SCENE, CAMERA), BLUR)
    told = measures(picture, ON_PAINT)
    assert told.evidence.min() > SEARCH.min_evidence
    assert np.hypot(*(told.centre - ON_PAINT).T).max() < 0.01


@pytest.mark.parametrize(("around", "vivid"), [(0.15, False), (0.4, True)])
def test_paint_tinges_granite_where_it_is_vivid_around_a_good_part(
    around: float, vivid: bool
) -> None:
    picture = np.asarray(render_still(SCENE, CAMERA), np.uint8)
    rays, known = measures(picture, ON_PAINT[:1]).rays, learned(picture)
    assert known.granite is not None
    lab = rays.lab.copy()
    lab[:, :, -1] = known.granite.mean
    lab[:, : round(around * lab.shape[1]), -1, 1] += 50
    assert _on_paint(replace(rays, lab=lab), known).tolist() == [vivid]


@pytest.mark.parametrize(
    ("uncovered", "evidence", "taken"), [(0.1, 0.3, True), (0.02, 0.3, False), (0.1, -0.1, False)]
)
def test_sharper_hue_counts_where_it_shows_more_of_a_stone(
    uncovered: float, evidence: float, taken: bool
) -> None:
    picture = np.asarray(render_still(SCENE, CAMERA), np.uint8)
    first = measures(picture, ON_PAINT)
    part = first.rays.at_places(np.array([1]))
    second = replace(
        measures(picture, ON_PAINT[1:2]),
        visible=first.visible[1:2] + uncovered,
        evidence=first.evidence[1:2] + evidence,
        rays=replace(part, bgr=255 - part.bgr),
    )
    best = _better(first, second, np.array([1]))
    np.testing.assert_allclose(best.evidence - first.evidence, [0, evidence * taken, 0], atol=1e-9)
    changed = (best.rays.bgr != first.rays.bgr).any((1, 2, 3))
    assert changed.tolist() == [False, taken, False]


def test_paint_alone_becomes_no_stone() -> None:
    bare = scene_of(ON_ICE, paint=PAINTS["teal-red"])
    picture = coded(render_still(bare, CAMERA), BLUR)
    grid = np.stack(np.meshgrid(np.arange(-0.6, 0.61, 0.15), np.arange(-0.6, 0.61, 0.15)), -1)
    seen = measures(picture, grid.reshape(-1, 2))
    assert not (seen.ok & (seen.evidence > 0.7)).any()


@pytest.mark.parametrize("scale", [100.0, 140.0])
def test_hue_that_was_blurred_comes_back_and_lightness_stays(scale: float) -> None:
    radius = np.linspace(0.03, 0.154, 44)
    px = (radius[1] - radius[0]) * scale
    vivid = np.where((radius > 0.105) & (radius < 0.1455), 0.0, 1.0)
    fine = np.repeat(vivid, 20)
    wide = np.pad(fine, 2000, mode="edge")
    at = np.arange(-1500, 1501)
    kernel = np.exp(-0.5 * (at * px / 20 / 2.5) ** 2)
    blurred = np.convolve(wide, kernel / kernel.sum(), "same")[2000:-2000].reshape(44, 20).mean(1)

    def rays_of(hue: np.ndarray) -> Rays:
        grey = 90 + 20 * np.sin(np.arange(44))
        tinge = np.array([-0.299, -0.299, 0.701]) * 80  # no lightness by itself
        bgr = np.clip(np.rint(grey[:, None] + hue[:, None] * tinge), 0, 255).astype(np.uint8)
        bgr = np.tile(bgr, (2, 8, 1, 1))
        return Rays(bgr, bgr, np.ones(bgr.shape[:3], bool), radius, np.arange(8) * np.pi / 4)

    sharp = sharpened(rays_of(blurred), np.array([scale, scale]))
    weights = np.array([0.114, 0.587, 0.299])
    lightness, redness = sharp.bgr @ weights, sharp.bgr @ [-0.5, -0.5, 1.0]
    np.testing.assert_allclose(lightness, rays_of(blurred).bgr @ weights, atol=1.0)
    ring = (radius > 0.115) & (radius < 0.135)
    before, true = (rays_of(hue).bgr @ [-0.5, -0.5, 1.0] for hue in (blurred, vivid))
    off, was = (np.abs(red - true)[..., ring].mean() for red in (redness, before))
    assert off < 0.6 * was
    plain = rays_of(np.ones(44))
    np.testing.assert_allclose(
        sharpened(plain, np.array([scale, scale])).bgr.astype(int), plain.bgr, atol=1
    )
    assert sharp.lab.shape == sharp.bgr.shape and (sharp.inside == plain.inside).all()
