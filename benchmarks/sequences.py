"""How exactly discs are followed in seven plain sequences: ``python -m benchmarks.sequences``.

Sequences as autotrackers are tried on: 200 pictures of 1280 × 720 px, discs of radius 20 px, the
scale from a calibration stick. RMS of the distance to the true centre, px, of the detections
themselves and of the tracks, beside the figures of Tracker 6.2's autotracker on sequences of the
same kinds (its defaults; one disc at a time, marked by hand at first). A star marks what misses
its bar: 0.05 px, 0.3 px where something covers the disc, and nothing lost.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.config import VideoConfig
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.vision.detection.stones import plain_disc
from curlshot.vision.optics.stick import stick_cameras
from curlshot.vision.track import track_stones
from curlshot.vision.video.reader import open_video

Floats = NDArray[np.float64]
Picture = NDArray[np.float64]
Colour = tuple[float, float, float]

SIZE = (1280, 720)
FRAMES, FPS = 200, 25.0
RADIUS, SCALE = 20.0, 20.0 / 0.1455
"""px, and px per metre."""

ICE: Colour = (226, 224, 220)
GREY, RED, YELLOW = (118, 122, 120), (40, 30, 190), (40, 205, 225)
STICK = (40.0, 680.0, 40.0 + 5 * SCALE, 680.0, 5.0)


@dataclass(frozen=True)
class Sequence:
    """A kind of pictures.

    ``paths`` holds the centres of the discs, px, shape (discs, frames, 2); ``bar`` is in px;
    ``peer`` what Tracker's autotracker reached.
    """

    name: str
    paths: Floats
    peer: str
    colours: tuple[Colour, ...] = (RED,)
    blur: float = 0.0
    noise: float = 0.0
    texture: float = 0.0
    flicker: float = 0.0
    turn: float = 0.0
    rings: bool = False
    brush: bool = False
    bar: float = 0.05


def glide(start: tuple[float, float], heading: float, fast: float, slow: float) -> Floats:
    """Path of a disc that slows down evenly, px per frame."""
    way = np.concatenate([[0.0], np.cumsum(np.linspace(fast, slow, FRAMES - 1))])
    path = np.array(start) + way[:, None] * np.array([np.cos(heading), np.sin(heading)])
    return np.asarray(path, float)


def collision(restitution: float = 0.85, weight: float = 1.0) -> Floats:
    """Paths of a disc that hits one at rest, off its middle; `weight` is the second's."""
    rest = np.array([700.3, 371.7])
    speed, at = 6.0, 82.4
    normal = np.array([np.cos(0.35), np.sin(0.35)])
    impact = rest - 2 * RADIUS * normal
    velocity = np.array([speed, 0.0])
    push = (1 + restitution) * (velocity @ normal) / (1 + 1 / weight) * normal
    after, other = velocity - push, push / weight
    late = np.arange(FRAMES)[:, None] - at
    first = impact + np.where(late < 0, velocity, after) * late
    second = rest + np.where(late < 0, 0.0, other) * late
    return np.stack([first, second])


ALONG = glide((150.4, 200.7), 0.32, 6.0, 2.0)
SEQUENCES = (
    Sequence("plain disc", ALONG[None], "0.27"),
    Sequence("texture and noise", ALONG[None], "0.30", blur=0.8, noise=3.0, texture=6.0),
    Sequence("rotating handle", ALONG[None], "0.25", (GREY,), 0.8, 3.0, 6.0, turn=0.02),
    Sequence(
        "rings and flicker", ALONG[None], "lost", (GREY,), 0.8, 4.0, 6.0, 0.1, turn=0.02, rings=True
    ),
    Sequence("hit, equal", collision(), "0.68", (GREY, GREY), 0.8, 3.0, 6.0),
    Sequence("hit, unequal", collision(weight=1.4), "0.66", (RED, YELLOW), 0.8, 3.0, 6.0),
    Sequence(
        "brush touching", ALONG[None], "lost", (GREY,), 0.8, 3.0, 6.0, turn=0.02, brush=True,
        bar=0.3,
    ),
)  # fmt: skip


def pictures(sequence: Sequence) -> Iterator[NDArray[np.uint8]]:
    """Draw a sequence; every disc's edge falls within a pixel, then the blur and the noise."""
    rng = np.random.default_rng(11)
    x, y = np.meshgrid(np.arange(SIZE[0], dtype=float), np.arange(SIZE[1], dtype=float))
    ground = np.broadcast_to(np.array(ICE, float), (*x.shape, 3)).copy()
    if sequence.rings:
        away = np.hypot(x - 660, y - 340)
        for radius, colour in ((300, (120, 126, 20)), (200, ICE), (100, RED), (30, ICE)):
            cover(ground, away - radius, colour)
    if sequence.texture:
        grain = cv2.GaussianBlur(rng.normal(size=x.shape), (0, 0), 3.0)
        ground += sequence.texture * (grain / grain.std())[..., None]
    for frame in range(FRAMES):
        picture = ground.copy()
        for path, colour in zip(sequence.paths, sequence.colours, strict=True):
            draw_disc(picture, path[frame], colour, sequence.turn * frame, bool(sequence.turn))
        if sequence.brush:
            draw_brush(picture, sequence.paths[0], frame)
        if sequence.blur:
            picture = cv2.GaussianBlur(picture, (0, 0), sequence.blur)
        picture *= 1 + sequence.flicker * np.sin(2 * np.pi * frame * 0.23)
        picture += rng.normal(0, sequence.noise, picture.shape) if sequence.noise else 0
        yield np.clip(picture + 0.5, 0, 255).astype(np.uint8)


