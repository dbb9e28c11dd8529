"""The cameras of a clip, from what its frames have measured.

Place, distortion and painted radii are fitted jointly to many frames, and every view again with
these held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE
from vision.adjust import Solution, solve
from vision.camera import Camera
from vision.house import SHARING
from vision.place_error import place_error
from vision.pose import CIRCLES, POSITION, R4, R8, Marks, Prior, View, camera

Array = NDArray[np.float64]

JOINT_FRAMES = 30

FRAMES_ALIKE = 4
"""Frames of the joint fit that see the house differently enough to err independently."""

ERROR_FRAMES = 4
"""Frames from which the error of mapped points is worked out."""

CARRY_DRIFT = 0.03
"""How fast a carried view goes astray, m/s on the ice."""


@dataclass(frozen=True)
class HouseTrack:
    """The cameras of a clip.

    Attributes
    ----------
    cameras : tuple of Camera
        One per frame in which the house is known, in order; found is False where carried.
    radii : ndarray, shape (3,)
        Radii of the painted 12-, 8- and 4-ft edges, m; the first is the yardstick.
    radii_sd : ndarray, shape (3,)
    position_sd : ndarray, shape (3,)
        Standard deviation of the camera's place, m.
    warnings : tuple of str
    """

    cameras: tuple[Camera, ...]
    radii: Array
    radii_sd: Array
    position_sd: Array
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class Seen:
    """One followed frame."""

    index: int
    t: float
    view: View
    marks: Marks
    found: bool


def fit_clip(seen: Sequence[Seen], rig: Array, prior: Prior, size: tuple[int, int]) -> HouseTrack:
    """Fit what the frames share, then every view with that held."""
    good = [s for s in seen if s.found]
    chosen = _spread(good)
    joint = solve(
        [s.marks for s in chosen], [s.view for s in chosen], rig, size,
        prior=prior, iterations=25, sharing=SHARING * max(len(chosen) / FRAMES_ALIKE, 1),
    )  # fmt: skip
    fits = {
        s.index: solve([s.marks], [s.view], joint.rig, size, view_sd=(np.inf, np.inf, 0.05, np.inf))
        for s in seen
    }
    few = chosen[:: max(len(chosen) // ERROR_FRAMES, 1)]
    views = [fits[s.index].views[0] for s in few]
    error = place_error([s.marks for s in few], views, joint.rig, joint.rig_cov, size)
    found_at = np.array([s.t for s in good])
    cameras = [
        camera(
            fits[s.index].views[0],
            joint.rig,
            size,
            frame=s.index,
            t=s.t,
            rms_px=float(fits[s.index].rms[0]) if s.found else float("nan"),
            found=s.found,
            # Frames before the first find were carried too: backwards.
            place_error=error.grown(CARRY_DRIFT * float(np.abs(found_at - s.t).min())),
        )
        for s in seen
    ]
    sd = np.sqrt(np.diag(joint.rig_cov))
    return HouseTrack(
        tuple(cameras),
        np.array([HOUSE.twelve_foot, joint.rig[R8], joint.rig[R4]]),
        np.array([0.0, sd[R8], sd[R4]]),
        sd[POSITION],
        _warnings(seen, prior, joint),
    )


def _spread(seen: Sequence[Seen]) -> list[Seen]:
    """Frames for the joint fit, spread over the clip."""
    at = np.unique(np.round(np.linspace(0, len(seen) - 1, JOINT_FRAMES)).astype(int))
    return [seen[i] for i in at]


def _warnings(seen: Sequence[Seen], prior: Prior, joint: Solution) -> tuple[str, ...]:
    found = []
    lost = sum(not s.found for s in seen)
    if lost:
        found.append(
            f"{lost} of {len(seen)} frames do not show the rings; there the camera is"
            " carried by the motion of the picture"
        )
    height_sd = float(np.sqrt(joint.rig_cov[2, 2]))
    if height_sd > 0.7 * prior.sd[2]:
        found.append(
            f"the camera's height cannot be told from this view ({joint.rig[2]:.1f} ±"
            f" {height_sd:.1f} m assumed); stones far from the picture's middle may be"
            " centimetres off"
        )
    if not (np.concatenate([s.marks.line for s in seen]) >= CIRCLES).any():
        found.append("neither centre line nor tee line is seen; y is up in the picture")
    return tuple(found)
