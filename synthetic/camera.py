"""A pinhole camera above the sheet that pans, tilts, rolls, zooms and shakes.

World: metres, origin at the tee, z up. Pixel (0, 0) is the middle of the top-left pixel.
Distortion: with c = ((w − 1)/2, (h − 1)/2), R = √(w² + h²)/2 and q = (u − c)/R the picture
shows the undistorted point u at c + R q (1 + k1 |q|² + k2 |q|⁴).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Lens:
    """Radial distortion of a picture of a given size (width, height).

    Raises
    ------
    ValueError
        Where the distortion folds back before it has filled the picture's corners.
    """

    size: tuple[int, int]
    k1: float = 0.0
    k2: float = 0.0

    def __post_init__(self) -> None:
        r2 = np.linspace(0, 2, 200) ** 2
        shown = np.sqrt(r2) * (1 + r2 * (self.k1 + r2 * self.k2))
        falls = np.flatnonzero(np.diff(shown) <= 0)
        if len(falls) and shown[falls[0]] < 1:
            raise ValueError(f"k1 = {self.k1}, k2 = {self.k2} do not fill the picture's corners")

    @property
    def centre(self) -> Array:
        """Middle of the picture, px."""
        return np.array([(self.size[0] - 1) / 2, (self.size[1] - 1) / 2])

    def distort(self, u: ArrayLike) -> Array:
        """Undistorted to picture pixels, shape (..., 2)."""
        q, unit = self._unit(u)
        r2 = (q[..., 0] ** 2 + q[..., 1] ** 2)[..., None]
        return np.asarray(self.centre + unit * q * (1 + r2 * (self.k1 + r2 * self.k2)))

    def undistort(self, p: ArrayLike) -> Array:
        """Picture to undistorted pixels, shape (..., 2)."""
        if not (self.k1 or self.k2):
            return np.asarray(p, float)
        d, unit = self._unit(p)
        seen = d[..., 0] ** 2 + d[..., 1] ** 2
        r2 = seen.copy()  # solve g(r²) = r² (1 + k1 r² + k2 r⁴)² = |d|² by Newton's method
        for _ in range(12):
            stretch = 1 + r2 * (self.k1 + r2 * self.k2)
            slope = stretch * (stretch + 2 * r2 * (self.k1 + 2 * r2 * self.k2))
            step = (r2 * stretch * stretch - seen) / slope
            r2 -= step
            if np.abs(step).max(initial=0.0) < 1e-13:
                break
        return np.asarray(self.centre + unit * d / (1 + r2 * (self.k1 + r2 * self.k2))[..., None])

    def _unit(self, p: ArrayLike) -> tuple[Array, float]:
        unit = float(np.hypot(*self.size)) / 2
        return (np.asarray(p, float) - self.centre) / unit, unit


@dataclass(frozen=True)
class View:
    """The camera at one instant.

    Attributes
    ----------
    position : ndarray, shape (3,)
        Centre of projection, m.
    rotation : ndarray, shape (3, 3)
        World to camera axes (right, down, forward).
    focal : float
        Focal length, px.
    lens : Lens
        Distortion and size of the picture.
    """

    position: Array
    rotation: Array
    focal: float
    lens: Lens

    @property
    def homography(self) -> Array:
        """Ice metres (x, y, 1) to undistorted pixels, h33 = 1."""
        h = self._intrinsic @ np.column_stack(
            [self.rotation[:, 0], self.rotation[:, 1], -self.rotation @ self.position]
        )
        return np.asarray(h / h[2, 2])

    @property
    def _intrinsic(self) -> Array:
        cx, cy = self.lens.centre
        return np.array([[self.focal, 0, cx], [0, self.focal, cy], [0, 0, 1]])

    def pinhole(self, points: ArrayLike) -> tuple[Array, Array]:
        """Undistorted pixels (..., 2) and depths (...) of world points (..., 3)."""
        inside = (np.asarray(points, float) - self.position) @ self.rotation.T
        depth = inside[..., 2]
        return self.lens.centre + self.focal * inside[..., :2] / depth[..., None], depth

    def project(self, points: ArrayLike) -> Array:
        """Picture pixels (..., 2) of world points (..., 3)."""
        return self.lens.distort(self.pinhole(points)[0])

    def ground(self, pixels: ArrayLike) -> Array:
        """Ice points (..., 2), m, seen at picture pixels; NaN above the horizon."""
        offset = (self.lens.undistort(pixels) - self.lens.centre) / self.focal
        right, down, ahead = self.rotation
        u, v = offset[..., 0], offset[..., 1]
        rise = u * right[2] + v * down[2] + ahead[2]
        along = self.position[2] / np.where(rise < -1e-6, -rise, np.nan)
        x, y = (self.position[k] + (u * right[k] + v * down[k] + ahead[k]) * along for k in (0, 1))
        return np.stack([x, y], axis=-1)

    def scale(self, x: float, y: float) -> float:
        """Pixels per metre at an ice point: root of the Jacobian's determinant."""
        step = 1e-3
        p = self.project([[x, y, 0], [x + step, y, 0], [x, y + step, 0]])
        return float(np.sqrt(abs(np.linalg.det((p[1:] - p[0]) / step))))