def cover(picture: Picture, distance: Floats, colour: Colour) -> None:
    """Paint where the distance to an outline is below 0, half where it is 0."""
    share = np.clip(0.5 - distance, 0, 1)[..., None]
    picture += share * (np.array(colour) - picture)


def window(centre: Floats, reach: float) -> tuple[tuple[slice, slice], Floats, Floats]:
    """Part of the picture about a place, and the pixels' places from it."""
    low = np.maximum(np.floor(centre - reach).astype(int), 0)
    high = np.minimum(np.ceil(centre + reach).astype(int) + 1, SIZE)
    x, y = np.meshgrid(
        np.arange(low[0], high[0], dtype=float), np.arange(low[1], high[1], dtype=float)
    )
    return (slice(low[1], high[1]), slice(low[0], high[0])), x - centre[0], y - centre[1]


def draw_disc(picture: Picture, centre: Floats, colour: Colour, angle: float, handle: bool) -> None:
    """Draw a disc, if need be with a cap and a handle."""
    part, x, y = window(centre, RADIUS + 3)
    away = np.hypot(x, y)
    cover(picture[part], away - RADIUS, colour)
    if handle:
        cover(picture[part], away - 0.7 * RADIUS, RED)
        along = x * np.cos(angle) + y * np.sin(angle)
        aside = y * np.cos(angle) - x * np.sin(angle)
        inside = np.clip(along, -0.35 * RADIUS, 0.5 * RADIUS)
        cover(picture[part], np.hypot(along - inside, aside) - 0.1 * RADIUS, (200, 190, 230))


def draw_brush(picture: Picture, path: Floats, frame: int) -> None:
    """Draw a brush's head that goes to and fro before the disc and over its edge."""
    ahead = path[-1] - path[0]
    ahead /= np.hypot(*ahead)
    side = np.array([-ahead[1], ahead[0]])
    stroke = 14 * np.sin(2 * np.pi * frame * 3.5 / FPS)
    centre = path[frame] + (RADIUS + 4) * ahead + stroke * side
    part, x, y = window(centre, 40)
    along, aside = x * ahead[0] + y * ahead[1], x * side[0] + y * side[1]
    cover(picture[part], np.maximum(np.abs(along) - 7, np.abs(aside) - 18), (30, 160, 235))


def followed(sequence: Sequence, folder: Path) -> tuple[pd.DataFrame, pd.DataFrame, float]:
    """Return detections, tracks, and the CPU time of following per frame, s."""
    files = []
    for index, picture in enumerate(pictures(sequence)):
        files.append(folder / f"{index:03d}.png")
        cv2.imwrite(str(files[-1]), picture, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    clip = open_video(files, VideoConfig(fps=FPS))
    disc = plain_disc(RADIUS / SCALE)
    start = time.process_time()
    detections = track_stones(clip, stick_cameras(clip, STICK), disc=disc).detections
    spent = (time.process_time() - start) / FRAMES
    hits = detect_hits(detections, disc.radius)
    return detections, smooth(detections, hits, radius=disc.radius), spent


def misses(table: pd.DataFrame, sequence: Sequence) -> tuple[Floats, int]:
    """Distances to the true centres, px, and how many disc-frames are lost or another's."""
    x = STICK[0] + table["x"].to_numpy() * SCALE
    y = STICK[1] - table["y"].to_numpy() * SCALE
    errors: list[Floats] = []
    lost = 0
    for path in sequence.paths:
        off = np.hypot(*(np.stack([x, y]) - path[table["frame"]].T))
        name = table["stone"].iloc[int(np.argmin(off))]
        own = off[(table["stone"] == name).to_numpy() & (off < RADIUS / 2)]
        errors.append(own)
        lost += FRAMES - len(own)
    return np.concatenate(errors), lost


def rms(errors: Floats) -> float:
    return float(np.sqrt(np.mean(errors**2)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", nargs="+", default=[""], help="only those whose names begin so")
    kinds = tuple(parser.parse_args().kinds)
    print(f"{'px RMS':20} {'stones':>10} {'tracks':>8} {'worst':>8} {'lost':>6} {'ms':>6}  Tracker")
    for sequence in (item for item in SEQUENCES if item.name.startswith(kinds)):
        with tempfile.TemporaryDirectory() as folder:
            detections, tracks, spent = followed(sequence, Path(folder))
        seen, lost = misses(detections, sequence)
        errors, _ = misses(tracks, sequence)
        star = "*" if rms(errors) > sequence.bar or lost else " "
        print(
            f"{sequence.name:20} {rms(seen):10.3f} {rms(errors):7.3f}{star} {errors.max():8.3f}"
            f" {lost:6d} {1e3 * spent:6.1f}  {sequence.peer}",
            flush=True,
        )


if __name__ == "__main__":
    main()
