"""Drawing on pictures of the ice: lines in metres through the camera, and words in boxes."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import SHEET
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.projection import apply_homography
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]
Colour = tuple[int, int, int]
"""Blue, green, red."""
Box = tuple[float, float, float, float]
"""Left, top, right and bottom, px."""

WHITE, BLACK = (255, 255, 255), (0, 0, 0)

_SHIFT = 4  # bits of a pixel's fraction in cv2's drawing
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_LETTERS = 0.5  # size of the letters in a picture 720 px high
_CORNERS = 121


def circle(corners: int = _CORNERS) -> Array:
    """Points around the unit circle, the first once more at the end, shape (corners, 2)."""
    angle = np.linspace(0, 2 * np.pi, corners)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def ice_lines(rings: Sequence[float], play: int = -1) -> list[Array]:
    """Give the rings and the lines near the house as they should be painted, m.

    Parameters
    ----------
    rings : sequence of float
        Painted radii, m; without any there are no lines either.
    play : int
        -1 where stones come down y, 1 where up: the back line is behind the tee.

    Returns
    -------
    list of ndarray, shape (n, 2)
        Each ring, then tee line, back line, hog line and centre line.
    """
    if not len(rings):
        return []
    lines = [ring * circle() for ring in rings]
    across = np.linspace(-1, 1, 41)[:, None] * [SHEET.half_width_min, 0]
    lines += [np.add(across, [0, y]) for y in (0.0, play * SHEET.back_line, -play * SHEET.hog_line)]
    along = -play * np.linspace(-SHEET.back_line, SHEET.hog_line, 81)[:, None]
    return [*lines, along * [0, 1]]


def draw_lines(
    image: Image,
    camera: Camera,
    lines: Sequence[Array],
    colour: Colour,
    thickness: int,
    height: float = 0.0,
    edge: bool = True,
) -> None:
    """Draw lines on the ice, in the pieces that the camera can see.

    Parameters
    ----------
    image : ndarray
        Drawn on.
    camera : Camera
        Of this picture.
    lines : sequence of ndarray, shape (n, 2)
        Places along each line, m.
    colour : Colour
        Of all of them.
    thickness : int
        In px.
    height : float
        Of the lines above the ice, m.
    edge : bool
        Whether they have a dark rim.
    """
    if not lines:
        return
    h, w = image.shape[:2]
    ice = np.concatenate(lines)
    line = np.repeat(np.arange(len(lines)), [len(places) for places in lines])
    ahead = ice @ camera.homography[2, :2] + camera.homography[2, 2] > 1e-6
    flat = apply_homography(camera.homography, np.where(ahead[:, None], ice, 0.0))
    # Far outside, the distortion's polynomial folds back into the picture.
    near = (np.abs(flat - [w / 2, h / 2]) < 0.7 * max(w, h)).all(axis=1)
    seen = np.flatnonzero(ahead & near)
    pixels = np.round(camera.project(ice[seen], height) * 2**_SHIFT).astype(np.int32)
    breaks = np.flatnonzero((np.diff(seen) > 1) | (np.diff(line[seen]) > 0)) + 1
    pieces = [piece for piece in np.split(pixels, breaks) if len(piece) > 1]
    if edge:
        cv2.polylines(image, pieces, False, BLACK, thickness + 2, cv2.LINE_AA, _SHIFT)
    cv2.polylines(image, pieces, False, colour, thickness, cv2.LINE_AA, _SHIFT)


def text_box(text: str, unit: float) -> tuple[float, float]:
    """Return width and height of a label with its margin, px; `unit` is the size of its letters."""
    width, height, _ = _measured(text, unit)
    return width, height


def write(
    image: Image,
    text: str,
    corner: tuple[float, float],
    unit: float,
    stripe: Colour | None = None,
) -> None:
    """Write white on a darkened box, whose upper left corner is at `corner`."""
    width, height, base = _measured(text, unit)
    left, top = (max(round(v), 0) for v in corner)
    box = image[top : top + round(height), left : left + round(width)]
    box[:] = box // 3
    if stripe is not None:
        box[:, : round(3 * unit)] = stripe
    at = (left + round(3 * unit), top + base)
    thickness = max(round(unit), 1)
    cv2.putText(image, text, at, _FONT, _LETTERS * unit, WHITE, thickness, cv2.LINE_AA)


def _measured(text: str, unit: float) -> tuple[float, float, int]:
    """Width and height of a label, and how far below its top the letters stand, px."""
    (w, h), below = cv2.getTextSize(text, _FONT, _LETTERS * unit, 1)
    margin = round(3 * unit)
    return float(w + 2 * margin), float(h + below + 2 * margin), margin + h


def overlap(one: Box, other: Box) -> float:
    """Area that two boxes share, px²."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return width * height if width > 0 and height > 0 else 0.0


def inside(image: Image, box: Box) -> bool:
    """Whether a box lies within the picture."""
    h, w = image.shape[:2]
    return bool(min(box[:2]) >= 0 and box[2] < w and box[3] < h)
