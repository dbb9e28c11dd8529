"""The painted ice as a plate: a large picture in ice coordinates, and its warp into a view.

Edges are painted with their exact distance, so that the 50 % point of an edge lies on it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.synthetic.camera import View
from curlshot.synthetic.scene import Colour, Light, Mark, Paint, Scene, Sheet

Picture = NDArray[np.uint8]
Field = NDArray[np.float32]

HOG_LINE, BACK_LINE, HOG_WIDTH = 6.401, 1.829, 0.10
CELL = 4  # px between exactly mapped points; linear in between errs by less than 0.003 px


@dataclass(frozen=True)
class Extent:
    """Rectangle of ice, m."""

    x0: float
    x1: float
    y0: float
    y1: float


@dataclass(frozen=True)
class Plate:
    """The same ice at falling resolution, in steps of √2.

    Pixel (0, 0) is centred half a pixel inside. What is coarser than `finest` is made when it is
    first asked for.
    """

    extent: Extent
    finest: Picture
    outside: Colour
    coarser: dict[int, Picture] = field(default_factory=dict)

    @property
    def coarsest(self) -> int:
        """The last level: 6, or the first with no more than 150 pixels along one side."""
        few = (k for k in range(6) if min(self._size(k)) <= 150)
        return next(few, 6)

    def _size(self, level: int) -> tuple[int, int]:
        h, w = (round(n * 0.5 ** (level / 2)) for n in self.finest.shape[:2])
        return w, h

    def level(self, level: int) -> Picture:
        """Return the ice at finest density over √2 to the power of `level`."""
        if level == 0:
            return self.finest
        if level not in self.coarser:
            # by size and not by factor, so that the coarser picture spans the whole extent
            smaller = cv2.resize(self.finest, self._size(level), interpolation=cv2.INTER_AREA)
            self.coarser[level] = np.asarray(smaller, np.uint8)
        return self.coarser[level]

    def density(self, level: int) -> tuple[float, float]:
        """Plate pixels per metre along x and y."""
        w, h = self._size(level)
        e = self.extent
        return w / (e.x1 - e.x0), h / (e.y1 - e.y0)


class _Canvas:
    """A float picture (3, h, w) of the ice in which shapes are blended by their coverage."""

    def __init__(self, extent: Extent, density: float, ground: Colour) -> None:
        w = round((extent.x1 - extent.x0) * density)
        h = round((extent.y1 - extent.y0) * density)
        whole = Extent(extent.x0, extent.x0 + w / density, extent.y1 - h / density, extent.y1)
        self.extent, self.density = whole, density
        self.image = np.empty((3, h, w), np.float32)
        self.image[:] = np.array(ground)[:, None, None]
        self.x = (extent.x0 + (np.arange(w) + 0.5) / density).astype(np.float32)
        self.y = (extent.y1 - (np.arange(h) + 0.5) / density).astype(np.float32)

    def window(self, x0: float, x1: float, y0: float, y1: float) -> tuple[slice, slice]:
        pad = 2 / self.density
        columns = np.flatnonzero((self.x > x0 - pad) & (self.x < x1 + pad))
        rows = np.flatnonzero((self.y > y0 - pad) & (self.y < y1 + pad))
        if not len(columns) or not len(rows):
            return slice(0, 0), slice(0, 0)
        return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)

    def blend(self, where: tuple[slice, slice], coverage: Field, colour: Colour) -> None:
        for layer, value in zip(self.image, colour, strict=True):
            part = layer[where]
            part += coverage * (np.float32(value) - part)

    def _cover(self, distance: Field) -> Field:
        return np.asarray(np.clip(0.5 - distance * self.density, 0, 1), np.float32)

    def disc(self, x: float, y: float, radius: float, colour: Colour) -> None:
        self.ring(x, y, -1.0, radius, colour)

    def ring(self, x: float, y: float, inner: float, outer: float, colour: Colour) -> None:
        where = self.window(x - outer, x + outer, y - outer, y + outer)
        r = np.hypot(self.x[where[1]][None] - x, self.y[where[0]][:, None] - y)
        self.blend(where, self._cover(np.maximum(r - outer, inner - r)), colour)

    def box(self, x0: float, x1: float, y0: float, y1: float, colour: Colour) -> None:
        where = self.window(x0, x1, y0, y1)
        x, y = self.x[where[1]], self.y[where[0]]
        across = self._cover(np.abs(x - (x0 + x1) / 2) - (x1 - x0) / 2)
        along = self._cover(np.abs(y - (y0 + y1) / 2) - (y1 - y0) / 2)
        self.blend(where, along[:, None] * across[None], colour)

    def word(self, mark: Mark) -> None:
        font, scale, thick = cv2.FONT_HERSHEY_DUPLEX, 4.0, 14
        (w, h), base = cv2.getTextSize(mark.text, font, scale, thick)
        stencil = np.zeros((h + base + 40, w + 40), np.uint8)
        cv2.putText(stencil, mark.text, (20, h + 20), font, scale, 255, thick, cv2.LINE_AA)
        step = mark.height / h
        reach = float(np.hypot(*stencil.shape)) * step / 2
        where = self.window(mark.x - reach, mark.x + reach, mark.y - reach, mark.y + reach)
        dx = self.x[where[1]][None] - mark.x
        dy = self.y[where[0]][:, None] - mark.y
        if dx.size == 0 or dy.size == 0:
            return
        c, s = np.cos(mark.angle), np.sin(mark.angle)
        u, v = (c * dx + s * dy) / step, (c * dy - s * dx) / step
        if mark.ground is not None:
            edge = np.maximum(np.abs(u) - w / 2 - h * 0.4, np.abs(v) - h * 0.95) * step
            self.blend(where, self._cover(edge.astype(np.float32)), mark.ground)
        soft = cv2.GaussianBlur(stencil, (0, 0), max(0.4 / (step * self.density), 0.5))
        columns = (u + (stencil.shape[1] - 1) / 2).astype(np.float32)
        rows = ((stencil.shape[0] - 1) / 2 - v - base / 4).astype(np.float32)
        cover = cv2.remap(soft, columns, rows, cv2.INTER_LINEAR)
        self.blend(where, (cover / 255).astype(np.float32), mark.colour)


def paint_plate(scene: Scene, extent: Extent, density: float) -> Plate:
    """Paint the scene's ice at `density` px/m."""
    return _painted(scene.sheet, scene.paint, scene.light, scene.seed, extent, density)


