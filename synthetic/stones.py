"""Stones drawn as stacks of discs at their true heights, each pixel's ray met exactly.

The granite is a rounded body (its outline at height z a circle of radius r(z)), the cap a
disc at 0.12 m, the handle a bar above it with one thick end.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from curlshot.synthetic.camera import View
from curlshot.synthetic.ice import Picture
from curlshot.synthetic.scene import Colour, Light, Stone

Array = NDArray[np.float64]
Field = NDArray[np.floating[Any]]

SLICES = np.deg2rad([-35.0, -5.0, 15.0, 35.0, 50.0, 63.0, 76.0, 90.0])
HEIGHT, EDGE = 0.114, 0.040
HANDLE_HEIGHT = 0.148
SIDE_LIGHT = 0.7  # of the side of a cap, beside its top: lamps are above
NECK, FREE_END, HALF_WIDTH, NECK_WIDTH = -0.056, 0.074, 0.0125, 0.0195
PIECES = 12  # of a handle that rises
AROUND = np.array([f(np.linspace(0, 2 * np.pi, 12, endpoint=False)) for f in (np.cos, np.sin)])


def draw_stones(
    picture: Picture, view: View, stones: tuple[Stone, ...], states: Array, light: Light
) -> None:
    """Draw shadows, then stones from far to near, into `picture`.

    Parameters
    ----------
    picture : ndarray, shape (h, w, 3)
        Changed in place.
    view : View
        The camera.
    stones : tuple of Stone
        Their looks.
    states : ndarray, shape (stones, 6)
        x, y, theta, vx, vy, omega.
    light : Light
        Lamps and shadows.
    """
    seen = []
    for stone, state in zip(stones, states, strict=True):
        window = _window(view, state, stone.radius + 0.12, 0.2, 0.15)
        if window is not None:
            ground = view.ground(_pixels(window)).astype(np.float32)
            seen.append((stone, state, window, ground[..., 0].copy(), ground[..., 1].copy()))
    for stone, state, window, x, y in seen:
        _shade_ice(picture[window], stone, state, x, y, light)
    eye = view.position
    seen.sort(key=lambda s: -float(np.hypot(s[1][0] - eye[0], s[1][1] - eye[1])))
    for stone, state, window, x, y in seen:
        reach = 1.1 * stone.radius
        body = _window(view, state, reach, reach, 0.18)
        if body is None:
            continue
        own = tuple(
            slice(max(b.start - w.start, 0), max(min(b.stop, w.stop) - w.start, 0))
            for b, w in zip(body, window, strict=True)
        )
        scale = view.scale(float(state[0]), float(state[1]))
        whole = picture[window]
        # Colour by colour: rows of pixels are what numpy is quick with, not rows of three.
        part = np.ascontiguousarray(np.moveaxis(whole[own], -1, 0), np.float32)
        _paint_stone(part, stone, state, x[own], y[own], eye, scale, light)
        whole[own] = np.moveaxis(np.clip(part + 0.5, 0, 255).astype(np.uint8), 0, -1)


def _window(
    view: View, state: Array, at_foot: float, above: float, height: float
) -> tuple[slice, slice] | None:
    """Pixels of what reaches so far about a stone's centre on the ice and so far at a height."""
    x, y = float(state[0]), float(state[1])
    c, s = AROUND
    points = np.concatenate(
        [
            np.column_stack([x + at_foot * c, y + at_foot * s, 0 * c]),
            np.column_stack([x + above * c, y + above * s, 0 * c + height]),
        ]
    )
    undistorted, depth = view.pinhole(points)
    if (depth < 0.5).any():
        return None
    size = float(np.hypot(*view.lens.size))
    if (np.abs(undistorted - view.lens.centre) > size).any():
        return None  # radial distortion is only meant for what is near the picture
    p = view.lens.distort(undistorted)
    w, h = view.lens.size
    low = np.maximum(np.floor(p.min(0)).astype(int), 0)
    high = np.minimum(np.ceil(p.max(0)).astype(int) + 1, [w, h])
    if (low >= high).any():
        return None
    return slice(int(low[1]), int(high[1])), slice(int(low[0]), int(high[0]))


def _pixels(window: tuple[slice, slice]) -> Array:
    rows, columns = window
    return np.stack(
        np.meshgrid(np.arange(columns.start, columns.stop), np.arange(rows.start, rows.stop)),
        axis=-1,
    ).astype(float)


def _shade_ice(part: Picture, stone: Stone, state: Array, x: Field, y: Field, light: Light) -> None:
    u, v = x - float(state[0]), y - float(state[1])
    dark = np.zeros_like(x)
    for along, across, spread, depth in (
        (0.0, 0.0, 0.022, 1.0), (0.05, 0.03, 0.035, 0.35), (-0.045, 0.03, 0.035, 0.3),
        (0.01, -0.06, 0.04, 0.3),
    ):  # fmt: skip
        r = _length(u - along, v - across)
        dark += depth / (1 + np.exp((r - 0.13 * stone.radius / 0.1455) / (spread * 0.5)))
    keep = np.exp(-light.shadow * dark)
    for channel in range(3):
        part[..., channel] = (part[..., channel] * keep + 0.5).astype(np.uint8)


def _length(x: Field, y: Field) -> Field:
    return np.asarray(np.sqrt(x * x + y * y))


