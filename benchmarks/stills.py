"""How well the house is found on real stills, and followed on real ice set in motion.

    python -m benchmarks.stills [SHARED] [--sheet PICTURE]

Houses found, frames refused, precision against cameras measured by hand, and precision and time
on clips whose camera is known. A figure with a ! misses its bar.
"""

from __future__ import annotations

import argparse
import csv
import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE
from curlshot.vision.camera_path.follow_house import follow_house
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.projection import apply_homography
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit
from curlshot.vision.video.reader import open_video

ROOT = Path(__file__).resolve().parents[1]

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

IOU = 0.8
HOUSE_CLASS = 3
FOUND, REFUSED, MEDIAN, LARGEST, FINDING = 0.95, 0.98, 8.0, 20.0, 150.0
"""Bars: shares of stills, errors in mm, CPU time in ms."""


@dataclass(frozen=True)
class Still:
    """A real frame with its labels and what was found in it."""

    name: str
    image: Image
    overhead: bool
    boxes: Array
    whole: bool
    fit: HouseFit | None
    seconds: float

    @property
    def found(self) -> bool:
        """Whether the 12-ft circle fills the box of a labelled house."""
        return self.fit is not None and any(iou(self.fit.camera, b) > IOU for b in self.boxes)


def circle(radius: float, count: int = 240) -> Array:
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def iou(camera: Camera, box: Array) -> float:
    """Overlap of the 12-ft circle's bounding box, cut to the picture, with a labelled box."""
    place = np.clip(camera.project(circle(HOUSE.twelve_foot)), 0, np.array(camera.size) - 1)
    mine = np.concatenate([place.min(0), place.max(0)])
    low, high = np.maximum(mine[:2], box[:2]), np.minimum(mine[2:], box[2:])
    shared = float(np.prod(np.clip(high - low, 0, None)))
    areas = [float(np.prod(b[2:] - b[:2])) for b in (mine, box)]
    return shared / (sum(areas) - shared)


def stills(shared: Path) -> Iterator[Still]:
    with (shared / "frames/index.csv").open() as table:
        rows = list(csv.DictReader(table))
    for row in rows:
        picture = cv2.imread(str(shared / "frames/images" / f"{row['image']}.jpg"))
        image = np.asarray(picture, np.uint8)
        h, w = image.shape[:2]
        labels = (shared / "frames/boxes" / f"{row['image']}.txt").read_text().split("\n")
        fields = np.array([line.split() for line in labels if line], float).reshape(-1, 5)
        fields = fields[fields[:, 0] == HOUSE_CLASS, 1:]
        middle, half = fields[:, :2] * [w, h], fields[:, 2:] * [w, h] / 2
        boxes = np.concatenate([middle - half, middle + half], axis=1)
        whole = bool(((boxes[:, :2] > 3) & (boxes[:, 2:] < [w - 4, h - 4])).all(1).any())
        start = time.process_time()
        fit = find_house(image)
        seconds = time.process_time() - start
        overhead = row["overhead"] == "1"
        yield Still(row["image"], image, overhead, boxes, whole, fit, seconds)


def against_hand(camera: Camera, hand: dict[str, Any]) -> Array:
    """Errors, m, of what the picture shows of the rings, against the camera measured by hand."""
    truth = Camera(
        0, 0.0, np.array(hand["homography"]), tuple(hand["size"]), hand["k1"], hand["k2"]
    )
    radii = (HOUSE.twelve_foot, HOUSE.eight_foot, HOUSE.four_foot)
    places = np.concatenate([np.zeros((1, 2)), *(circle(r, 8) for r in radii)])
    pixels = truth.project(places)
    shown = ((pixels >= 0) & (pixels <= np.array(truth.size) - 1)).all(1)
    return np.asarray(np.linalg.norm(camera.ice(pixels) - places, axis=1)[shown])


