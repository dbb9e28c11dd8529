"""Edges between two colours: where the profiles across them cross half way.

Nothing is known about colours. Beside each line the colour on either side is learned: given from
the frames before, else the median along it; a normal counts where both sides look like that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vision.normals import SAMPLES, THIN, Normals, Profiles

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

MIN_CONTRAST = 10.0
"""Least difference of the two sides of an edge, grey levels."""

_TO_CHROMA = np.array([[0.114, 0.587, 0.299], [0.5, -0.331, -0.169], [-0.081, -0.419, 0.5]])
_WORTH = np.array([1.0, 0.25, 0.25])

SHARPNESS = np.asarray(_TO_CHROMA.T * _WORTH @ _TO_CHROMA, np.float32)
"""How much colours (blue, green, red) tell of where an edge is: most cameras and films keep what
is not brightness (ITU-R BT.601) at half the resolution."""

_END = SAMPLES // 4
_ENDS = np.zeros((2, SAMPLES), np.float32)
_ENDS[0, :_END] = _ENDS[1, -_END:] = 1 / _END


def steps(profile: Profiles, normals: Normals, known: Array) -> tuple[Profiles, Flags, Array]:
    """Put profiles on the scale from the one side (−0.5) to the other (0.5).

    Parameters
    ----------
    profile : ndarray, shape (3, SAMPLES, n)
        Along the first n of the normals, those across thin lines left out.
    normals : Normals
    known : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge in the frames before; NaN where not known.

    Returns
    -------
    value : ndarray, shape (SAMPLES, n)
    good : ndarray of bool, shape (n,)
        Whether the profile shows the edge.
    palette : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge.
    """
    ends = _ENDS @ profile
    line = normals.line[: ends.shape[2]]
    kinds = {kind: part for kind, part in normals.kinds.items() if kind not in THIN}
    sides = known.T.astype(np.float32)[..., line]
    for kind, part in kinds.items():
        if not np.isfinite(known[kind, 0, 0]):
            sides[..., part] = np.sort(ends[..., part], axis=2)[
                ..., [(part.stop - part.start) // 2]
            ]
    difference = sides[:, 1] - sides[:, 0]
    square = (difference * difference).sum(0)
    # Each side looks like the line's own two colours; light may vary, hue may not.
    tolerance = np.maximum(0.25 * square, 12.0**2)
    off = ends - sides
    good = ((off * off).sum(0) < tolerance).all(0)
    axis = SHARPNESS @ difference
    axis /= np.maximum((axis * difference).sum(0), 1.0)
    low, high = (ends * axis[:, None]).sum(0)
    strength = high - low
    good &= (strength > 0.5) & (strength < 1.6) & (square > MIN_CONTRAST**2)
    value = (profile * axis[:, None]).sum(0) - 0.5 * (low + high)
    palette = np.full(known.shape, np.nan)
    if kinds:
        starts = np.array([part.start for part in kinds.values()])
        count = np.add.reduceat(good, starts, dtype=np.int64)
        total = np.add.reduceat(ends * good, starts, axis=2)
        seen = count > 0
        palette[line[starts[seen]]] = (total[..., seen] / count[seen]).T
    return value, good, palette


def crossings(value: Profiles) -> tuple[Array, Flags]:
    """Find where profiles rise through 0, in samples, and whether they do."""
    below = value[1:-1] < 0
    rising = below[:-1] > below[1:]
    # Of several crossings the steepest is the edge, the others are noise or print.
    slope = (value[3:] - value[:-3]) * rising
    best = slope.argmax(0) + 1
    column = np.arange(value.shape[1])
    good = slope[best - 1, column] > 0
    low, high = value[best, column], value[best + 1, column]
    return best + (low / np.where(good, low - high, 1.0)).astype(np.float64), good
