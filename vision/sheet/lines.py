"""The straight lines of the sheet: which way is up, and where the sheet's sides are."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE, SHEET
from curlshot.vision.optics.pose import View, pictured, project, turned
from curlshot.vision.optics.rig import SIDE_L, SIDE_R
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Flags = NDArray[np.bool_]

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

SURE_CROSS, FAINT_CROSS = 6.0, 25.0
"""By how many spreads of all others a cross must stand out to be one, where no sides are seen; and
below how many it is given up for them if it does not run along them: brooms and shadows, too, make
crosses."""

NOTHING = 1e-9
"""Score of a cross below which there is none, as where there is nothing about the tee."""

TURNS = tuple(np.radians(v) for v in (np.arange(-44.0, 45.0, 2.0), np.arange(-2.0, 2.1, 0.25)))
"""Turns that are tried to find the sides' direction: all over, then about the best; the step at a
side is lost when it is 3° aside."""

DENSELY, SPARSELY, LEAST_ALONG = 0.1, 0.25, 0.75
"""How far apart the sides are sampled, m, and where turns are tried all over; and how much of one
must be in the picture."""

LEAST_BACK = 5.0
"""Grey levels by which the back line must stand out to tell the end at which it is."""

QUARTER = np.pi / 2

STEP = np.radians(0.25)
"""Angle from one ray about the tee to the next."""

QUARTER_STEPS = 360
"""Rays in a quarter turn."""

NEAR = 6
"""Rays on either side of an axis among which its line is looked for."""

ALONG = np.arange(0.2, 2.6, 0.04)
"""Where the rays are sampled, m from the tee."""

ON, BESIDE = (-0.015, 0.0, 0.015), (-0.055, 0.055)
"""Where a line, if there is one along a ray, and the ice beside it are sampled, m aside."""

PARTS = np.searchsorted(
    ALONG, (0.0, HOUSE.four_foot, HOUSE.eight_foot, HOUSE.twelve_foot, SHEET.half_width_min)
)
"""Where each part of a ray begins: a line may be lighter than one paint and darker than another;
the last part lies beyond the end of the tee line."""

LEAST_IN_PART = 5
"""Samples of a part that must be in the picture."""


def upright(image: Image, view: View, rig: Array) -> tuple[View, Array]:
    """Turn the ice's axes onto the centre and tee lines, if these can be seen.

    Of several crosses that stand out, the sheet's sides tell the true one: they run along it. If
    none does, and none is clear, they tell the direction themselves. They also tell the centre
    line from the tee line where the camera stands beside the sheet; y then points away from the
    back line, or where that is not seen to the end of the sheet that is higher in the picture.
    """
    view, rig = y_up(view, rig, (image.shape[1], image.shape[0]))
    turn, clear, along = _best_cross(image, view, rig)
    by_sides, strength = _along_sides(image, view, rig) if clear < FAINT_CROSS else (0.0, 0.0)
    if strength > along + SURE_STEP:
        turn = by_sides
    elif clear < SURE_CROSS and along < SURE_STEP:
        return view, rig
    level = turned(view, rig, turn)
    sideways = _upwards(image, *turned(*level, QUARTER))
    if _strength(image, *sideways) > _strength(image, *level) + SURE_STEP:
        return turned(*sideways, np.pi) if back_end(image, *sideways) > 0 else sideways
    return level


def back_end(image: Image, view: View, rig: Array) -> int:
    """Tell the end at which the back line is: 1 towards y, −1 towards −y, 0 if that is not seen."""
    below, above = _back_line(image, view, rig), _back_line(image, *turned(view, rig, np.pi))
    if above > 2 * below + LEAST_BACK:
        return 1
    return -1 if below > 2 * above + LEAST_BACK else 0


def y_up(view: View, rig: Array, size: tuple[int, int]) -> tuple[View, Array]:
    """Turn the ice's axes so that y points up in the picture at the tee."""
    small = 0.1 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    tee, *ends = project(small, view.vector, rig, size)
    x, y = np.linalg.solve(np.column_stack([end - tee for end in ends]), [0.0, -1.0])
    return turned(view, rig, float(np.arctan2(y, x)) - QUARTER)