def marked(image: Image, fit: HouseFit | None, text: str) -> Image:
    """Draw the fitted rings on the picture and shrink it."""
    shown = image.copy()
    if fit is not None:
        for radius in (HOUSE.twelve_foot, *fit.rig[6:8]):
            place = np.round(fit.camera.project(circle(radius)) * 8).astype(np.int32)
            cv2.polylines(shown, [place], True, (255, 0, 255), 3, cv2.LINE_AA, 3)
        for ends in ([[-2.2, 0], [2.2, 0]], [[0, -2.2], [0, 4]]):
            place = np.round(fit.camera.project(np.array(ends)) * 8).astype(np.int32)
            cv2.polylines(shown, [place], False, (255, 0, 255), 2, cv2.LINE_AA, 3)
    small = cv2.resize(shown, (480, 270), interpolation=cv2.INTER_AREA)
    cv2.putText(small, text, (4, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (0, 0, 255), 1)
    return np.asarray(small, np.uint8)


def write_sheet(tiles: list[Image], path: Path, across: int = 4) -> None:
    while len(tiles) % across:
        tiles.append(np.zeros((270, 480, 3), np.uint8))
    rows = [np.hstack(tiles[i : i + across]) for i in range(0, len(tiles), across)]
    cv2.imwrite(str(path), np.vstack(rows))


def row(what: str, value: str, met: bool = True) -> None:
    """Print one figure, with a ! where it misses its bar."""
    print(f"{what:<74} {value}{'' if met else ' !'}", flush=True)


def score_stills(shared: Path, sheet: Path | None) -> None:
    known = json.loads((shared / "frames/stills.json").read_text())
    hand = {f["file"].removesuffix(".jpg"): f for f in known["frames"]}
    refuse = {f["file"].removesuffix(".jpg") for f in known["negatives"]}
    labelled, whole, unlabelled, oblique = [], [], [], []
    errors: dict[str, Array] = {}
    elsewhere = 0
    refused, tiles, seconds = 0, [], []
    for still in stills(shared):
        seconds.append(still.seconds)
        group = "labelled" if still.overhead and len(still.boxes) else "other"
        if group == "labelled":
            labelled.append(still.found)
            elsewhere += still.fit is not None and not still.found
            if still.shot_fit:
                whole.append(still.found)
        elif not len(still.boxes):
            unlabelled.append(still.fit is not None)
        else:
            oblique.append(still.fit is not None)
        refused += still.name in refuse and still.fit is None
        if still.name in hand and still.fit is not None:
            errors[still.name] = against_hand(still.fit.camera, hand[still.name])
        if (group == "labelled" and not still.found) or (group == "other" and still.fit):
            kind = "missed" if group == "labelled" else "found, no label from overhead"
            tiles.append(marked(still.image, still.fit, f"{still.name} {kind}"))
    row("stills: whole house from overhead, box IoU > 0.8", f"{sum(whole)} of {len(whole)}")
    row("stills: any labelled house from overhead", f"{sum(labelled)} of {len(labelled)}")
    row("stills: house found in frames without a label", f"{sum(unlabelled)} of {len(unlabelled)}")
    row("stills: house found in frames not from overhead", f"{sum(oblique)} of {len(oblique)}")
    row("stills: another house or place taken for the labelled one", str(elsewhere), not elsewhere)
    row("stills: frames to refuse that are refused", f"{refused} of {len(refuse)}",
        refused >= REFUSED * len(refuse))  # fmt: skip
    row("stills.json: found", f"{len(errors)} of {len(hand)}", len(errors) >= FOUND * len(hand))
    pooled = 1e3 * np.concatenate(list(errors.values()))
    middle, most, largest = np.percentile(pooled, [50, 95, 100])
    worst = max(errors, key=lambda name: float(errors[name].max()))
    row("stills.json: ring points against the hand-measured camera, median",
        f"{middle:.1f} mm", middle <= MEDIAN)  # fmt: skip
    row("stills.json: the same, 95 %", f"{most:.1f} mm")
    row(f"stills.json: the same, largest ({worst})", f"{largest:.1f} mm", largest <= LARGEST)
    spent = 1e3 * float(np.mean(seconds))
    row("finding: CPU time a frame at 1080p, mean", f"{spent:.0f} ms", spent <= FINDING)
    if sheet is not None and tiles:
        write_sheet(tiles, sheet)


def score(shared: Path, sheet: Path | None = None) -> None:
    """Print the table for real stills and for real ice set in motion."""
    score_stills(shared, sheet)
    score_clips(shared)


def score_clips(shared: Path) -> None:
    radii = (HOUSE.twelve_foot, HOUSE.eight_foot, HOUSE.four_foot)
    rings = np.concatenate([np.zeros((1, 2)), *(circle(r, 16) for r in radii)])
    guards = np.array([[x, y] for x in (-1.0, 0.0, 1.0) for y in (3.0, 4.0, 5.0)])
    for truth_path in sorted((shared / "clips").glob("semireal_*.truth.json")):
        truth = json.loads(truth_path.read_text())
        film = truth_path.with_name(truth_path.name.replace(".truth.json", ".mp4"))
        start = time.process_time()
        frames = sum(1 for _ in open_video([film]))
        decoding = time.process_time() - start
        track = follow_house(open_video([film]))
        spent = (time.process_time() - start - 2 * decoding) / frames
        house: list[float] = []
        guard: list[float] = []
        for camera in track.cameras:
            matrix = np.array(truth["frames"][camera.frame]["homography"])
            for places, into in ((rings, house), (guards, guard)):
                pixels = apply_homography(matrix, places)
                seen = ((pixels > 0) & (pixels < np.array(camera.size) - 1)).all(1)
                error = camera.ice(pixels[seen]) - places[seen]
                if seen.any():
                    into.append(1e3 * float(np.sqrt((error**2).sum(1).mean())))
        first = truth["frames"][0]
        place = -np.array(first["R"]).T @ np.array(first["T"])
        name = truth["name"]
        position = track.cameras[0].position
        assert position is not None
        row(f"{name}: frames with a camera", f"{len(track.cameras)} of {frames}")
        row(f"{name}: seen ring points, RMS of a frame, median and worst",
            f"{np.median(house):.1f} and {max(house):.1f} mm")  # fmt: skip
        row(f"{name}: guards' places, RMS of a frame, median and worst",
            f"{np.median(guard):.1f} and {max(guard):.1f} mm")  # fmt: skip
        row(f"{name}: height of the camera, true and found",
            f"{place[2]:.2f}, {position[2]:.2f} ± {track.position_sd[2]:.2f} m")  # fmt: skip
        row(f"{name}: CPU time a frame, the find included, beyond decoding of"
            f" {1e3 * decoding / frames:.1f} ms", f"{1e3 * spent:.1f} ms")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("shared", type=Path, nargs="?", default=ROOT.parent / "shared")
    parser.add_argument("--sheet", type=Path, help="write doubtful stills to this picture")
    options = parser.parse_args()
    frames = options.shared / "frames"
    if not (frames / "stills.json").exists():
        parser.error(f"no labelled stills in {frames}: say where they are")
    cv2.setNumThreads(1)
    score(options.shared, options.sheet)


if __name__ == "__main__":
    main()