@lru_cache(maxsize=2)  # stills are often of the same ice, seen by the same camera
def _painted(
    sheet: Sheet, paint: Paint, light: Light, seed: int, extent: Extent, density: float
) -> Plate:
    canvas = _Canvas(extent, density, sheet.carpet)
    for n in (-2, -1, 1, 2):
        _paint_sheet(canvas, sheet, paint, n * sheet.pitch)
    _paint_sheet(canvas, sheet, paint, 0.0)
    _texture(canvas, light, np.random.default_rng(seed))
    finest = cv2.merge([np.clip(c + 0.5, 0, 255).astype(np.uint8) for c in canvas.image])
    return Plate(canvas.extent, np.asarray(finest, np.uint8), sheet.carpet)


def _paint_sheet(canvas: _Canvas, sheet: Sheet, paint: Paint, x: float) -> None:
    left, right = x - sheet.half_width[0], x + sheet.half_width[1]
    low, high = -100.0, 100.0
    canvas.box(left - sheet.border_width, right + sheet.border_width, low, high, sheet.border)
    canvas.box(left, right, low, high, sheet.ice)
    colours = (paint.twelve, paint.eight, paint.four, paint.button)
    for which, (radius, colour) in enumerate(zip(paint.radii, colours, strict=True)):
        within = radius
        if paint.outline is not None and which < 3:
            # Not over the edge of the paint: what both cover in part would lie too far out.
            outside = radius + (paint.outline_at + 0.5) * paint.outline_width
            canvas.disc(x, 0.0, outside, paint.outline)
            within = outside - paint.outline_width
        canvas.disc(x, 0.0, within, colour)
    inner = paint.radii[3]
    for low_side, high_side in _stripes(sheet):
        for y0, y1 in ((low, -inner), (inner, high)):
            canvas.box(x + low_side, x + high_side, y0, y1, sheet.line)
        canvas.box(left, x - inner, low_side, high_side, sheet.line)
        canvas.box(x + inner, right, low_side, high_side, sheet.line)
        canvas.box(left, right, low_side - BACK_LINE, high_side - BACK_LINE, sheet.line)
    canvas.box(left, right, HOG_LINE, HOG_LINE + HOG_WIDTH, sheet.hog_line)
    if paint.logo:
        canvas.word(Mark(paint.logo, x, 0.0, inner * 0.42, paint.logo_colour))
    for mark in sheet.marks:
        canvas.word(Mark(mark.text, mark.x + x, mark.y, mark.height, mark.colour, mark.ground,
                         mark.angle))  # fmt: skip


