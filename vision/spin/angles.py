"""Angles of a stone in clips of any length: part by part, each registered to the first by its mean.

The pictures of a cap take memory while its angle is told (`curlshot.vision.spin.handle`). So no
more than a thousand are looked at together: a stone that moves shows fewer as a rule, one at rest
as many in minutes. Of a longer track each part is measured against its own mean picture, and that
against the first part's: errors do not add up from part to part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil, pi

import numpy as np

from curlshot.vision.spin.align import TOGETHER, Array, Complex, turned
from curlshot.vision.spin.facing import angles_between
from curlshot.vision.spin.handle import HandleAngles, handle_angles
from curlshot.vision.spin.pitch import of_axes
from curlshot.vision.video.disk_cache import Cached

MOST = 1000
"""Pictures that are looked at together at most: some 20 MB. Parts that are seen in different slants
do not fit each other quite, by what a handle that rises looks turned by in one and the other; so a
stone is in one part as long as it is under way, at 60 frames a second as well."""


def angles_in_parts(
    times: Array,
    spectra: Sequence[Cached[Complex] | None],
    radii: Array,
    sd_centre: Array,
    most: int = MOST,
    slants: Array | None = None,
    height: int | None = None,
) -> HandleAngles:
    """Angle of one stone in every frame; see `curlshot.vision.spin.handle.handle_angles`.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    spectra : sequence of Cached of ndarray or None
        Read when their part is due.
    radii, sd_centre : ndarray
        As for `curlshot.vision.spin.handle.handle_angles`.
    most : int
        Pictures that are looked at together at most.
    slants : ndarray, shape (n, 2), optional
        As for `curlshot.vision.spin.handle.handle_angles`.
    height : int, optional
        Which of those at which caps were unrolled to go by; what the stone itself tells if not
        given.

    Returns
    -------
    HandleAngles
    """
    theta, sd = np.full(len(times), np.nan), np.full(len(times), np.nan)
    rise = np.zeros((len(times), 2))
    kept = {index: item for index, item in enumerate(spectra) if item is not None}
    rings = slice(None) if height is None else slice(height * len(radii), (height + 1) * len(radii))
    if len(kept) <= most:
        rows = [*kept]
        pictures = [item.get()[:, rings] for item in kept.values()]
        of = None if slants is None else slants[rows]
        told = handle_angles(times[rows], pictures, radii, sd_centre[rows], of)
        theta[rows], sd[rows], rise[rows] = told.theta, told.sd, told.rise
        return replace(told, theta=theta, sd=sd, rise=rise)
    first: Complex | None = None
    last = -1
    parts: list[HandleAngles] = []
    for part in np.array_split(np.array([*kept], np.intp), ceil(len(kept) / most)):
        each = [kept[index] for index in part.tolist()]
        of = None if slants is None else slants[part]
        told, mean = _part(times[part], each, rings, radii, sd_centre[part], of)
        parts.append(told)
        if mean is None:
            continue
        sd[part], rise[part], angle = told.sd, told.rise, told.theta
        seen = np.flatnonzero(np.isfinite(angle))
        if first is None:
            first = mean
        else:
            aside = float(angles_between(first, mean[None], np.zeros(1), pi)[0][0])
            turns = (theta[last] - angle[seen[0]] - aside) / (2 * pi)
            angle = angle + aside + 2 * pi * round(float(turns))
            rise[part] = of_axes(told.rise, aside)  # it is one cap
        theta[part], last = angle, int(part[seen[-1]])
    unlike = np.sum([told.unlike for told in parts], axis=0)
    heights = frozenset().union(*(told.heights for told in parts))
    return HandleAngles(theta, sd, rise, unlike, heights)


def _part(
    times: Array,
    kept: Sequence[Cached[Complex]],
    rings: slice,
    radii: Array,
    sd_centre: Array,
    slants: Array | None,
) -> tuple[HandleAngles, Complex | None]:
    """Angles of pictures, and the mean picture turned back; None if none is told."""
    pictures = [item.get()[:, rings] for item in kept]
    told = handle_angles(times, pictures, radii, sd_centre, slants)
    seen = np.flatnonzero(np.isfinite(told.theta)).tolist()
    if not seen:
        return told, None
    total = np.zeros_like(pictures[0])
    for begin in range(0, len(seen), TOGETHER):
        some = seen[begin : begin + TOGETHER]
        total += turned(np.array([pictures[k] for k in some]), -told.theta[some]).sum(0)
    return told, np.asarray(total / np.float32(len(seen)), np.complex64)
