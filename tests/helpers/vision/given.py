"""What tests of given share."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from curlshot.config import VideoConfig
from curlshot.vision.video.reader import Video, open_video

SMALL = (640, 360)


def textured(folder: Path, shifts: tuple[float, ...]) -> Video:
    """Pictures of the same blots, each moved to the right, without any ring."""
    rng = np.random.default_rng(3)
    wide = rng.integers(0, 256, (SMALL[1] // 8, SMALL[0] // 8 + 10), np.uint8)
    grey = cv2.resize(wide, None, fx=8, fy=8, interpolation=cv2.INTER_CUBIC)
    for k, shift in enumerate(shifts):
        moved = cv2.warpAffine(grey, np.array([[1.0, 0.0, shift], [0.0, 1.0, 0.0]]), SMALL)
        cv2.imwrite(str(folder / f"{k}.png"), cv2.merge([moved] * 3))
    return open_video([folder / f"{k}.png" for k in range(len(shifts))], VideoConfig(fps=25.0))
