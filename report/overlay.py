"""The clip with what was found drawn on it: rings, stones, names, trails, speeds and hits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, Self

import av
import cv2
import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from data.files import whole_file
from data.progress import Progress, no_progress
from data.results import Collision
from data.sheet import HOUSE, SHEET, STONE
from report.style import stone_colours, team_colour
from vision.camera import Camera, apply_homography
from vision.clip import DEFAULT_IMAGE_FPS, Clip, Frame, Image

Array = NDArray[np.float64]

RINGS = (HOUSE.twelve_foot, HOUSE.eight_foot, HOUSE.four_foot)

_TIME_BASE = Fraction(1, 90_000)  # fine enough for any rate, exact for 24, 25, 30, 50 and 60
_CIRCLE = np.stack([np.cos(a := np.linspace(0, 2 * np.pi, 121)), np.sin(a)], axis=1)
_SHIFT = 4  # bits of a pixel's fraction in cv2's drawing
_APART = 0.1  # radii between the points of a trail
_RESTS = 0.05  # m/s below which a stone's speed is not worth a label
_TURNS = 0.1  # rad/s, the same for its spin
_FLASH = 0.4  # s
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_LETTERS = 0.5  # size of the letters in a picture 720 px high
_LEAST_UNIT = 0.75  # of that size, below which letters cannot be read
_WHITE, _BLACK = (255, 255, 255), (0, 0, 0)
_LINE_COLOUR = (255, 255, 120)

Colour = tuple[int, int, int]
Box = tuple[Array, Array]
"""Upper left and lower right corner, px."""


@dataclass(frozen=True)
class State:
    """One stone in one frame: place (m), angle (rad), speed (m/s), spin (rad/s); NaN: unknown."""

    stone: str
    place: Array
    theta: float
    speed: float
    omega: float
    seen: bool
    team: Colour | None = None


@dataclass(frozen=True)
class Scene:
    """All that is drawn, looked up by frame.

    Attributes
    ----------
    lines : tuple of ndarray, shape (n, 2)
        Lines painted on the ice, m.
    states : mapping of int to list
        The stones of each frame.
    paths : mapping of str to (frames, places)
        Where each stone was, shape (n,) and (n, 2), without places close to the one before.
    hits : sequence of (t, place, text)
        When and where two stones touched.
    colours : mapping of str to BGR
        A colour per stone, that of the figures.
    radius : float
        Radius of the stones, m.
    height : float
        Height above the ice of their widest part, m.
    """

    lines: tuple[Array, ...]
    states: Mapping[int, Sequence[State]]
    paths: Mapping[str, tuple[NDArray[np.int64], Array]]
    hits: Sequence[tuple[float, Array, str]]
    colours: Mapping[str, Colour]
    radius: float
    height: float


def write_overlay(
    clip: Clip,
    cameras: Iterable[Camera],
    tracks: pd.DataFrame,
    collisions: Sequence[Collision],
    path: Path,
    *,
    rings: Sequence[float] | None = RINGS,
    radius: float = STONE.radius,
    progress: Progress = no_progress,
) -> float:
    """Write the clip as an H.264 MP4 with the results drawn on it, whole or not at all.

    The frames keep their own distances in time; the first is at 0. Frames without a camera
    are shown plain. Odd sizes get one more row or column, which the coding needs.

    Parameters
    ----------
    clip : Clip
        Read once, from the start.
    cameras : iterable of Camera
        Found by their `frame`.
    tracks : DataFrame
        With `data.tracks.TRACK_COLUMNS`, `frame` counting as the clip does.
    collisions : sequence of Collision
        Flashed for a moment after each hit.
    path : Path
        Ends in .mp4.
    rings : sequence of float or None
        Painted radii of the house, m; None where there is no house: no lines either.
    radius : float
        Radius of the stones, m.
    progress : Progress
        Told after each frame.

    Returns
    -------
    float
        Time in the clip of the first picture, s, which is 0 in the MP4.
    """
    scene = _scene(tracks, collisions, rings, radius)
    by_frame = {camera.frame: camera for camera in cameras}
    total = clip.expected
    with whole_file(path) as part, _Encoder(part, clip.size, clip.fps) as encoder:
        for done, frame in enumerate(clip, 1):
            camera = by_frame.get(frame.index)
            image = frame.image if camera is None else draw(frame, camera, scene)
            encoder.add(image, frame.t)
            progress("overlay", done, total)
    return encoder.start or 0.0


def draw(frame: Frame, camera: Camera, scene: Scene) -> Image:
    """Return a copy of the frame's picture with the scene drawn on it."""
    image = frame.image.copy()
    scale = image.shape[0] / 720
    unit = max(scale, _LEAST_UNIT)
    thin, thick = max(round(scale), 1), max(round(2 * scale), 1)
    for line in scene.lines:
        draw_line(image, camera, line, _LINE_COLOUR, thin, edge=False)
    states = scene.states.get(frame.index, [])
    now = {state.stone: state.place for state in states}
    for name, (frames, places) in scene.paths.items():
        stop = int(np.searchsorted(frames, frame.index, side="right"))
        trail = places[:stop] if name not in now else np.vstack([places[:stop], now[name]])
        if len(trail) > 1:
            draw_line(image, camera, trail, scene.colours[name], thick)
    boxes = []
    for state in states:
        outline = state.place + scene.radius * _CIRCLE
        pixels = camera.project(outline, scene.height)
        boxes.append((pixels.min(axis=0), pixels.max(axis=0)))
        colour = scene.colours[state.stone]
        draw_line(image, camera, outline, colour, thick if state.seen else thin, scene.height)
        if np.isfinite(state.theta):
            tip = np.array([np.cos(state.theta), np.sin(state.theta)])
            spoke = state.place + scene.radius * np.array([[0.4], [1.0]]) * tip
            draw_line(image, camera, spoke, colour, thick, scene.height)
    _labels(image, states, unit, boxes)
    _flashes(image, camera, frame.t, scene, unit, thick)
    return image