@dataclass(frozen=True)
class Key:
    """Where the camera looks at time t.

    (x, y) is the ice point in the middle of the picture, m; `px_per_m` the scale there across
    the line of sight; `roll` in rad, counter-clockwise turn of the camera; k1, k2 the lens.
    """

    t: float
    x: float
    y: float
    px_per_m: float
    roll: float = 0.0
    k1: float = 0.0
    k2: float = 0.0


@dataclass(frozen=True)
class CameraPath:
    """A camera on a fixed mount: keys joined smoothly, with a shake on top.

    Attributes
    ----------
    size : tuple of int
        Width and height of the picture, px.
    position : tuple of float
        Where the camera hangs, m.
    keys : tuple of Key
        In order of time; before the first and after the last the camera stands.
    shake : float
        Root mean square of the shake in the picture, px.
    shake_phase : float
        Picks one shake of many, rad.
    """

    size: tuple[int, int]
    position: tuple[float, float, float]
    keys: tuple[Key, ...]
    shake: float = 0.0
    shake_phase: float = 0.0

    def at(self, t: float) -> View:
        """Return the view at time t, s."""
        x, y, px_per_m, roll, k1, k2 = self._interpolate(t)
        eye = np.array(self.position)
        line = np.array([x, y, 0.0]) - eye
        distance = float(np.linalg.norm(line))
        forward = line / distance
        right = np.cross(forward, (0.0, 1.0, 0.0))
        right /= np.linalg.norm(right)
        axes = np.stack([right, np.cross(forward, right), forward])
        focal = px_per_m * distance
        across, down, twist = self._shaking(t) / focal
        turn = _about_z(roll + twist) @ _about_y(across) @ _about_x(down)
        return View(eye, turn @ axes, focal, Lens(self.size, k1, k2))

    def _interpolate(self, t: float) -> Array:
        rows = np.array([(k.x, k.y, k.px_per_m, k.roll, k.k1, k.k2) for k in self.keys])
        if len(rows) == 1:
            return np.asarray(rows[0])
        times = [k.t for k in self.keys]
        smooth = PchipInterpolator(times, rows)
        return np.asarray(smooth(min(max(t, times[0]), times[-1])))

    def _shaking(self, t: float) -> Array:
        rates = np.array([1.3, 2.9, 5.3, 8.9])
        weights = np.array([0.75, 0.5, 0.35, 0.25])
        phase = self.shake_phase * np.arange(1, 5) + np.arange(3)[:, None] * 2.1
        waves = np.sin(2 * np.pi * rates * t + phase) @ weights
        return np.asarray(self.shake * np.sqrt(2) * waves)


def _about_x(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def _about_y(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def _about_z(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def still_camera(
    *,
    size: tuple[int, int] = (1280, 720),
    position: tuple[float, float, float] = (0.0, 0.0, 9.9),
    target: tuple[float, float] = (0.0, 0.3),
    px_per_m: float = 110.0,
    roll: float = 0.0,
    k1: float = 0.0,
    k2: float = 0.0,
    shake: float = 0.0,
) -> CameraPath:
    """Return a camera that does not move (but for its shake)."""
    return CameraPath(size, position, (Key(0.0, *target, px_per_m, roll, k1, k2),), shake)


def tilted_camera(
    tilt: float,
    *,
    size: tuple[int, int] = (1280, 720),
    height: float = 9.0,
    px_per_m: float = 100.0,
    roll: float = 0.0,
    k1: float = 0.0,
    k2: float = 0.0,
) -> CameraPath:
    """Return a still camera that looks at the tee along +y from `tilt` rad off plumb."""
    position = (0.0, -height * float(np.tan(tilt)), height)
    return still_camera(
        size=size, position=position, target=(0.0, 0.0), px_per_m=px_per_m, roll=roll, k1=k1, k2=k2
    )


def broadcast_camera(
    *,
    size: tuple[int, int] = (1280, 720),
    position: tuple[float, float, float] = (-0.11, -0.09, 9.9),
    start: float = 0.0,
    end: float = 6.0,
    target: tuple[tuple[float, float], tuple[float, float]] = ((0.05, 1.7), (0.1, 0.0)),
    px_per_m: tuple[float, float] = (128.0, 98.0),
    roll: tuple[float, float] = (0.012, -0.006),
    k1: tuple[float, float] = (0.0, 0.0),
    k2: tuple[float, float] = (0.0, 0.0),
    shake: float = 0.3,
    shake_phase: float = 0.7,
) -> CameraPath:
    """Return an overhead camera that pans and zooms out with the shot, from `start` to `end`, s."""
    third = (end - start) / 3
    mix = (0.0, 0.45, 0.85, 1.0)

    def between(pair: tuple[float, float], w: float) -> float:
        return pair[0] + w * (pair[1] - pair[0])

    (x0, y0), (x1, y1) = target
    keys = tuple(
        Key(
            start + k * third,
            between((x0, x1), w),
            between((y0, y1), w),
            between(px_per_m, w),
            between(roll, w),
            between(k1, w),
            between(k2, w),
        )
        for k, w in enumerate(mix)
    )
    return CameraPath(size, position, keys, shake, shake_phase)
