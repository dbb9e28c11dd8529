"""Detections that are not of the stone they were taken for, but of what covers it.

A shoulder or a shoe in the colour of the cap that comes over a stone takes its track along. It
shows little of a stone, and goes where no stone goes that none has hit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.association.follow import BIRTHS, Track
from curlshot.vision.association.rows import Rows

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

FAINT = 0.5
"""Share of a stone's usual evidence below which something else may be seen: shoulders show a
third; stones half covered, or on paint of their caps' colour, half and more."""

WINDOW = 0.4
"""Time for which clear detections tell the course of a stone, s, if it is straight."""

STRAIGHT = 0.03
"""How far off a straight course detections may be, r.m.s. per axis, radii: a few millimetres."""

ASTRAY, GROWTH = 0.25, 0.7
"""How far off its course a detection must be, in radii, and by how much more per second from the
clear detections that tell this."""

TINY = 1e-30
"""In place of no speed at all, m²/s²."""

TOUCHED = 3.0
"""One that comes so near to a stone, in radii, may have hit it: they meet at two."""


def without_strays(tracks: Sequence[Track], radius: float) -> list[Track]:
    """Leave out what shows little of a stone where it is off the course of the stone.

    Parameters
    ----------
    tracks : sequence of Track
    radius : float
        Of the discs, m.

    Returns
    -------
    list of Track
        In their order.
    """
    places = [track.detections.columns("x", "y").T for track in tracks]
    out = []
    for rank, track in enumerate(tracks):
        others = [(np.array(other.times), places[k]) for k, other in enumerate(tracks) if k != rank]
        stray = _strays(track, places[rank], others, radius)
        out.append(_part(track, np.flatnonzero(~stray)) if stray.any() else track)
    return out


def _strays(
    track: Track, places: Array, others: Sequence[tuple[Array, Array]], radius: float
) -> Flags:
    """Tell which detections of a track are of something else."""
    times = np.array(track.times)
    score = track.detections.columns("score")[0]
    faint = score < FAINT * np.percentile(score, 75)
    stray = np.zeros(len(times), bool)
    edges = np.flatnonzero(np.diff(np.r_[False, faint, False])).reshape(-1, 2)
    for begin, end in edges.tolist():
        run = slice(begin, end)
        clear = np.flatnonzero(~faint)
        off = [
            _off_course(times, places, side, run, radius)
            for side in (clear[clear < begin][::-1], clear[clear >= end])
            if len(side)
        ]
        away = np.logical_and.reduce(off) if off else np.zeros(end - begin, bool)
        if away.any() and not _touched(times[run], places[run], others, radius):
            stray[run] = away
    return stray


def _off_course(
    times: Array, places: Array, clear: NDArray[np.intp], run: slice, radius: float
) -> Flags:
    """Return what of a run is off the course of clear detections, the nearest of them first."""
    start, wait = times[clear[0]], times[run] - times[clear[0]]
    near = clear[np.abs(times[clear] - start) <= WINDOW]
    basis = np.stack([np.ones(len(near)), times[near] - start], axis=1)
    (place, velocity), *_ = np.linalg.lstsq(basis, places[near], rcond=None)
    bent = np.std(basis @ [place, velocity] - places[near]) > STRAIGHT * radius
    if bent or len(near) < BIRTHS:
        return np.zeros(len(wait), bool)
    # It may have slowed down more, or have been faster before.
    aside = places[run] - place
    along = aside @ velocity / max(velocity @ velocity, TINY)
    along = np.clip(along, np.minimum(2 * wait, 0), np.maximum(2 * wait, 0))
    off = np.hypot(*(aside - along[:, None] * velocity).T)
    return np.asarray(off > (ASTRAY + GROWTH * np.abs(wait)) * radius)


def _touched(
    times: Array, places: Array, others: Sequence[tuple[Array, Array]], radius: float
) -> bool:
    """Whether another stone was near meanwhile."""
    for at, where in others:
        there = np.stack([np.interp(times, at, where[:, axis]) for axis in (0, 1)], axis=1)
        if np.hypot(*(there - places).T).min() < TOUCHED * radius:
            return True
    return False


def _part(track: Track, ranks: NDArray[np.intp]) -> Track:
    """Take some of the detections of a track."""
    some = ranks.tolist()
    return Track(
        [track.frames[k] for k in some],
        [track.times[k] for k in some],
        Rows(track.detections[k] for k in some),
        track.colour,
    )