def _stripes(sheet: Sheet) -> tuple[tuple[float, float], ...]:
    """Sides of the stripes of which a line is made, m from its middle."""
    half, gap = sheet.line_width / 2, sheet.line_gap / 2
    if not gap:
        return ((-half, half),)
    return (-gap - 2 * half, -gap), (gap, gap + 2 * half)


def _texture(canvas: _Canvas, light: Light, rng: np.random.Generator) -> None:
    h, w = canvas.image.shape[1:]
    metre = canvas.density
    tone = np.zeros((h, w), np.float32)
    for length, depth in ((2.2, 3.0), (0.6, 1.6), (0.05, 0.8)):
        cells = (max(int(h / metre / length), 2), max(int(w / metre / length), 2))
        grain = rng.standard_normal(cells).astype(np.float32)
        tone += light.texture * depth * cv2.resize(grain, (w, h), interpolation=cv2.INTER_CUBIC)
    for _ in range(14):
        x = rng.uniform(canvas.extent.x0, canvas.extent.x1)
        y = rng.uniform(canvas.extent.y0, canvas.extent.y1)
        spread = rng.uniform(0.25, 0.7)
        where = canvas.window(x - 3 * spread, x + 3 * spread, y - 3 * spread, y + 3 * spread)
        r2 = (canvas.x[where[1]][None] - x) ** 2 + (canvas.y[where[0]][:, None] - y) ** 2
        tone[where] += light.glare * np.exp(-r2 / (2 * spread**2))
    for layer in canvas.image:
        layer += tone * (0.25 + 0.75 / 255 * layer)


def warp(plate: Plate, view: View) -> Picture:
    """Return the bare ice as the view sees it; every point mapped through the true camera."""
    w, h = view.lens.size
    columns = np.arange(-1, -(-w // CELL) + 1) * CELL + (CELL - 1) / 2
    rows = np.arange(-1, -(-h // CELL) + 1) * CELL + (CELL - 1) / 2
    nodes = view.ground(np.stack(np.meshgrid(columns, rows), axis=-1))
    finest = plate.density(0)
    middle = view.ground(view.lens.centre)
    wanted = finest[0] / max(view.scale(float(middle[0]), float(middle[1])), 1.0)
    level = int(np.clip(np.floor(2 * np.log2(max(wanted, 1.0)) + 0.5), 0, plate.coarsest))
    dx, dy = plate.density(level)
    e = plate.extent
    maps = []
    for metres in ((nodes[..., 0] - e.x0) * dx - 0.5, (e.y1 - nodes[..., 1]) * dy - 0.5):
        grid = np.nan_to_num(metres, nan=-1e4).clip(-1e4, 3e4).astype(np.float32)
        full = cv2.resize(
            grid, (len(columns) * CELL, len(rows) * CELL), interpolation=cv2.INTER_LINEAR
        )
        maps.append(full[CELL : CELL + h, CELL : CELL + w])
    warped = cv2.remap(
        plate.level(level), maps[0], maps[1], cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT, borderValue=plate.outside,
    )  # fmt: skip
    return np.asarray(warped, np.uint8)