def _paint_stone(
    part: Field,
    stone: Stone,
    state: Array,
    x: Field,
    y: Field,
    eye: Array,
    scale: float,
    light: Light,
) -> None:
    """Paint onto `part`, shape (3, h, w), whose pixels show the ice at x, y."""
    centre_x, centre_y, theta = (float(value) for value in state[:3])
    towards_x, towards_y = float(eye[0]) - x, float(eye[1]) - y
    size = stone.radius / 0.1455

    def at(z: float) -> tuple[Field, Field]:
        up = z / float(eye[2])
        return x + towards_x * up - centre_x, y + towards_y * up - centre_y

    def covered(distance: Field) -> Field:
        return np.asarray(np.clip(0.5 - distance * scale, 0, 1))

    def lay(cover: Field, colour: Field) -> None:
        part[:] += cover * (colour - part)

    def blend(distance: Field, colour: Field, strength: float = 1.0) -> None:
        lay(strength * covered(distance), colour)

    granite = _plain(stone.granite)
    bulge = HEIGHT / 2
    p = at(HEIGHT)
    azimuth = np.arctan2(p[1], p[0])
    grain = _speckle(p, theta, stone.name) + 6 * np.sin(azimuth - 0.7)
    shine = _glints(azimuth, light.lamps)
    for phi in SLICES.tolist():
        r = _length(*at(bulge + bulge * float(np.sin(phi))))
        outline = stone.radius - EDGE * size * (1 - float(np.cos(phi)))
        lit = 0.42 + 0.50 * max(float(np.sin(phi)), 0.0) ** 0.7 + 0.06 * float(np.cos(phi))
        tone = granite * lit + grain
        if np.deg2rad(55) < phi < np.deg2rad(70):
            tone = tone + shine * 55
        blend(r - outline, tone)

    cap = _plain(stone.cap)
    rim = stone.cap_radius
    r = _length(*at(stone.cap_height))
    if stone.side:
        # Only beside the top: what both cover in part would lie too far out.
        below = np.min([_length(*at(z)) for z in stone.side], axis=0)
        top, whole = covered(r - rim), covered(np.minimum(r, below) - rim)
        lay((whole - top) / np.maximum(1 - top, 1e-6), cap * SIDE_LIGHT)
    blend(r - rim, cap * 0.80 + shine * 45)
    sheen = 1 + 0.09 * np.sin(azimuth - 1.1) * (r / rim)
    groove = 0.10 * np.exp(-(((r - 0.72 * rim) / (0.06 * rim)) ** 2))
    arc = 34 * np.exp(-(((r - 0.80 * rim) / (0.05 * rim)) ** 2)) * (np.cos(azimuth - 2.6) > 0.2)
    blend(r - 0.95 * rim, cap * (sheen - groove) + arc)

    shadow_x, shadow_y = at(stone.cap_height + 0.004)
    blend(_handle((shadow_x + 0.006, shadow_y + 0.006), theta, rim), cap * 0.45, 0.75)
    bar = _plain(stone.handle)
    if not stone.steepness:
        distance = _handle(at(HANDLE_HEIGHT), theta, rim)
    else:
        distance = np.min(
            [
                _handle(at(HANDLE_HEIGHT + stone.steepness * along), theta, rim, part)
                for along, *part in _pieces(rim)
            ],
            axis=0,
        )
    blend(distance, bar * (0.86 + 0.14 * np.clip(-distance / 0.008, 0, 1)))


def _plain(colour: Colour) -> Field:
    return np.array(colour, np.float32)[:, None, None]


def _handle(
    p: tuple[Field, Field], theta: float, rim: float, part: Sequence[float] = (NECK, FREE_END)
) -> Field:
    """Distance to the outline of part of the handle, m: a bar along theta with its neck thicker."""
    size = rim / 0.1045
    c, s = math.cos(theta), math.sin(theta)
    along, across = p[0] * c + p[1] * s, p[1] * c - p[0] * s
    nearest = np.clip(along, part[0] * size, part[1] * size)
    bar = _length(along - nearest, across) - HALF_WIDTH * size
    if part[0] != NECK:
        return np.asarray(bar)
    neck = _length(along - NECK * size, across) - NECK_WIDTH * size
    return np.asarray(np.minimum(bar, neck))


def _pieces(rim: float) -> Iterator[tuple[float, float, float]]:
    """Middles of the pieces of which a handle that rises is made, m, and where they end."""
    ends = np.linspace(NECK, FREE_END, PIECES + 1)
    middles = (0.5 * (ends[1:] + ends[:-1]) - ends.mean()) * rim / 0.1045
    return zip(middles.tolist(), ends[:-1].tolist(), ends[1:].tolist(), strict=True)


def _glints(azimuth: Field, lamps: tuple[float, ...]) -> Field:
    return np.asarray(_lamp_table(lamps)[(azimuth * (720 / (2 * np.pi))).astype(int) % 720])


@cache
def _lamp_table(lamps: tuple[float, ...]) -> Field:
    around = np.arange(720) * (2 * np.pi / 720)
    off = np.angle(np.exp(1j * (around[:, None] - np.array(lamps))))
    return np.asarray(np.exp(-((off / 0.06) ** 2)).sum(-1), np.float32)


def _speckle(p: tuple[Field, Field], theta: float, name: str) -> Field:
    """Grain of the granite that turns with the stone, grey levels."""
    table = _grain_table(name)
    c, s = math.cos(theta), math.sin(theta)
    u, v = p[0] * c + p[1] * s, p[1] * c - p[0] * s
    cell = 0.008
    return np.asarray(table[(u // cell).astype(int) % 64, (v // cell).astype(int) % 64])


@cache
def _grain_table(name: str) -> Field:
    grain = np.random.default_rng(sum(map(ord, name))).normal(0, 7, (64, 64))
    return np.asarray(grain, np.float32)
