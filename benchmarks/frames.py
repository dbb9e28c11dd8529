"""Houses and stones in all of the boxed real frames, each looked at by itself.

    python -m benchmarks.frames [--shared ../shared] [--sheet errors.png]

A stone counts where its middle is in view and its box lies on the sheet; boxes of stones that
hang over the picture's edge or stand beside the sheet neither count nor make a find false. Some
stones have no box, so the precision is a lower bound: the sheet shows all that was missed (M)
and all that is not boxed (F).
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.config import Config
from curlshot.data.errors import CurlshotError
from curlshot.data.sheet import STONE
from curlshot.vision.detection.glance import glance
from curlshot.vision.detection.stones import SEARCH
from curlshot.vision.measure import track_camera
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.picture import Image
from curlshot.vision.video.reader import open_video

Array = NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[1]
NEAR = 0.15
"""Boxes are a few pixels wide of the mark: so far a stone may be from its own, m."""
CROP_PX, CROP_PER_METRE = 200, 200


@dataclass
class Tally:
    """Boxes that count, those whose stone was found, and crops of what went wrong."""

    marked: int = 0
    found: int = 0
    unboxed: int = 0
    crops: list[Image] = field(default_factory=list)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shared", type=Path, default=ROOT.parent / "shared")
    parser.add_argument("--sheet", type=Path, help="write crops of all errors here")
    arguments = parser.parse_args()
    frames = arguments.shared / "frames"
    files = sorted((frames / "images").glob("*.jpg"))
    if not files:
        parser.error(f"no boxed frames in {frames}: say where they are with --shared")
    houses, tally = 0, Tally()
    for file in files:
        try:
            camera = track_camera(open_video([file]), Config()).cameras[0]
        except CurlshotError:
            continue
        houses += 1
        _look(file, camera, stone_boxes(frames, file.stem), tally)
    print(f"house found in {houses} of {len(files)} frames")
    print(
        f"stones: recall {tally.found / tally.marked:.3f} of {tally.marked}, precision at least"
        f" {tally.found / (tally.found + tally.unboxed):.3f} ({tally.unboxed} not boxed)"
    )
    if arguments.sheet is not None and tally.crops:
        cv2.imwrite(str(arguments.sheet), _sheet(tally.crops, 8))


def stone_boxes(frames: Path, name: str) -> Array:
    """Boxes of the stones of a frame, (n, 4): middle, width and height as shares of the picture."""
    boxes = np.loadtxt(frames / "boxes" / f"{name}.txt", ndmin=2)
    return boxes[boxes[:, 0] == 0, 1:] if boxes.size else np.empty((0, 4))


def _look(file: Path, camera: Camera, boxes: Array, tally: Tally) -> None:
    image = cv2.imread(str(file))
    (findings,) = glance([(image, camera)])
    seen = np.array([(stone.x, stone.y) for stone in findings.stones]).reshape(-1, 2)
    size = np.array(camera.size)
    places = camera.ice(boxes[:, :2] * size - 0.5, STONE.cap_height)
    in_view = np.all(np.abs(boxes[:, :2] - 0.5) < 0.5 - 0.25 * boxes[:, 2:], axis=1)
    on_sheet = np.abs(places[:, 0]) < SEARCH.half_width - 0.1
    on_sheet &= np.abs(places[:, 1]) < SEARCH.half_length
    apart = np.hypot(*(seen[:, None] - places).transpose(2, 0, 1))
    counts = in_view & on_sheet
    missed = counts & ~(apart < NEAR).any(0)
    unboxed = ~(apart < NEAR).any(1)
    tally.marked += int(counts.sum())
    tally.found += int((counts & ~missed).sum())
    tally.unboxed += int(unboxed.sum())
    for what, where in (("M", places[missed]), ("F", seen[unboxed])):
        tally.crops += [_crop(image, camera, place, f"{what} {file.stem}") for place in where]


def _crop(image: Image, camera: Camera, place: Array, text: str) -> Image:
    (u, v), (scale,) = (
        camera.project(place[None], STONE.cap_height)[0],
        camera.scale_at(place[None]),
    )
    zoom, half = CROP_PER_METRE / scale, CROP_PX / 2
    matrix = np.array([[zoom, 0, half - zoom * u], [0, zoom, half - zoom * v]])
    crop = cv2.warpAffine(image, matrix, (CROP_PX, CROP_PX))
    cv2.putText(crop, text, (4, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (255, 0, 255), 1)
    return np.asarray(crop, np.uint8)


def _sheet(crops: Sequence[Image], columns: int) -> Image:
    blank = [np.zeros_like(crops[0])] * (-len(crops) % columns)
    rows = np.array([*crops, *blank]).reshape(-1, columns, CROP_PX, CROP_PX, 3)
    return np.asarray(np.vstack([np.hstack(list(row)) for row in rows]), np.uint8)


if __name__ == "__main__":
    main()
