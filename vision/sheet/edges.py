"""Edges between two colours: where the profiles across them cross half way.

Nothing is known about colours. Beside each line the colour on either side is learned: given from
the frames before, else the median along it; a normal counts where both sides look like that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.paint import CIRCLES
from curlshot.vision.sheet.normals import SAMPLES, Normals, Profiles, means_of_ends
from curlshot.vision.sheet.stations import THIN
from curlshot.vision.video.picture import TO_CHROMA

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

LIGHT = 0.75, 1.3
"""How much darker or brighter than usual an edge may be: pictures fall off to their corners, and
lamps shine on the ice."""

FADED = 0.8, 1.25
"""How much darker or brighter than before a whole picture may be and be taken as it is: one that
fades in or out goes beyond that."""

TELL_LIGHT = 60
"""Profiles, about, that tell how bright a whole picture is: the median of more says no more."""

MIN_CONTRAST = 10.0
"""Least difference of the two sides of an edge, grey levels."""

_WORTH = np.array([1.0, 0.25, 0.25])

SHARPNESS = np.asarray(TO_CHROMA.T * _WORTH @ TO_CHROMA, np.float32)
"""How much colours (blue, green, red) tell of where an edge is: most cameras and films keep what
is not brightness (ITU-R BT.601) at half the resolution."""

END = SAMPLES // 4
"""Samples at either end of a profile that show what is beside the edge."""

ENDS = means_of_ends(END)


def steps(profile: Profiles, normals: Normals, known: Array) -> tuple[Profiles, Flags, Array]:
    """Put profiles on the scale from the one side (−0.5) to the other (0.5).

    Parameters
    ----------
    profile : ndarray, shape (..., 3, SAMPLES, n)
        Along the first n of the normals, those across thin lines left out; in one or more
        pictures.
    normals : Normals
    known : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge in the frames before; NaN where not known.

    Returns
    -------
    value : ndarray, shape (..., SAMPLES, n)
    good : ndarray of bool, shape (..., n)
        Whether the profile shows the edge.
    palette : ndarray, shape (..., 9, 2, 3)
        Colours on either side of each kind of edge.
    """
    ends = ENDS @ profile
    line = normals.line[: ends.shape[-1]]
    kinds = {kind: part for kind, part in normals.kinds.items() if kind not in THIN}
    sides = known.T.astype(np.float32)[..., line]
    new = [part for kind, part in kinds.items() if not np.isfinite(known[kind, 0, 0])]
    if len(new) < len(kinds):
        sides = sides * _faded(ends, sides, line)[..., None, None, None]
    if new:
        sides = np.broadcast_to(sides, ends.shape).copy()
    for part in new:
        middle = (part.stop - part.start) // 2
        sides[..., part] = np.sort(ends[..., part], axis=-1)[..., [middle]]
    difference = sides[..., 1, :] - sides[..., 0, :]
    square = (difference * difference).sum(-2)
    # Each side looks like the line's own two colours; light may vary, hue may not.
    tolerance = np.maximum(0.25 * square, 12.0**2)
    # Lit alike, both are brighter or darker than usual by one factor; beside straight lines there
    # are edges of other things that differ by no more.
    light = (ends * sides).sum((-3, -2)) / np.maximum((sides * sides).sum((-3, -2)), 1.0)
    light = np.where(line < CIRCLES, np.clip(light, *LIGHT), 1.0)
    off = ends - light[..., None, None, :] * sides
    good = ((off * off).sum(-3) < tolerance[..., None, :]).all(-2)
    axis = SHARPNESS @ difference
    axis /= np.maximum((axis * difference).sum(-2, keepdims=True), 1.0)
    axis = axis[..., None, :]
    low, high = np.moveaxis((ends * axis).sum(-3), -2, 0)
    strength = high - low
    good &= (strength > 0.5) & (strength < 1.6) & (square > MIN_CONTRAST**2)
    value = (profile * axis).sum(-3) - 0.5 * (low + high)[..., None, :]
    palette = np.full((*good.shape[:-1], *known.shape), np.nan)
    if kinds:
        starts = np.array([part.start for part in kinds.values()])
        count = np.add.reduceat(good, starts, axis=-1, dtype=np.int64)[..., None, None, :]
        total = np.add.reduceat(ends * good[..., None, None, :], starts, axis=-1)
        mean = np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)
        palette[..., line[starts], :, :] = np.moveaxis(mean, (-1, -2, -3), (-3, -2, -1))
    return value, good, palette


def _faded(ends: Profiles, sides: Profiles, line: NDArray[np.int64]) -> Profiles:
    """Tell how much brighter each picture is than its circles' sides were, where it has faded."""
    known = np.flatnonzero(np.isfinite(sides[0, 0]) & (line < CIRCLES))
    if not len(known):
        return np.ones(ends.shape[:-3], np.float32)
    known = known[:: max(len(known) // TELL_LIGHT, 1)]
    before, now = sides[..., known], ends[..., known]
    light = (now * before).sum((-3, -2)) / np.maximum((before * before).sum((-3, -2)), 1.0)
    usual = np.median(light, axis=-1)
    return np.where((usual > FADED[0]) & (usual < FADED[1]), np.float32(1), usual)


def crossings(value: Profiles) -> tuple[Array, Array, Flags]:
    """Find where profiles rise through 0, in samples, how steeply, and whether they do.

    Parameters
    ----------
    value : ndarray, shape (..., SAMPLES, n)

    Returns
    -------
    sample, rise, good : ndarray, shape (..., n)
        Place, rise from one sample to the next, and whether there is one.
    """
    below = value[..., 1:-1, :] < 0
    rising = below[..., :-1, :] > below[..., 1:, :]
    # Of several crossings the steepest is the edge, the others are noise or print.
    slope = (value[..., 3:, :] - value[..., :-3, :]) * rising
    best = slope.argmax(-2)[..., None, :] + 1
    low, high = (np.take_along_axis(value, at, -2)[..., 0, :] for at in (best, best + 1))
    best = best[..., 0, :]
    good = (low < 0) & (high >= 0)
    rise = np.where(good, high - low, 1.0)
    return np.asarray(best - (low / rise), np.float64), rise, good
