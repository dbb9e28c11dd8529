"""What tests of house fit share."""

from __future__ import annotations

import numpy as np

from curlshot.synthetic import PAINTS, Scene, still_camera, tilted_camera
from curlshot.synthetic.camera import CameraPath
from curlshot.vision.sheet.house_fit import RoughFit, fit_roughly, start
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
