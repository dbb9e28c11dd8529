"""The clip with what was found drawn on it: rings, stones, names, trails, speeds and hits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from curlshot.data.files import whole_file
from curlshot.data.progress import Progress, no_progress
from curlshot.data.results import Hit
from curlshot.data.sheet import HOUSE, STONE
from curlshot.report.drawing import (
    WHITE,
    Box,
    Colour,
    circle,
    draw_lines,
    ice_lines,
    inside,
    overlap,
    text_box,
    write,
)  # fmt: skip
from curlshot.report.encode import Encoder
from curlshot.report.style import stone_colours, team_colour
from curlshot.report.tables import play
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Image
from curlshot.vision.video.reader import Video

Array = NDArray[np.float64]

RINGS = (HOUSE.twelve_foot, HOUSE.eight_foot, HOUSE.four_foot)

_RIM = circle(49)
_APART = 0.1  # radii between the points of a trail
_RESTS = 0.05  # m/s below which a stone's speed is not worth a label
_TURNS = 0.1  # rad/s, the same for its spin
_TURNED = 0.2  # rad; of a stone that turns less no angle is shown, for its zero may be arbitrary
_FLASH = 0.4  # s that a ring grows from a hit
_SAID = 2.0  # s that its name stays, time to look there and read three words
_MOST_SAID = 5  # names of hits at once, more nobody reads
_LEAST_UNIT = 0.75  # of the usual size, below which letters cannot be read
_LINE_COLOUR = (255, 255, 120)


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
    video: Video,
    cameras: Iterable[Camera],
    tracks: pd.DataFrame,
    collisions: Sequence[Hit],
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
    video : Video
        Read once, from the start.
    cameras : iterable of Camera
        Found by their `frame`.
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`, `frame` counting as the clip does.
    collisions : sequence of Hit
        Each flashed for a moment, and named for two seconds.
    path : Path
        Ends in .mp4.
    rings : sequence of float or None
        Painted radii of the house, m; None where there is no house: no lines either.
    radius : float
        Radius of the stones, m.
    progress : Progress
        Called after each frame.

    Returns
    -------
    float
        Time in the clip of the first picture, s, which is 0 in the MP4.
    """
    scene = _scene(tracks, collisions, rings, radius)
    by_frame = {camera.frame: camera for camera in cameras}
    total = video.expected
    with whole_file(path) as part, Encoder(part, video.whole_size, video.fps) as encoder:
        for done, frame in enumerate(video.uncut(), 1):
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
    draw_lines(image, camera, scene.lines, _LINE_COLOUR, thin, edge=False)
    states = scene.states.get(frame.index, [])
    now = {state.stone: state.place for state in states}
    for name, (frames, places) in scene.paths.items():
        stop = int(np.searchsorted(frames, frame.index, side="right"))
        trail = places[:stop] if name not in now else np.vstack([places[:stop], now[name]])
        draw_lines(image, camera, [trail], scene.colours[name], thick)
    for state in states:
        rim = [state.place + scene.radius * _RIM]
        if np.isfinite(state.theta):
            tip = np.array([np.cos(state.theta), np.sin(state.theta)])
            rim.append(state.place + scene.radius * np.array([[0.4], [1.0]]) * tip)
        width = thick if state.seen else thin
        draw_lines(image, camera, rim, scene.colours[state.stone], width, scene.height)
    _flash(image, camera, frame.t, scene, thick)
    # Words come last: a ring across a name would hide it.
    _label(image, camera, states, scene, unit)
    _say(image, frame.t, scene, unit)
    return image


# ---------------------------------------------------------------------------- the scene


def _scene(
    tracks: pd.DataFrame,
    collisions: Sequence[Hit],
    rings: Sequence[float] | None,
    radius: float,
) -> Scene:
    lines = [] if rings is None else ice_lines(rings, play(tracks, collisions, radius))
    states: dict[int, list[State]] = {}
    paths = {}
    for name, rows in tracks.sort_values("t").groupby("stone", sort=True):
        stone = str(name)
        frames = rows["frame"].to_numpy(np.int64)
        columns = ["x", "y", "theta", "vx", "vy", "omega", "seen"]
        x, y, theta, vx, vy, omega, seen = rows[columns].to_numpy(float).T
        team = team_colour(rows["team"].iloc[0])
        places = np.stack([x, y], axis=1)
        told = theta[np.isfinite(theta)]
        if told.size and np.ptp(told) < _TURNED:
            theta = np.full_like(theta, np.nan)
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


# ---------------------------------------------------------------------------- words


def _label(
    image: Image, camera: Camera, states: Sequence[State], scene: Scene, unit: float
) -> None:
    """Write each stone's name, and speed and spin while it has any, where nothing is in the way.

    The stripe before the name has the colour of its team.
    """
    stones = [
        _box(camera.project(s.place + scene.radius * _RIM[::6], scene.height)) for s in states
    ]
    taken = list(stones)
    for state, stone in zip(states, stones, strict=True):
        left, top, right, bottom = stone
        middle = (left + right) / 2, (top + bottom) / 2
        if not inside(image, (*middle, *middle)):
            continue
        text = state.stone
        if state.speed > _RESTS:
            text += f" {state.speed:.2f} m/s"
        if abs(state.omega) > _TURNS:
            text += f" {state.omega:+.1f} rad/s"
        w, h = text_box(text, unit)
        places = [
            (x, y, x + w, y + h)
            for x in (right + 3, left - 3 - w)
            for y in (top - 0.3 * h, bottom - 0.7 * h)
        ]
        best = min(places, key=lambda place: _cost(image, place, taken))
        taken.append(best)
        write(image, text, best[:2], unit, state.team)


def _box(pixels: Array) -> Box:
    (left, top), (right, bottom) = pixels.min(axis=0).tolist(), pixels.max(axis=0).tolist()
    return left, top, right, bottom


def _cost(image: Image, place: Box, taken: Sequence[Box]) -> float:
    """Say how bad it would be to write there: what would be hidden, and what would be cut."""
    hidden = sum(overlap(place, other) for other in taken)
    return hidden if inside(image, place) else hidden + 1e6


def _flash(image: Image, camera: Camera, t: float, scene: Scene, thickness: int) -> None:
    """Draw for a moment after a hit a ring that grows from it."""
    for when, place, _ in scene.hits:
        if 0 <= t - when < _FLASH:
            growth = 0.5 + 2.5 * (t - when) / _FLASH
            ring = place + growth * scene.radius * _RIM
            draw_lines(image, camera, [ring], WHITE, thickness, scene.height)


def _say(image: Image, t: float, scene: Scene, unit: float) -> None:
    """Write the time, and of hits a while ago their names."""
    lines = [text for when, _, text in scene.hits if 0 <= t - when < _SAID]
    if len(lines) > _MOST_SAID:  # a broken rack
        lines = [*lines[:_MOST_SAID], f"and {len(lines) - _MOST_SAID} more"]
    for row, text in enumerate([f"t = {t:.2f} s", *lines]):
        write(image, text, (10 * unit, (10 + 25 * row) * unit), unit)
