"""The straight lines of the sheet: which way is up, and where the sheet's sides are."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE, SHEET
from vision.pose import SIDE_L, SIDE_R, View, project, turned

Array = NDArray[np.float64]
Image = NDArray[np.uint8]


FAINT = 6.0
"""Grey levels beyond which a stronger contrast says no more about a thin line."""

CANDIDATES = 4
"""Crosses that are tried against the sheet's sides."""

LEAST_STEP = 25.0
"""Least step at a side of the sheet, grey levels."""

FULL_STEP = 400.0
"""Step of both sides together that weighs as much as the best cross, grey levels."""

SURE_STEP = 150.0
"""Step of both sides together that is proof of the direction even if the cross is faint."""

QUARTER = np.pi / 2

RINGS = (HOUSE.four_foot, HOUSE.eight_foot, HOUSE.twelve_foot)


def upright(image: Image, view: View, rig: Array) -> tuple[View, Array]:
    """Turn the ice's axes onto the centre and tee lines, if these can be seen.

    Of several crosses that stand out, the sheet's sides tell the true one: they run along it.
    They also tell the centre line from the tee line where the camera stands beside the sheet;
    y then points to the end of the sheet that is higher in the picture.
    """
    coarse = np.radians(np.arange(-45.0, 45.0, 0.25))
    score = _cross_score(image, view, rig, coarse)
    noise = float(np.median(score)) + 1e-9
    spread = float(np.median(np.abs(score - noise))) + 0.05 * noise
    score -= 0.02 * noise * np.abs(np.degrees(coarse)) / 10
    best, best_worth, sure = 0.0, -np.inf, False
    for top in _peaks(score, CANDIDATES, apart=6):
        angle = float(coarse[top])
        strength = _strength(image, *turned(view, rig, angle))
        worth = (score[top] - noise) / (score.max() - noise) + strength / FULL_STEP
        if worth > best_worth:
            best, best_worth = angle, worth
            sure = score[top] - noise > 6 * spread or strength > SURE_STEP
    if not sure:
        return view, rig
    fine = best + np.radians(np.arange(-0.5, 0.5, 0.02))
    # The middle of the plateau: a line is wider than a step of the angle.
    height = _cross_score(image, view, rig, fine)
    weight = np.clip(height - 0.8 * height.max(), 0, None)
    level = turned(view, rig, float((weight * fine).sum() / weight.sum()))
    sideways = _upwards(image, *turned(*level, QUARTER))
    if _strength(image, *sideways) > _strength(image, *level) + SURE_STEP:
        return sideways
    return level


def _strength(image: Image, view: View, rig: Array) -> float:
    """Add up the steps at both sides of the sheet, grey levels."""
    return sum(step for _, _, step in _side_steps(image, view, rig))


def _upwards(image: Image, view: View, rig: Array) -> tuple[View, Array]:
    """Turn the ice's axes by half a turn if y points down in the picture."""
    ends = project(
        np.array([[0.0, -1.0], [0.0, 1.0]]), view.vector, rig, (image.shape[1], image.shape[0])
    )
    return turned(view, rig, np.pi) if ends[1, 1] > ends[0, 1] else (view, rig)


def _peaks(score: Array, count: int, apart: int) -> list[int]:
    """Find the highest values, none within `apart` of a higher one."""
    left, found = score.copy(), []
    for _ in range(count):
        top = int(left.argmax())
        found.append(top)
        left[max(top - apart, 0) : top + apart + 1] = -np.inf
    return found


def _cross_score(image: Image, view: View, rig: Array, angles: Array) -> Array:
    """How much the two lines through the tee stand out, for each angle of the cross."""
    along = np.concatenate([np.arange(0.2, 2.6, 0.04), -np.arange(0.2, 2.6, 0.04)])
    ends = np.where(np.abs(along) < SHEET.half_width_min, along, np.nan)
    # Shape (line, offset, place along it): each line itself and the ice on either side of it.
    across = np.array([-0.015, 0.0, 0.015, -0.055, 0.055])[:, None]
    centre = np.stack([across + 0 * along, along + 0 * across], axis=-1)
    tee = np.stack([ends + 0 * across, across + 0 * along], axis=-1)
    cross = np.stack([centre, tee])
    turn = np.array([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]])
    ice = np.einsum("ija,lokj->aloki", turn, cross)
    size = (image.shape[1], image.shape[0])
    place = project(ice.reshape(-1, 2), view.vector, rig, size).reshape(ice.shape)
    with np.errstate(invalid="ignore"):
        within = (place > 0) & (place < np.array(size) - 1)
    inside = np.asarray(within.all((2, 4)))
    colour = _colours(image, place.reshape(len(angles), -1, 2)).reshape(*ice.shape[:-1], 3)
    ridge = colour[:, :, :3].mean(2) - colour[:, :, 3:].mean(2)
    # A line is faint all the way, darker than ice and perhaps lighter than paint; stones, brooms
    # and print are strong here and there. So each ring's part of each half counts on its own.
    ridge = np.where(inside[..., None], np.clip(ridge, -FAINT, FAINT), 0.0)
    part = np.flatnonzero(np.r_[True, np.diff(np.searchsorted(RINGS, np.abs(along))) != 0])
    total = np.linalg.norm(np.add.reduceat(ridge, part, axis=2), axis=-1)
    count = np.add.reduceat(inside, part, axis=2, dtype=int)
    score = np.where(count > 5, total / np.sqrt(np.maximum(count, 1)), 0.0)
    return np.asarray(score.sum((1, 2)), np.float64)


def sides(image: Image, view: View, rig: Array) -> Array:
    """Look for the sheet's sides, long steps beside the house; the rig with their places.

    A side that is not seen stays where the rig has it.
    """
    found = rig.copy()
    for which, place, step in _side_steps(image, view, rig):
        if step > LEAST_STEP:
            found[which] = place
    return found


def _side_steps(image: Image, view: View, rig: Array) -> list[tuple[int, float, float]]:
    """Strongest step along each side: which side, its x, m, and its height, grey levels."""
    size = (image.shape[1], image.shape[0])
    along = np.arange(-4.0, 9.0, 0.1)
    found = []
    for which, sign in ((SIDE_L, -1.0), (SIDE_R, 1.0)):
        across = sign * np.arange(SHEET.half_width_min - 0.1, SHEET.half_width_max + 0.1, 0.01)
        ice = np.stack(np.broadcast_arrays(across, along[:, None]), axis=-1)
        place = project(ice.reshape(-1, 2), view.vector, rig, size).reshape(ice.shape)
        with np.errstate(invalid="ignore"):
            inside = ((place > 0) & (place < np.array(size) - 1)).all((1, 2))
        if inside.sum() < 8:
            continue
        colour = _colours(image, place[inside])
        step = np.linalg.norm(np.median(colour[:, 4:] - colour[:, :-4], axis=0), axis=-1)
        top = int(step.argmax())
        if 1 < top < len(step) - 2:
            found.append((which, float(across[top + 2]), float(step[top])))
    return found


def _colours(image: Image, place: Array) -> Array:
    """Colours at places (n, m, 2), shape (n, m, 3); black outside the picture."""
    at = np.nan_to_num(place, nan=-9.0).astype(np.float32)
    return np.asarray(cv2.remap(image, at[..., 0], at[..., 1], cv2.INTER_LINEAR), np.float64)