# ---------------------------------------------------------------------------- the scene


def ice_lines(rings: Sequence[float]) -> list[Array]:
    """Give the rings and the lines near the house as they should be painted, m.

    Parameters
    ----------
    rings : sequence of float
        Painted radii, m; without any there are no lines either.

    Returns
    -------
    list of ndarray, shape (n, 2)
        Each ring, then tee line, back line, hog line and centre line.
    """
    if not len(rings):
        return []
    lines = [ring * _CIRCLE for ring in rings]
    across = np.linspace(-1, 1, 41)[:, None] * [SHEET.half_width_min, 0]
    lines += [np.add(across, [0, y]) for y in (0.0, -SHEET.back_line, SHEET.hog_line)]
    along = np.linspace(-SHEET.back_line, SHEET.hog_line, 81)[:, None]
    return [*lines, along * [0, 1]]


def _scene(
    tracks: pd.DataFrame,
    collisions: Sequence[Collision],
    rings: Sequence[float] | None,
    radius: float,
) -> Scene:
    lines = [] if rings is None else ice_lines(rings)
    states: dict[int, list[State]] = {}
    paths = {}
    for name, rows in tracks.sort_values("t").groupby("stone", sort=True):
        stone = str(name)
        frames = rows["frame"].to_numpy(np.int64)
        columns = ["x", "y", "theta", "vx", "vy", "omega", "seen"]
        x, y, theta, vx, vy, omega, seen = rows[columns].to_numpy(float).T
        team = team_colour(rows["team"].iloc[0])
        places = np.stack([x, y], axis=1)
        for k, index in enumerate(frames):
            speed = float(np.hypot(vx[k], vy[k]))
            states.setdefault(int(index), []).append(
                State(
                    stone,
                    places[k],
                    float(theta[k]),
                    speed,
                    float(omega[k]),
                    bool(seen[k]),
                    None if team is None else _bgr(team),
                )
            )
        if np.ptp(places, axis=0).max() > radius / 3:
            kept = _apart(places, _APART * radius)
            paths[stone] = (frames[kept], places[kept])
    hits = []
    for collision in collisions:
        first, second = collision.stones
        if first in collision.before:
            state = collision.before[first]
            place = np.array([state.x, state.y]) + radius * np.array(collision.normal)
            hits.append((collision.t, place, f"{first} hits {second}"))
    colours = {
        name: _bgr(colour) for name, colour in stone_colours(tracks["stone"].unique()).items()
    }
    height = STONE.cap_height / 2 * radius / STONE.radius
    return Scene(tuple(lines), states, paths, hits, colours, radius, height)


