"""People with brooms, as bodies of capsules at their true heights."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curlshot.synthetic.camera import View
from curlshot.synthetic.ice import Picture
from curlshot.synthetic.scene import Colour, Person

Array = NDArray[np.float64]
SKIN: Colour = (150, 175, 215)
GLOVE: Colour = (30, 30, 34)
SHAFT: Colour = (60, 60, 66)
BLACK_SHOE: Colour = (24, 24, 26)


@dataclass(frozen=True)
class Limb:
    """A round bar between two points of space, m."""

    start: Array
    end: Array
    radius: float
    colour: Colour


def limbs(person: Person, t: float) -> tuple[Limb, ...]:
    """Return the body at time t, lowest parts first."""
    keys = np.array(person.path)
    x, y, heading = (np.interp(t, keys[:, 0], keys[:, k]) for k in (1, 2, 3))
    c, s = np.cos(heading), np.sin(heading)

    def at(forward: float, left: float, up: float) -> Array:
        return np.array([x + c * forward - s * left, y + s * forward + c * left, up])

    def limb(a: Array, b: Array, radius: float, colour: Colour) -> Limb:
        return Limb(a, b, radius, colour)

    stroke = person.sweep * np.sin(2 * np.pi * person.rate * t)
    head = at(1.05 + 0.3 * stroke, stroke, 0.03)
    low_hand, top_hand = at(0.55, 0.02, 0.75), at(0.25, -0.18, 1.0)
    parts = []
    for side in (-1, 1):
        hip, foot = at(0.0, 0.10 * side, 0.85), at(-0.05 + 0.1 * side, 0.15 * side, 0.05)
        parts.append(limb(foot, foot + np.array([c, s, 0]) * 0.17, 0.05, BLACK_SHOE))
        parts.append(limb(foot, hip, 0.08, person.trousers))
    if person.has_broom:
        across = 0.08 * np.array([-s, c, 0.0])
        parts.append(limb(head - across, head + across, 0.035, person.broom))
        parts.append(limb(head, top_hand, 0.013, SHAFT))
    parts.append(limb(at(0.0, -0.09, 0.9), at(0.0, 0.09, 0.9), 0.14, person.trousers))
    parts.append(limb(at(0.05, 0.0, 1.0), at(0.2, 0.0, 1.25), 0.17, person.shirt))
    parts.append(limb(at(0.22, -0.17, 1.3), at(0.22, 0.17, 1.3), 0.11, person.shirt))
    for left, hand in ((0.19, low_hand), (-0.19, top_hand)):
        parts.append(limb(at(0.22, left, 1.3), hand, 0.055, person.shirt))
        parts.append(limb(hand, hand, 0.05, GLOVE))
    parts.append(limb(at(0.32, 0.0, 1.48), at(0.36, 0.0, 1.46), 0.10, person.hair))
    parts.append(limb(at(0.44, 0.0, 1.44), at(0.45, 0.0, 1.42), 0.04, SKIN))
    return tuple(parts)


def draw_people(picture: Picture, view: View, people: tuple[Person, ...], t: float) -> None:
    """Draw the shadows and bodies of all people at time t into `picture`, in place."""
    bodies = [limbs(person, t) for person in people]
    for body in bodies:
        for window, distance, _, _ in _covered(view, tuple(_shadow(part) for part in body)):
            dark = distance < 7
            keep = 1 - 0.13 * np.clip(0.5 - distance[dark] / 14, 0, 1)
            part = picture[window]
            part[dark] = (part[dark] * keep[:, None] + 0.5).astype(np.uint8)
    for body in bodies:
        for window, distance, radius, limb in _covered(view, body):
            seen = distance < 0.5
            depth, part = distance[seen], picture[window]
            cover = np.clip(0.5 - depth, 0, 1)[:, None]
            inside = np.clip(-depth / np.maximum(radius[seen], 1.0), 0, 1)[:, None]
            tone = np.array(limb.colour, np.float32) * (0.72 + 0.33 * np.sqrt(inside))
            mixed = part[seen] + cover * (tone - part[seen])
            part[seen] = np.clip(mixed + 0.5, 0, 255).astype(np.uint8)


def hidden(view: View, people: tuple[Person, ...], t: float, pixels: Array) -> NDArray[np.bool_]:
    """Whether picture pixels, shape (..., 2), lie under somebody."""
    under = np.zeros(pixels.shape[:-1], bool)
    points = view.lens.undistort(pixels)
    for person in people:
        for part in limbs(person, t):
            found = _on_screen(view, part)
            if found is not None:
                under |= _distance(points[..., 0], points[..., 1], *found)[0] < 0
    return under


def _shadow(part: Limb) -> Limb:
    flat = np.array([1.0, 1.0, 0.0])
    lean = np.array([0.10, 0.14, 0.0])
    start = part.start * flat + lean * part.start[2]
    return Limb(start, part.end * flat + lean * part.end[2], part.radius, part.colour)


def _on_screen(view: View, part: Limb) -> tuple[Array, Array] | None:
    ends, depth = view.pinhole(np.stack([part.start, part.end]))
    if (depth < 0.5).any():
        return None
    return ends, view.focal * part.radius / depth


def _distance(x: Array, y: Array, ends: Array, radii: Array) -> tuple[Array, Array]:
    u, v = x - ends[0, 0], y - ends[0, 1]
    axis_u, axis_v = (ends[1] - ends[0]).tolist()
    squared = max(axis_u * axis_u + axis_v * axis_v, 1e-9)
    along = np.clip((u * axis_u + v * axis_v) / squared, 0, 1)
    radius = radii[0] + along * (radii[1] - radii[0])
    u, v = u - along * axis_u, v - along * axis_v
    return np.sqrt(u * u + v * v) - radius, radius


def _covered(
    view: View, body: tuple[Limb, ...]
) -> Iterator[tuple[tuple[slice, slice], Array, Array, Limb]]:
    """Window, distance to the outline (px), radius (px) of each part in the picture."""
    w, h = view.lens.size
    for part in body:
        found = _on_screen(view, part)
        if found is None:
            continue
        ends, radii = found
        if (np.abs(ends - view.lens.centre) > np.hypot(w, h)).any():
            continue
        pad = float(radii.max()) * 1.15 + 10
        corners = view.lens.distort(np.concatenate([ends - pad, ends + pad]))
        low = np.maximum(np.floor(corners.min(0)).astype(int), 0)
        high = np.minimum(np.ceil(corners.max(0)).astype(int) + 1, [w, h])
        if (low >= high).any():
            continue
        window = slice(int(low[1]), int(high[1])), slice(int(low[0]), int(high[0]))
        x, y = np.arange(low[0], high[0], dtype=float), np.arange(low[1], high[1], dtype=float)
        if view.lens.k1 or view.lens.k2:
            grid = view.lens.undistort(np.stack(np.meshgrid(x, y), axis=-1))
            distance, radius = _distance(grid[..., 0], grid[..., 1], ends, radii)
        else:
            distance, radius = _distance(x[None], y[:, None], ends, radii)
        yield window, distance, radius, part
