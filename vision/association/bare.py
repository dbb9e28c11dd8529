"""Discs without a handle: paint or a graphic, though their edges are those of a stone.

By its edges, what is round, of a cap's size and with something as light as granite around it passes
for a stone, and nothing but that tells it under a camera that stands still. But each stone has a
handle, and a team's are alike.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import nan

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.association.follow import Track
from curlshot.vision.association.naming import first_motion
from curlshot.vision.detection.appearance import Appearance
from curlshot.vision.detection.patch import is_plain
from curlshot.vision.detection.relief import BARE, contrast, contrast_turned, without_handle

Complex = NDArray[np.complex64]
Flags = NDArray[np.bool_]

FEWEST = 3
"""Pictures from which on they tell together what they share; of fewer each counts by itself."""

MOST_PAIRS = 40
"""Pictures that are compared with the next one, spread over a track: more say the same."""

WIDTH = 0.025
"""Width of a handle, m: where pixels are larger it hardly shows. Rendered ones with 12 and 18 at
55 px/m have 9 and 14 at 40, 4 at 25; at 30 a thrown stone had 2.3, one at rest beside it 9.4."""

OWN_TEAM, OTHER_TEAM = 0.4, 0.1
"""Share of what a team's handles show usually, and of what each of another team's does, below which
there is none. Such real stones show 0.66 of the one at least and 0.37 of the other, drawn ones 0.6
and, with handles in their caps' colour, 0.13; paint and icons 0.37 of the one, most 0.1. One
drawn stone with its handle in the cap's colour showed 0.39 of what another at rest did."""

MOVING = 0.5
"""What counts of the first for what moved on the ice: no paint does, though an icon may seem to
where a camera pans. One has 1.3 where that leaves 4; what moved with a faint handle has 2.9 and
more where that leaves 1.5."""


def with_handles(
    tracks: Sequence[Track], appearance: Appearance | None, disc: Stone
) -> list[Track]:
    """Leave out discs without a handle among stones; plain discs are not known to have any."""
    if appearance is None or is_plain(disc):
        return [*tracks]
    team = [appearance.nearest(track.colour)[0] for track in tracks]
    moved = [first_motion(track, disc.radius) is not None for track in tracks]
    # What moves may turn, by a radian and more from one picture to the next.
    shown = [
        contrast_of(track, contrast_turned if moves else contrast)
        for track, moves in zip(tracks, moved, strict=True)
    ]
    brief = np.array([len(track.frames) < FEWEST for track in tracks], bool)
    ends = ([track.detections[k] for track in tracks] for k in (0, -1))
    alone = np.all([without_handle(seen) for seen in ends], axis=0)
    without = bare(shown, team, moved) | (alone & brief)
    return [track for track, out in zip(tracks, without, strict=True) if not out]


def contrast_of(track: Track, shared: Callable[[Complex, Complex], float]) -> float:
    """Contrast around the centre that pictures of a cap share with the next ones, L*a*b* units.

    Parameters
    ----------
    track : Track
    shared : callable
        Tells it of two pictures.

    Returns
    -------
    float
        NaN where fewer than `FEWEST` pictures show the cap, or where they are too coarse.
    """
    shown = [kept for kept in track.detections.spectra if kept is not None]
    if len(shown) < FEWEST or np.median(track.detections.columns("pixel_size")) > WIDTH:
        return nan
    some = np.unique(np.linspace(0, len(shown) - 2, MOST_PAIRS).astype(int)).tolist()
    # What covers a cap for some time has contrast of its own.
    return float(np.median([shared(shown[k].get(), shown[k + 1].get()) for k in some]))


def bare(shown: Sequence[float], team: Sequence[int], moved: Sequence[bool]) -> Flags:
    """Tell which discs have no handle, as stones beside them have.

    Parameters
    ----------
    shown : sequence of float
        Contrast of each, from `contrast_of`.
    team : sequence of int
        Rank of the cap's colour of each.
    moved : sequence of bool
        Which of them moved on the ice. No paint does: what they show says how faint a team's
        handles may be, and a team of which one does, but of which no handle is seen, has such as
        do not show.

    Returns
    -------
    ndarray of bool, shape (n,)
        False where it cannot be told, or where no stone shows a handle.
    """
    values, of, moves = np.asarray(shown, float), np.asarray(team), np.asarray(moved, bool)
    handled = values >= BARE
    out = np.zeros(len(values), bool)
    for rank in set(team):
        own = of == rank
        alike, others = values[handled & own], values[handled & ~own]
        if len(alike):
            least = OWN_TEAM * float(np.nanmedian(values[(handled | moves) & own]))
        elif len(others) and not (moves & own).any():
            least = OTHER_TEAM * float(others.min())
        else:
            least = 0.0
        out |= own & (values < np.minimum(np.where(moves, MOVING, 1.0) * least, BARE))
    return out
