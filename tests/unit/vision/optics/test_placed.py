from __future__ import annotations

import numpy as np

from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.placed import Placed, nobody
from curlshot.vision.video.frame import Frame


def test_whom_nobody_tells_anything_changes_nothing() -> None:
    placed: Placed = nobody
    picture = np.full((4, 6, 3), 7, np.uint8)
    matrix = np.eye(3)
    placed(Frame(0, 0.0, picture), Camera(0, 0.0, matrix, (6, 4)))
    assert (picture == 7).all() and (matrix == np.eye(3)).all()