def clearness(image: Image, view: View, rig: Array) -> float:
    """Tell how much more the lines along the axes stand out than any others through the tee."""
    score, middle = _cross_score(image, view, rig), QUARTER_STEPS // 2
    score -= np.median(score)
    others = np.delete(score, np.arange(middle - 2 * NEAR, middle + 2 * NEAR + 1))
    return float(score[middle - NEAR : middle + NEAR + 1].max() / max(others.max(), 1e-9))


def _strength(image: Image, view: View, rig: Array, every: float = DENSELY) -> float:
    """Add up the steps at both sides of the sheet, grey levels, as far as these are straight."""
    return sum(step for _, _, step in _side_steps(image, view, rig, every))


def lesser_side_step(image: Image, view: View, rig: Array) -> float:
    """Tell the step at that side of the sheet at which it is less, grey levels; 0 without both."""
    steps = [step for _, _, step in _side_steps(image, view, rig)]
    return min(steps) if len(steps) == 2 else 0.0


def _best_cross(image: Image, view: View, rig: Array) -> tuple[float, float, float]:
    """Find the turn at which a cross stands out, by the lines or by the sides along it.

    Returns the turn, rad; by how many spreads of all others the cross stands out; and the step at
    both sides, grey levels.
    """
    score = _cross_score(image, view, rig)
    turn = STEP * (np.arange(QUARTER_STEPS) - QUARTER_STEPS // 2)
    noise = float(np.median(score)) + NOTHING
    spread = float(np.median(np.abs(score - noise))) + 0.05 * noise
    score -= noise + 0.02 * noise * np.abs(np.degrees(turn)) / 10
    peaks = _peaks(score, CANDIDATES, apart=6)
    along = np.array([_strength(image, *turned(view, rig, float(turn[top]))) for top in peaks])
    which = int((score[peaks] / max(score.max(), NOTHING) + along / FULL_STEP).argmax())
    best = peaks[which]
    # The middle of the plateau: a line is wider than a step of the angle.
    near = np.arange(best - 3, best + 4)
    height = score[near % QUARTER_STEPS]
    weight = np.maximum(height - 0.5 * height.max(), NOTHING)
    aside = float((weight * near).sum() / weight.sum()) - best
    return float(turn[best]) + STEP * aside, float(score[best] / spread), float(along[which])


def _along_sides(image: Image, view: View, rig: Array) -> tuple[float, float]:
    """Find the turn that lays the axes along the sheet's sides, rad, and the step at these."""
    found = 0.0
    for turns, every in zip(TURNS, (SPARSELY, DENSELY), strict=True):
        steps = [_strength(image, *turned(view, rig, found + turn), every) for turn in turns]
        found += float(turns[int(np.argmax(steps))])
    return found, max(steps)


def _back_line(image: Image, view: View, rig: Array) -> float:
    """Tell how much a line at the back of the house stands out beside the circle, grey levels."""
    size = (image.shape[1], image.shape[0])
    aside = np.arange(0.85, SHEET.half_width_min, 0.03)
    across = np.concatenate([-aside[::-1], aside])
    beside = np.array([BESIDE[0], *ON, BESIDE[1]]) - SHEET.back_line
    ice = np.stack(np.broadcast_arrays(across[:, None], beside), axis=-1)
    place, within = pictured(ice, view.vector, rig, size)
    inside = within.all(1)
    if inside.sum() < LEAST_IN_PART:
        return 0.0
    colour = _colours(image, place[inside])
    line = colour[:, 1:-1].mean(1)
    one, two = line - colour[:, 0], line - colour[:, -1]
    least = np.where(one * two > 0, np.minimum(np.abs(one), np.abs(two)), 0.0)
    return float(np.linalg.norm(np.median(least, axis=0)))


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


def _cross_score(image: Image, view: View, rig: Array) -> Array:
    """How much two lines through the tee stand out, for turns from −45° to 45°."""
    angle = STEP * np.arange(4 * QUARTER_STEPS)
    ice = ALONG[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    size = (image.shape[1], image.shape[0])
    place, inside = pictured(ice, view.vector, rig, size)
    steps, known = _steps(_colours(image, place).astype(np.float32), inside)
    # A line is faint all the way, darker than ice and perhaps lighter than paint; stones, brooms
    # and print are strong here and there. So each ring's part of each ray counts on its own.
    steps = np.where(known[..., None], np.clip(steps, -FAINT, FAINT), 0.0)
    left, right = np.add.reduceat(steps, PARTS, axis=1)
    # A ray beside a line differs from one side only.
    total = np.linalg.norm(
        np.where(left * right > 0, np.minimum(np.abs(left), np.abs(right)), 0.0), axis=-1
    )
    count = np.add.reduceat(known, PARTS, axis=0, dtype=int)
    score = np.where(count > LEAST_IN_PART, total / np.sqrt(np.maximum(count, 1)), 0.0)
    centre, tee = score.sum(0), score[:-1].sum(0)
    ray = np.arange(QUARTER_STEPS) - QUARTER_STEPS // 2
    return np.asarray(
        sum(
            line[(ray + quarter * QUARTER_STEPS) % len(line)]
            for line, quarter in ((tee, 0), (centre, 1), (tee, 2), (centre, 3))
        ),
        np.float64,
    )


def _steps(colour: Floats, inside: Flags) -> tuple[Floats, Flags]:
    """Differences of rays, (places, rays, 3), from what is beside them, (2, places, rays, 3).

    Also tells where they are known.
    """
    steps, known = np.zeros((2, *colour.shape), np.float32), inside.copy()
    reach = int(np.ceil(max(BESIDE) / ALONG[0] / STEP)) + 1
    count = colour.shape[1]

    def aside(around: Floats, distance: float) -> Floats:
        step = int(np.floor(distance))
        first, share = reach + step, np.float32(distance - step)
        return (1 - share) * around[first : first + count] + share * around[
            first + 1 : first + 1 + count
        ]

    for k, distance in enumerate(ALONG):
        around, within = (
            np.concatenate([v[-reach:], v, v[:reach]]) for v in (colour[k], inside[k])
        )
        line = np.mean([aside(around, a / distance / STEP) for a in ON], axis=0)
        for side, a in enumerate(BESIDE):
            steps[side, k] = line - aside(around, a / distance / STEP)
        away = int(np.ceil(max(BESIDE) / distance / STEP))
        for first in (reach - away, reach + away):
            known[k] &= within[first : first + count]
    return steps, known


def sides(image: Image, view: View, rig: Array) -> Array:
    """Look for the sheet's sides, long steps beside the house; the rig with their places.

    A side that is not seen stays where the rig has it.
    """
    found = rig.copy()
    for which, place, step in _side_steps(image, view, rig):
        if step > LEAST_STEP:
            found[which] = place
    return found


def _side_steps(
    image: Image, view: View, rig: Array, every: float = DENSELY
) -> list[tuple[int, float, float]]:
    """Strongest step along each side: which side, its x, m, and its height, grey levels."""
    size = (image.shape[1], image.shape[0])
    along = np.arange(-4.0, 9.0, every)
    found = []
    for which, sign in ((SIDE_L, -1.0), (SIDE_R, 1.0)):
        across = sign * np.arange(SHEET.half_width_min - 0.1, SHEET.half_width_max + 0.1, 0.01)
        ice = np.stack(np.broadcast_arrays(across, along[:, None]), axis=-1)
        place, within = pictured(ice, view.vector, rig, size)
        inside = within.all(1)
        if every * inside.sum() < LEAST_ALONG:
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
