"""One exposure of a scene: ice, stones and people through the camera, with blur and noise.

The state at the middle of the exposure is the truth; blur is the mean of sub-exposures that
lie symmetrically about it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache, lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.synthetic.camera import CameraPath, View
from curlshot.synthetic.ice import Extent, Picture, Plate, paint_plate, warp
from curlshot.synthetic.mixing import coded, lit
from curlshot.synthetic.people import draw_people
from curlshot.synthetic.physics import Motion, simulate
from curlshot.synthetic.scene import Cut, Graphic, Scene
from curlshot.synthetic.stones import draw_stones

Array = NDArray[np.float64]
STILL = 0.05  # px of motion in an exposure that cannot be seen
BLUR_STEP = 0.8  # px of motion between sub-exposures
MOST_STEPS = 9


@dataclass(frozen=True)
class Studio:
    """A scene made ready: its motion, its painted ice per camera, and its grain.

    Attributes
    ----------
    scene, motion : Scene, Motion
        What moves where.
    plates : dict
        Painted ice per camera path.
    supersample : int
        Pictures are rendered so many times larger and averaged down; for strong tilts.
    """

    scene: Scene
    motion: Motion
    supersample: int = 1
    plates: dict[CameraPath, Plate] = field(default_factory=dict)
    grain: dict[tuple[int, int], NDArray[np.float32]] = field(default_factory=dict)

    def plate(self, camera: CameraPath) -> Plate:
        """Return the painted ice, fine and wide enough for this camera."""
        if camera not in self.plates:
            extent, density = _coverage(camera)
            self.plates[camera] = paint_plate(
                self.scene, extent, min(density * self.supersample, 260.0)
            )
        return self.plates[camera]


@cache
def motion_of(scene: Scene, until: float) -> Motion:
    """How the scene's stones move from 0 to `until`, s."""
    starts = [s.start for s in scene.stones]
    if not starts:
        return Motion(np.array([0.0, until]), np.zeros((2, 0, 6)), ())
    return simulate(starts, until, ice=scene.ice, impact=scene.impact)


def expose(
    studio: Studio, camera: CameraPath, t: float, shutter: float, rng: np.random.Generator
) -> Picture:
    """Return the picture (h, w, 3) whose exposure of `shutter` seconds is centred on `t`."""
    scene, light = studio.scene, studio.scene.light
    cut = next((c for c in scene.cuts if c.start - c.dissolve <= t < c.end + c.dissolve), None)
    if cut is None:
        clean = _integrate(studio, camera, t, shutter)
    else:
        weight = _weight(cut, t)
        clean = _elsewhere(studio, camera, cut, t, shutter)
        if weight < 1:
            here = _integrate(studio, camera, t, shutter)
            clean = np.asarray(weight * clean + (1 - weight) * here, np.float32)
    if light.softness > 0:
        cv2.GaussianBlur(clean, (0, 0), light.softness, dst=clean)
    clean = coded(clean, light.power)
    cv2.multiply(clean, _fall_off(camera.size, light.vignette, light.gain), dst=clean)
    picture = _with_grain(studio, clean, light.noise, rng)
    for graphic in scene.graphics:
        _overlay(picture, graphic)
    return picture


def in_cut(scene: Scene, t: float) -> Cut | None:
    """Return the cut whose picture is shown for the most part at time t, if any."""
    return next((c for c in scene.cuts if c.start <= t < c.end and _weight(c, t) > 0.5), None)


def _weight(cut: Cut, t: float) -> float:
    if cut.dissolve == 0:
        return 1.0
    rise = (t - cut.start) / (2 * cut.dissolve) + 0.5
    fall = (cut.end - t) / (2 * cut.dissolve) + 0.5
    return float(np.clip(min(rise, fall), 0, 1))


def _integrate(studio: Studio, camera: CameraPath, t: float, shutter: float) -> NDArray[np.float32]:
    view = camera.at(t)
    sway = _camera_sway(camera, t, shutter)
    travel = _stone_travel(studio, camera, view, t, shutter)
    steps = int(np.clip(np.ceil(max(sway, travel) / BLUR_STEP), 1, MOST_STEPS))
    people_move = bool(studio.scene.people) and steps == 1
    if people_move:
        steps = 2
    total = np.zeros((*camera.size[::-1], 3), np.float32)
    ice = warp(studio.plate(camera), _enlarged(view, studio.supersample)) if sway < STILL else None
    for k in range(steps):
        moment = t + shutter * ((k + 0.5) / steps - 0.5)
        now = _enlarged(view if sway < STILL else camera.at(moment), studio.supersample)
        picture = warp(studio.plate(camera), now) if ice is None else ice.copy()
        states = studio.motion.at(moment)
        draw_stones(picture, now, studio.scene.stones, states, studio.scene.light)
        draw_people(picture, now, studio.scene.people, moment)
        if studio.supersample > 1:
            picture = np.asarray(
                cv2.resize(picture, camera.size, interpolation=cv2.INTER_AREA), np.uint8
            )
        power = studio.scene.light.power
        cv2.accumulate(picture if power == 1 else lit(picture, power), total)
    total /= np.float32(steps)
    return total


