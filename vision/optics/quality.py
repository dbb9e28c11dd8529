"""Quality of each frame's camera, from 0 to 1, and warnings about the cameras of a clip."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.paint import CIRCLES, ice_frame, measures
from curlshot.vision.optics.pose import View, project
from curlshot.vision.optics.rig import POSITION, Prior

Array = NDArray[np.float64]
Index = NDArray[np.int64]

POOR, POOR_SHARE = 0.4, 0.1
"""Quality below which a frame is poor, and the share of such frames that is worth a warning."""

POOR_OFF = 0.005
"""How far off edges are, m, where a fit is half as good as it might be: of clips with truth 0.4 to
3.5 mm, ragged paint and all, whatever the size of their pictures; of one bent by 10 mm 7 mm."""

UNTOLD = 0.7
"""Share of its prior standard deviation above which the camera's height counts as assumed."""

AT_ODDS = 2.0
"""Standard deviations from which on a view has the camera elsewhere than somebody says."""

ARC = np.radians(15.0)
"""Length of a piece of a circle that counts as explained where one of its edges is, rad."""

_ARCS = np.arange(-np.pi + ARC / 2, np.pi, ARC)
_ON_CIRCLE = np.repeat(np.arange(CIRCLES), len(_ARCS))
_FOOT, _WAY = ice_frame(_ON_CIRCLE, np.tile(_ARCS, CIRCLES))


def edges_off(residual: Array, paint: Array, sd: Array) -> float:
    """Weighted r.m.s. distance of the circles' edges from where a nominal house has them, m.

    Offsets of the paint count, for what the fit took for paint may be lens distortion. Edges have
    the weights of the fit: one circle may be too ragged, or too faint, to place the camera.

    Parameters
    ----------
    residual, paint, sd : ndarray, shape (n,)
        What the camera and the paint leave of each, how far the paint under it is aside, and its
        standard deviation, m.

    Returns
    -------
    float
        NaN where there are no edges.
    """
    worth = sd**-2.0
    total = float(worth.sum())
    return math.sqrt(float(worth @ (residual**2 + paint**2)) / total) if total else math.nan


def quality(pieces: Index, off: float, view: View, rig: Array, size: tuple[int, int]) -> float:
    """Quality of a frame's camera, from 0 to 1.

    Parameters
    ----------
    pieces : ndarray of int
        Pieces of the circles, `ARC` long, that it explains
        (`curlshot.vision.optics.shared.piece_of`), as often as may be.
    off : float
        How far their edges are off (`edges_off`), m; NaN where the camera is carried.
    view, rig, size
        The camera.

    Returns
    -------
    float
        The share of the circles' pieces in the picture that is explained, less where edges are far
        off; 0 where carried.
    """
    if math.isnan(off):
        return 0.0
    places = _FOOT + _WAY * measures(rig)[_ON_CIRCLE]
    x, y = project(places.T, view.vector, rig, size).T
    w, h = size
    shown = int(((x > 0) & (y > 0) & (x < w - 1) & (y < h - 1)).sum())
    explained = min(len(set(pieces.tolist())) / max(shown, 1), 1.0)
    return explained / (1 + (off / POOR_OFF) ** 2)


def warnings(
    cameras: Sequence[Camera], height: float, sd: float, prior: Prior, lined: bool, cropped: bool
) -> tuple[str, ...]:
    """Tell what a person should know before trusting the cameras of a clip.

    Parameters
    ----------
    cameras : sequence of Camera
    height, sd : float
        Of the camera above the ice as found, and its standard deviation, m.
    prior : Prior
        What was known of it beforehand.
    lined : bool
        Whether a line was seen beside the circles.
    cropped : bool
        Whether pictures seem to be cropped off their middle, or stretched.
    """
    found = []
    poor = [c.frame for c in cameras if c.found and c.quality < POOR]
    if len(poor) > POOR_SHARE * len(cameras):
        found.append(
            f"in {len(poor)} of {len(cameras)} frames ({poor[0]} to {poor[-1]}) the camera model"
            " explains little of the rings; view the contact sheet of `check` before you trust it"
        )
    carried = sum(not c.found for c in cameras)
    if carried:
        found.append(
            f"{carried} of {len(cameras)} frames do not show the rings; there the camera is"
            " tracked by other features of the ice"
        )
    if cropped:
        found.append(
            "the frame seems to be cropped off-centre or stretched (or the camera is over 20 m"
            " high, or held by hand): places may be centimetres wrong; use the clip as it was"
            " recorded"
        )
    before, off = float(prior.sd[POSITION][2]), height - float(prior.mean[POSITION][2])
    if prior.height is not None and abs(off) > AT_ODDS * before:
        found.append(
            f"the given camera height, {prior.height:g} m, does not fit this view; the view"
            f" suggests a {'higher' if off > 0 else 'lower'} camera; places may be centimetres"
            " wrong"
        )
    if prior.height is None and sd > UNTOLD * before:
        found.append(
            f"the camera height is not identifiable from this view ({height:.1f} ± {sd:.1f} m"
            " assumed); stones far from the centre of the frame may be centimetres wrong; give"
            " `camera_height` if you know it"
        )
    if not lined:
        found.append(
            "neither centre line nor tee line is visible; y is taken to be up in the frame"
        )
    return tuple(found)
