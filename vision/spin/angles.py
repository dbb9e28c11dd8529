"""Angles of a stone in clips of any length: part by part, each registered to the first by its mean.

The pictures of a cap take memory while its angle is told (`vision.spin.handle`). So no more than
a thousand are looked at together: a stone that moves shows fewer as a rule, one at rest as many
in minutes. Of a longer track each part is measured against its own mean picture, and that against
the first part's: errors do not add up from part to part.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, pi

import numpy as np

from vision.film.shelf import Kept
from vision.spin.align import TOGETHER, Array, Complex, turned
from vision.spin.facing import angles_between
from vision.spin.handle import handle_angles

MOST = 1000
"""Pictures that are looked at together at most: some 20 MB. Parts that are seen in different slants
do not fit each other quite, by what a handle that rises looks turned by in one and the other; so a
stone is in one part as long as it is under way, at 60 frames a second as well."""


def angles_in_parts(
    times: Array,
    spectra: Sequence[Kept[Complex] | None],
    radii: Array,
    sd_centre: Array,
    most: int = MOST,
    slants: Array | None = None,
) -> tuple[Array, Array]:
    """Angle of one stone in every frame; see `vision.spin.handle.handle_angles`.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    spectra : sequence of Kept of ndarray or None
        Read when their part is due.
    radii, sd_centre : ndarray
        As for `vision.spin.handle.handle_angles`.
    most : int
        Pictures that are looked at together at most.
    slants : ndarray, shape (n, 2), optional
        As for `vision.spin.handle.handle_angles`.

    Returns
    -------
    theta, sd : ndarray, shape (n,)
        rad; NaN where it cannot be told.
    """
    theta, sd = np.full(len(times), np.nan), np.full(len(times), np.nan)
    kept = {index: item for index, item in enumerate(spectra) if item is not None}
    if len(kept) <= most:
        rows = [*kept]
        pictures = [item.get() for item in kept.values()]
        of = None if slants is None else slants[rows]
        theta[rows], sd[rows] = handle_angles(times[rows], pictures, radii, sd_centre[rows], of)
        return theta, sd
    first: Complex | None = None
    last = -1
    for part in np.array_split(np.array([*kept], np.intp), ceil(len(kept) / most)):
        each = [kept[index] for index in part.tolist()]
        of = None if slants is None else slants[part]
        angle, sd[part], mean = _part(times[part], each, radii, sd_centre[part], of)
        if mean is None:
            continue
        told = np.flatnonzero(np.isfinite(angle))
        if first is None:
            first = mean
        else:
            aside = float(angles_between(first, mean[None], np.zeros(1), pi)[0][0])
            turns = (theta[last] - angle[told[0]] - aside) / (2 * pi)
            angle += aside + 2 * pi * round(float(turns))
        theta[part], last = angle, int(part[told[-1]])
    return theta, sd


def _part(
    times: Array,
    kept: Sequence[Kept[Complex]],
    radii: Array,
    sd_centre: Array,
    slants: Array | None,
) -> tuple[Array, Array, Complex | None]:
    """Angles of pictures, their errors, and the mean picture turned back; None if none is told."""
    pictures = [item.get() for item in kept]
    theta, sd = handle_angles(times, pictures, radii, sd_centre, slants)
    told = np.flatnonzero(np.isfinite(theta)).tolist()
    if not told:
        return theta, sd, None
    total = np.zeros_like(pictures[0])
    for begin in range(0, len(told), TOGETHER):
        some = told[begin : begin + TOGETHER]
        total += turned(np.array([pictures[k] for k in some]), -theta[some]).sum(0)
    return theta, sd, np.asarray(total / np.float32(len(told)), np.complex64)