def _enlarged(view: View, factor: int) -> View:
    if factor == 1:
        return view
    w, h = view.lens.size
    lens = type(view.lens)((w * factor, h * factor), view.lens.k1, view.lens.k2)
    return View(view.position, view.rotation, view.focal * factor, lens)


def _camera_sway(camera: CameraPath, t: float, shutter: float) -> float:
    first, last = camera.at(t - shutter / 2), camera.at(t + shutter / 2)
    w, h = camera.size
    corners = first.ground(np.array([[0, 0], [w, 0], [0, h], [w, h], [w / 2, h / 2]], float))
    corners = corners[np.isfinite(corners).all(-1)]
    points = np.column_stack([corners, np.zeros(len(corners))])
    return float(np.abs(first.pinhole(points)[0] - last.pinhole(points)[0]).max(initial=0.0))


def _stone_travel(
    studio: Studio, camera: CameraPath, view: View, t: float, shutter: float
) -> float:
    if not studio.scene.stones:
        return 0.0
    speeds = np.hypot(*studio.motion.at(t)[:, 3:5].T)
    return float(speeds.max()) * shutter * view.focal / camera.position[2]


def _elsewhere(
    studio: Studio, camera: CameraPath, cut: Cut, t: float, shutter: float
) -> NDArray[np.float32]:
    if cut.camera is not None:
        return _integrate(studio, cut.camera, t, shutter)
    w, h = camera.size
    rng = np.random.default_rng([studio.scene.seed, round(cut.start * 1000)])
    blobs = rng.uniform(20, 230, (5, 8, 3)).astype(np.float32)
    wide = cv2.resize(blobs, (w + 80, h), interpolation=cv2.INTER_CUBIC)
    pan = int(40 + 35 * np.sin(1.5 * (t - cut.start)))
    return np.clip(wide[:, pan : pan + w], 0, 255)


@lru_cache(maxsize=2)
def _fall_off(size: tuple[int, int], vignette: float, gain: float) -> NDArray[np.float32]:
    w, h = size
    x = (np.arange(w, dtype=np.float32) - (w - 1) / 2) / np.float32(np.hypot(w, h) / 2)
    y = (np.arange(h, dtype=np.float32) - (h - 1) / 2) / np.float32(np.hypot(w, h) / 2)
    falling = np.float32(gain) * (1 - np.float32(vignette) * (x[None] ** 2 + y[:, None] ** 2))
    return np.asarray(cv2.merge([falling] * 3), np.float32)


def _with_grain(
    studio: Studio, clean: NDArray[np.float32], noise: float, rng: np.random.Generator
) -> Picture:
    if noise <= 0:
        return np.asarray(np.clip(clean + 0.5, 0, 255), np.uint8)
    h, w = clean.shape[:2]
    pad = 61
    if (w, h) not in studio.grain:
        studio.grain[w, h] = rng.standard_normal((h + pad, w + pad, 3), dtype=np.float32)
    row, column = rng.integers(0, pad, 2)
    grain = studio.grain[w, h][row : row + h, column : column + w]
    noisy = cv2.scaleAdd(grain, float(noise * rng.choice([-1, 1])), clean)
    lit = cv2.max(noisy, 0.0, dst=noisy)  # type: ignore[call-overload]
    return np.asarray(cv2.convertScaleAbs(lit), np.uint8)


def _overlay(picture: Picture, graphic: Graphic) -> None:
    row, x, y = graphic.row, graphic.x, graphic.y
    thick = max(1, row // 14)
    for team, score, colour in graphic.rows:
        box = picture[y : y + row - 2, x : x + 6 * row]
        box[:] = (0.12 * box + 0.88 * np.array(graphic.ground)).astype(np.uint8)
        cv2.rectangle(picture, (x, y), (x + row // 3, y + row - 3), colour, -1)
        for text, at in ((team, x + row // 2), (score, x + 5 * row)):
            cv2.putText(
                picture, text, (at, y + round(row * 0.74)), cv2.FONT_HERSHEY_DUPLEX, row / 34,
                (240, 240, 240), thick, cv2.LINE_AA,
            )  # fmt: skip
        y += row


def _coverage(camera: CameraPath) -> tuple[Extent, float]:
    """Ice that the camera's path can see, and the finest scale it has there, px/m."""
    w, h = camera.size
    first, last = camera.keys[0].t, camera.keys[-1].t
    edge = np.linspace(0, 1, 7)
    rim = np.concatenate(
        [np.column_stack(p) for p in ((edge, 0 * edge), (edge, 0 * edge + 1), (0 * edge, edge),
                                      (0 * edge + 1, edge))]
    ) * [w - 1, h - 1]  # fmt: skip
    seen, density = [], 0.0
    for t in np.linspace(first, last, 9 if last > first else 1):
        view = camera.at(float(t))
        ground = view.ground(rim)
        seen.append(np.nan_to_num(ground, nan=1e3))
        middle = view.ground(view.lens.centre)
        density = max(density, view.scale(float(middle[0]), float(middle[1])))
    low = np.clip(np.min(np.concatenate(seen), axis=0) - 0.4, [-11, -9], None)
    high = np.clip(np.max(np.concatenate(seen), axis=0) + 0.4, None, [11, 16])
    return Extent(float(low[0]), float(high[0]), float(low[1]), float(high[1])), density * 1.1
