"""A second renderer, as a check on the first: rays through each pixel, flat colours, no more.

It shares the camera, the scene's parameters and the motion with the first, but neither its
painted plates nor its warp nor its looks: each sub-pixel sample is traced to the plane that it
meets first and gets that plane's flat colour. Lines run through the button, printing is bars,
stones are two discs, people are a few, light falls off to one side.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.synthetic.camera import CameraPath, Lens, View
from curlshot.synthetic.ice import BACK_LINE, HOG_LINE, HOG_WIDTH
from curlshot.synthetic.mixing import coded, lit
from curlshot.synthetic.render import motion_of
from curlshot.synthetic.scene import Colour, Mark, Paint, Person, Scene, Sheet

Picture = NDArray[np.uint8]
Field = NDArray[np.float32]

ROTATED_GRID = np.array([(-0.375, -0.125), (0.125, -0.375), (0.375, 0.125), (-0.125, 0.375)])
"""Where in each cell of a pixel rays are sent."""

GRANITE_HEIGHT = 0.07
STROKE = 0.16
"""Width of a bar of printing over the height of its letters."""


@dataclass
class _Labels:
    """Which colour each sample has, shape (n, h, w), and the colours."""

    label: NDArray[np.uint8]
    palette: list[Colour]

    def paint(self, where: tuple[slice, ...], mask: NDArray[np.bool_], colour: Colour) -> None:
        if colour not in self.palette:
            self.palette.append(colour)
        self.label[where][mask] = self.palette.index(colour)


@dataclass(frozen=True)
class _Rays:
    """Directions of all samples in the world, per metre of fall, shape (n, h, w) each."""

    eye: NDArray[np.float64]
    x: Field
    y: Field

    def meet(self, height: float, where: tuple[slice, ...] = (slice(None),)) -> tuple[Field, Field]:
        """Where the rays meet the plane at this height, m."""
        fall = np.float32(self.eye[2] - height)
        x, y = self.x[where] * fall, self.y[where] * fall
        return x + np.float32(self.eye[0]), y + np.float32(self.eye[1])


def plain_pictures(
    scene: Scene,
    camera: CameraPath,
    times: ArrayLike,
    *,
    shutter: float = 0.01,
    supersample: int = 1,
) -> Iterator[tuple[float, Picture]]:
    """Render (t, BGR picture) at the times given, s.

    The exposure is the mean of the pictures at a quarter and three quarters of the shutter. Each
    pixel is cut into `supersample` × `supersample` cells.
    """
    moments = np.asarray(times, float)
    motion = motion_of(scene, float(moments.max()) + 0.1)
    rng = np.random.default_rng([scene.seed, 5])
    for t in moments.tolist():
        ends = t - shutter / 4, t + shutter / 4
        sharp = [_instant(scene, camera.at(s), motion.at(s), s, supersample) for s in ends]
        noise = rng.normal(0, scene.light.noise, sharp[0].shape).astype(np.float32)
        mixed = coded((sharp[0] + sharp[1]) / 2, scene.light.power) * _fall_off(scene, camera)
        yield t, np.clip(mixed + noise + 0.5, 0, 255).astype(np.uint8)


def _instant(scene: Scene, view: View, states: NDArray[np.float64], t: float, cells: int) -> Field:
    rays = _rays(view, cells)
    labels = _Labels(np.zeros(rays.x.shape, np.uint8), [scene.sheet.carpet])
    x, y = rays.meet(0.0)
    for n in (-2, -1, 0, 1, 2):
        _sheet(labels, x - np.float32(n * scene.sheet.pitch), y, scene.sheet, scene.paint)
    for stone, state in zip(scene.stones, states, strict=True):
        _disc(labels, view, rays, state[:2], GRANITE_HEIGHT, stone.radius, stone.granite)
        for height in (*stone.side, stone.cap_height):
            _disc(labels, view, rays, state[:2], height, stone.cap_radius, stone.cap)
    for person in scene.people:
        for place, height, radius, colour in _body(person, t):
            _disc(labels, view, rays, place, height, radius, colour)
    colours = lit(np.array(labels.palette, np.uint8), scene.light.power)
    picture = np.sum([colours[layer] for layer in labels.label], axis=0)
    return np.asarray(picture / np.float32(len(labels.label)), np.float32)


def _fall_off(scene: Scene, camera: CameraPath) -> Field:
    """Light falls off to one side, shape (1, w, 1)."""
    slope = np.linspace(1, 1 - scene.light.vignette, camera.size[0], dtype=np.float32)
    return np.asarray(slope[None, :, None] * np.float32(scene.light.gain), np.float32)


def _rays(view: View, cells: int) -> _Rays:
    right, down = _pinhole(view.lens, cells)
    a, b = right / np.float32(view.focal), down / np.float32(view.focal)
    r = view.rotation.astype(np.float32)
    along = [r[0, k] * a + r[1, k] * b + r[2, k] for k in range(3)]
    fall = np.where(along[2] < -1e-4, -along[2], np.float32(np.nan))
    return _Rays(view.position, along[0] / fall, along[1] / fall)


@lru_cache(maxsize=2)
def _pinhole(lens: Lens, cells: int) -> tuple[Field, Field]:
    """Undistorted places of all samples, px from the middle of the picture."""
    w, h = lens.size
    pixels = np.stack(np.meshgrid(np.arange(w), np.arange(h)), axis=-1)
    middles = (np.arange(cells) + 0.5) / cells - 0.5
    cell = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 1, 2)
    samples = (cell + ROTATED_GRID / cells).reshape(-1, 1, 1, 2)
    places = lens.undistort(pixels + samples) - lens.centre
    return places[..., 0].astype(np.float32), places[..., 1].astype(np.float32)


def _sheet(labels: _Labels, x: Field, y: Field, sheet: Sheet, paint: Paint) -> None:
    everywhere = (slice(None),)
    left, right = -sheet.half_width[0], sheet.half_width[1]
    with np.errstate(invalid="ignore"):
        wall = sheet.border_width
        labels.paint(everywhere, (x > left - wall) & (x < right + wall), sheet.border)
        on_ice = (x > left) & (x < right)
        labels.paint(everywhere, on_ice, sheet.ice)
        squared = x * x + y * y
        colours = (paint.twelve, paint.eight, paint.four, paint.button)
        for radius, colour in zip(paint.radii, colours, strict=True):
            labels.paint(everywhere, squared < radius**2, colour)
            if paint.outline is not None and radius > 0:
                inner = radius + (paint.outline_at - 0.5) * paint.outline_width
                outer = inner + paint.outline_width
                edge = (squared > inner**2) & (squared < outer**2)
                labels.paint(everywhere, edge, paint.outline)
        half = sheet.line_width / 2
        for offset in (-sheet.line_gap / 2, sheet.line_gap / 2):
            line = np.abs(x - np.float32(offset)) < half
            for across in (0.0, -BACK_LINE):
                line |= np.abs(y - np.float32(across + offset)) < half
            labels.paint(everywhere, line & on_ice, sheet.line)
        hog = (y > HOG_LINE) & (y < HOG_LINE + HOG_WIDTH)
        labels.paint(everywhere, hog & on_ice, sheet.hog_line)
        for mark in sheet.marks:
            labels.paint(everywhere, _bars(mark, x, y), mark.colour)


def _bars(mark: Mark, x: Field, y: Field) -> NDArray[np.bool_]:
    """Return where the bars of a printed word lie: one per letter."""
    step = 2.5 * STROKE * mark.height
    along = x - np.float32(mark.x - step * len(mark.text) / 2)
    inside = (along > 0) & (along < step * len(mark.text))
    inside &= np.abs(y - np.float32(mark.y)) < mark.height / 2
    return np.asarray(inside & (np.mod(along, step) < STROKE * mark.height))


def _body(person: Person, t: float) -> Iterator[tuple[NDArray[np.float64], float, float, Colour]]:
    """Place, height and radius of the discs that stand for a person."""
    keys = np.array(person.path)
    x, y, heading = (float(np.interp(t, keys[:, 0], keys[:, k])) for k in (1, 2, 3))
    ahead = np.array([np.cos(heading), np.sin(heading)])
    hips = np.array([x, y])
    yield hips + 1.0 * ahead, 0.05, 0.1, person.broom
    yield hips, 0.5, 0.2, person.trousers
    yield hips + 0.15 * ahead, 1.1, 0.28, person.shirt
    yield hips + 0.35 * ahead, 1.45, 0.11, person.hair


def _disc(
    labels: _Labels,
    view: View,
    rays: _Rays,
    place: NDArray[np.float64],
    height: float,
    radius: float,
    colour: Colour,
) -> None:
    """Return a level disc, in the part of the picture where it can be seen."""
    corners = np.array([[dx, dy] for dx in (-radius, radius) for dy in (-radius, radius)])
    seen, depth = view.pinhole(np.column_stack([place + corners, np.full(4, height)]))
    w, h = view.lens.size
    if (depth < 0.3).any() or (np.abs(seen - view.lens.centre) > np.hypot(w, h)).any():
        return
    seen = view.lens.distort(seen)
    low = np.clip(np.floor(seen.min(0)) - 3, 0, [w, h]).astype(int)
    high = np.clip(np.ceil(seen.max(0)) + 4, 0, [w, h]).astype(int)
    if (low >= high).any():
        return
    where = slice(None), slice(low[1], high[1]), slice(low[0], high[0])
    x, y = rays.meet(height, where)
    x -= np.float32(place[0])
    y -= np.float32(place[1])
    with np.errstate(invalid="ignore"):
        labels.paint(where, x * x + y * y < radius**2, colour)
