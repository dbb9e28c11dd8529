from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
from curlshot.vision.detection.appearance import Colour
from curlshot.vision.detection.balance import (
    BRIGHT,
    CHANGED,
    DIM,
    GRANITE,
    MOST_BRIGHTENED,
    Balance,
    brightening,
    tones,
)
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.colour import lab_of
from curlshot.vision.video.picture import Image, image_of, toned

SCENE = scene_of([(0.3, 0.2, RED), (-0.8, 1.0, YELLOW)])


@pytest.fixture(scope="module")
def picture() -> Image:
    return np.asarray(render_still(SCENE, CAMERA) * 0.8, np.uint8)


@pytest.fixture(scope="module")
def camera() -> Camera:
    return camera_of(CAMERA, SCENE)


def lit(picture: Image, gain: NDArray[np.float64]) -> Image:
    return np.clip(picture * gain, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("gain", [(0.6, 1.0, 1.1), (1.2, 1.2, 1.2), (0.5, 0.5, 0.5)])
def test_a_picture_in_another_light_is_made_like_the_first(
    picture: Image, camera: Camera, gain: tuple[float, float, float]
) -> None:
    now = lit(picture, np.array(gain))
    balance = Balance(picture, camera)
    balance.look(now, camera)
    like = image_of(balance.evened(now)).astype(float)
    assert np.abs((like - picture).mean((0, 1))).max() < 2.0


def test_a_light_that_hardly_changes_leaves_pictures_as_they_are(
    picture: Image, camera: Camera
) -> None:
    balance = Balance(picture, camera)
    balance.look(lit(picture, np.full(3, 1 - 0.8 * CHANGED)), camera)
    assert balance.evened(picture) is picture


def test_neither_a_pan_nor_people_are_taken_for_another_light(
    picture: Image, camera: Camera
) -> None:
    balance = Balance(picture, camera)
    height, width = picture.shape[:2]
    hidden = picture.copy()
    hidden[:, : int(0.4 * width)] = (60, 20, 90)
    balance.look(hidden, camera)
    assert balance.evened(picture) is picture
    # Zoomed in at what shows another share of paint.
    zoom = np.array([[2.0, 0, -width / 2], [0, 2.0, -height / 2], [0, 0, 1]])
    near = cv2.warpAffine(picture, zoom[:2], (width, height))
    homography = zoom @ camera.homography
    closer = Camera(1, 0.04, homography / homography[2, 2], camera.size)
    balance.look(np.asarray(near, np.uint8), closer)
    assert balance.evened(picture) is picture


def test_ice_that_comes_into_view_later_tells_of_the_light_too(
    picture: Image, camera: Camera
) -> None:
    gain = np.array([0.7, 0.9, 1.0])
    half = picture.copy()
    half[:, picture.shape[1] // 2 :] = 0
    balance = Balance(half, camera)
    balance.look(lit(picture, gain), camera)
    other = lit(picture, gain**2)
    other[:, : picture.shape[1] // 2] = 0
    balance.look(other, camera)
    like = image_of(balance.evened(other)).astype(float)
    shown = np.s_[:, picture.shape[1] // 2 :]
    assert np.abs((like - picture)[shown].mean((0, 1))).max() < 3.0


def test_where_no_ice_is_seen_the_light_stays_as_it_was(picture: Image, camera: Camera) -> None:
    gain = np.array([0.7, 0.9, 1.0])
    balance = Balance(picture, camera)
    balance.look(lit(picture, gain), camera)
    before = image_of(balance.evened(picture))
    balance.look(np.zeros_like(picture), camera)
    away = Camera(1, 0.04, np.array([[1.0, 0, 1e5], [0, 1.0, 0], [0, 0, 1]]), camera.size)
    balance.look(picture, away)
    np.testing.assert_array_equal(image_of(balance.evened(picture)), before)


@pytest.mark.parametrize("share", [0.6, 0.25])
def test_a_dim_picture_is_brightened_until_its_ice_is_white(
    picture: Image, camera: Camera, share: float
) -> None:
    white = np.percentile(picture.max(2), 90)
    gain = brightening(lit(picture, np.full(3, share)), camera)
    assert share * white < DIM
    assert gain == pytest.approx(BRIGHT / (share * white), rel=0.03)


def test_a_bright_picture_is_left_and_a_black_one_hardly_brightened(
    picture: Image, camera: Camera
) -> None:
    assert brightening(picture, camera) == 1.0
    assert brightening(np.zeros_like(picture), camera) == MOST_BRIGHTENED


def granite_of(code: int) -> Colour:
    lab = lab_of(np.full((1, 1, 3), code, np.uint8))[0, 0].astype(float)
    return Colour(lab, np.eye(3))


def test_dark_tones_are_lifted_to_where_they_were(picture: Image, camera: Camera) -> None:
    """As of a recording whose tones are linear: granite stands for all of them."""
    white = float(np.percentile(picture, 95))
    was = round(GRANITE * white)
    dark = np.round(255 * (np.arange(256) / 255) ** 2.2).astype(np.uint8)
    darkened = toned(picture, dark)
    table = tones(darkened, camera, granite_of(int(dark[was])))
    assert table is not None
    # All but how light the picture is as a whole, which stays.
    share = image_of(toned(darkened, table)) / float(dark[round(white)])
    assert np.abs(share - picture / white)[picture > 60].max() < 0.08


def test_usual_tones_stay_as_they_are(picture: Image, camera: Camera) -> None:
    white = float(np.percentile(picture, 95))
    assert tones(picture, camera, granite_of(round(0.3 * white))) is None
    assert tones(picture, camera, None) is None
    assert toned(picture, None) is picture