def _apart(places: Array, least: float) -> NDArray[np.intp]:
    """Ranks of places, each at least so far from the one before it, m."""
    kept = [0]
    for rank, (x, y) in enumerate(places.tolist()):
        x0, y0 = places[kept[-1]]
        if np.hypot(x - x0, y - y0) >= least:
            kept.append(rank)
    return np.array(kept)


def _bgr(colour: str) -> Colour:
    red, green, blue = (round(255 * part) for part in to_rgb(colour))
    return blue, green, red


# ---------------------------------------------------------------------------- drawing


def draw_line(
    image: Image,
    camera: Camera,
    ice: Array,
    colour: Colour,
    thickness: int,
    height: float = 0.0,
    edge: bool = True,
) -> None:
    """Draw a line on the ice, in the pieces that the camera can see, with a dark rim."""
    h, w = image.shape[:2]
    ahead = ice @ camera.homography[2, :2] + camera.homography[2, 2] > 1e-6
    flat = apply_homography(camera.homography, np.where(ahead[:, None], ice, 0.0))
    # Far outside, the distortion's polynomial folds back into the picture.
    near = (np.abs(flat - [w / 2, h / 2]) < 0.7 * max(w, h)).all(axis=1)
    usable = np.concatenate([[False], ahead & near, [False]]).astype(int)
    stops = np.flatnonzero(np.diff(usable))
    pieces = []
    for start, stop in zip(stops[::2], stops[1::2], strict=True):
        if stop - start > 1:
            pixels = camera.project(ice[start:stop], height)
            pieces.append(np.round(pixels * 2**_SHIFT).astype(np.int32))
    if edge:
        cv2.polylines(image, pieces, False, _BLACK, thickness + 2, cv2.LINE_AA, _SHIFT)
    cv2.polylines(image, pieces, False, colour, thickness, cv2.LINE_AA, _SHIFT)


def _labels(
    image: Image,
    states: Sequence[State],
    unit: float,
    boxes: list[Box],
) -> None:
    """Write each stone's name, and speed and spin while it has any, where nothing is in the way.

    The stripe before the name has the colour of its team.
    """
    taken = list(boxes)
    for state, box in zip(states, boxes, strict=True):
        if not _inside(image, (box[0] + box[1]) / 2):
            continue
        text = state.stone
        if state.speed > _RESTS:
            text += f" {state.speed:.2f} m/s"
        if abs(state.omega) > _TURNS:
            text += f" {state.omega:+.1f} rad/s"
        size, _ = _text_box(text, unit)
        places = [
            np.array([x, y])
            for x in (box[1][0] + 3, box[0][0] - 3 - size[0])
            for y in (box[0][1] - 0.3 * size[1], box[1][1] - 0.7 * size[1])
        ]
        cost = [sum(_overlap((p, p + size), other) for other in taken) for p in places]
        cost = [
            c + (0 if _inside(image, p) and _inside(image, p + size) else 1e6)
            for c, p in zip(cost, places, strict=True)
        ]
        corner = places[int(np.argmin(cost))]
        taken.append((corner, corner + size))
        _write(image, text, corner, unit, state.team)


def _flashes(
    image: Image, camera: Camera, t: float, scene: Scene, unit: float, thickness: int
) -> None:
    """Write the time; for a moment after a hit, a ring that grows from it and its name."""
    lines = [f"t = {t:.2f} s"]
    for when, place, text in scene.hits:
        if 0 <= t - when < _FLASH:
            growth = 0.5 + 2.5 * (t - when) / _FLASH
            ring = place + growth * scene.radius * _CIRCLE
            draw_line(image, camera, ring, _WHITE, thickness, scene.height)
            lines.append(text)
    for row, text in enumerate(lines):
        _write(image, text, np.array([10, 10 + 25 * row]) * unit, unit)


