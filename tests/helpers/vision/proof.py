"""What tests of proof share."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from curlshot.synthetic import PAINTS, sample_scene
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.rig import OVERHEAD, start_rig
from curlshot.vision.sheet.marks import Evidence, measure_marks
from curlshot.vision.sheet.proof import is_house
from curlshot.vision.video.picture import Image

SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])
SIZE = (960, 540)
SCALE, FINE = 90.0, 4
ICE, BLUE, RED = (232, 230, 228), (170, 80, 30), (50, 40, 200)
HOUSE = ((1.829, BLUE), (1.2135, ICE), (0.619, RED))


def level() -> tuple[View, np.ndarray]:
    rig = start_rig(OVERHEAD, (0.0, 0.0, 9.0))
    rig[3:6] = 0
    return View(np.array([0.0, 0.0, 0.0, np.log(SCALE * 9)])), rig


def drawn(
    circles: tuple[tuple[float, tuple[int, int, int]], ...],
    ground: tuple[int, int, int] = ICE,
    cross: bool = True,
) -> Image:
    """Discs about the middle of a picture, the largest first, and lines through it."""
    image = np.full((FINE * SIZE[1], FINE * SIZE[0], 3), ground, np.uint8)
    middle = (FINE * SIZE[0] // 2, FINE * SIZE[1] // 2)
    for radius, colour in circles:
        cv2.circle(image, middle, round(FINE * SCALE * radius), colour, -1)
    if cross:
        cv2.line(image, (0, middle[1]), (FINE * SIZE[0], middle[1]), (60, 60, 60), FINE)
        cv2.line(image, (middle[0], 0), (middle[0], FINE * SIZE[1]), (60, 60, 60), FINE)
    return np.asarray(cv2.resize(image, SIZE, interpolation=cv2.INTER_AREA), np.uint8)


def seen(image: Image) -> Evidence:
    view, rig = level()
    return measure_marks(image, view.vector, rig, reach=6.0)


def proved(image: Image) -> bool:
    return is_house(image, seen(image), *level())