def _text_box(text: str, unit: float) -> tuple[Array, int]:
    """Return width and height of a label with its margin, px, and its base line."""
    (w, h), below = cv2.getTextSize(text, _FONT, _LETTERS * unit, 1)
    margin = round(3 * unit)
    return np.array([w + 2 * margin, h + below + 2 * margin], float), margin + h


def _write(
    image: Image, text: str, corner: Array, unit: float, stripe: Colour | None = None
) -> None:
    """Write white on a darkened box, whose upper left corner is at `corner`."""
    size, base = _text_box(text, unit)
    left, top = (max(round(float(v)), 0) for v in corner)
    box = image[top : top + round(size[1]), left : left + round(size[0])]
    box[:] = box // 3
    if stripe is not None:
        box[:, : round(3 * unit)] = stripe
    at = (left + round(3 * unit), top + base)
    thickness = max(round(unit), 1)
    cv2.putText(image, text, at, _FONT, _LETTERS * unit, _WHITE, thickness, cv2.LINE_AA)


def _inside(image: Image, place: Array) -> bool:
    h, w = image.shape[:2]
    return bool(0 <= place[0] < w and 0 <= place[1] < h)


def _overlap(one: Box, other: Box) -> float:
    sides = np.minimum(one[1], other[1]) - np.maximum(one[0], other[0])
    return float(sides[0] * sides[1]) if (sides > 0).all() else 0.0


# ---------------------------------------------------------------------------- coding


class _Encoder:
    """An H.264 file that browsers play, frame by frame, each at its own time."""

    def __init__(self, path: Path, size: tuple[int, int], fps: float | None) -> None:
        self._pad = (size[1] % 2, size[0] % 2)
        self._step = 1 / fps if fps else 1 / DEFAULT_IMAGE_FPS
        self.start: float | None = None
        self._waiting: tuple[Image, int] | None = None
        self._container: Any = av.open(
            str(path), "w", format="mp4", options={"movflags": "+faststart"}
        )
        self._stream: Any = self._container.add_stream(
            "libx264",
            rate=Fraction(fps or DEFAULT_IMAGE_FPS).limit_denominator(1001),
            options={
                "preset": "superfast",
                "crf": "24",
                # What OpenCV turns colours by; players read it here.
                "x264-params": "colorprim=bt709:transfer=bt709:colormatrix=smpte170m",
            },
        )
        self._stream.width, self._stream.height = size[0] + self._pad[1], size[1] + self._pad[0]
        self._stream.pix_fmt = "yuv420p"
        self._stream.codec_context.time_base = _TIME_BASE

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if kind is None:
                self._send(self._step)
                self._container.mux(self._stream.encode())
        finally:
            self._container.close()

    def add(self, image: Image, t: float) -> None:
        """Take the next picture, seen from time `t` (s) on."""
        if self.start is None:
            self.start = t
        pts = round((t - self.start) / _TIME_BASE)
        if self._waiting is not None:
            self._step = float((pts - self._waiting[1]) * _TIME_BASE)
            self._send(self._step)
        self._waiting = (image, pts)

    def _send(self, lasts: float) -> None:
        """Code the picture that waited to learn how long it is shown."""
        if self._waiting is None:
            return
        image, pts = self._waiting
        if any(self._pad):
            bottom, right = self._pad
            image = np.asarray(
                cv2.copyMakeBorder(image, 0, bottom, 0, right, cv2.BORDER_REPLICATE), np.uint8
            )
        planes = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2YUV_I420), np.uint8)
        frame = av.VideoFrame.from_ndarray(planes, format="yuv420p")
        frame.pts, frame.time_base = pts, _TIME_BASE
        frame.duration = round(lasts / _TIME_BASE)
        self._container.mux(self._stream.encode(frame))
