"""Which pieces of paths are free glides: slowed by the ice alone, not pushed, carried or led."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.local_fit.segments import Piece

PUSHED = 0.2
"""Acceleration ahead or aside, m/s², that neither ice nor a table that is not quite level gives
(one degree gives 0.17): what has it is pushed or led."""

LED, OFTEN = 4, 1.5
"""Changes of a stone's motion without a hit from which on, and per second how many, it is led: what
bounces off walls changes as many times, but has a second to glide between them."""


def is_pushed(slowing: float, aside: float, sd_slowing: float, sd_aside: float) -> bool:
    """Say whether accelerations, m/s², against the motion and across it are those of a push."""
    return max(-slowing - 3 * sd_slowing, abs(aside) - 3 * sd_aside) > PUSHED


def are_free(
    pieces: Sequence[Piece], pushed: Collection[int], changes: Mapping[str, Sequence[float]]
) -> NDArray[np.bool_]:
    """Say which pieces are free glides.

    From one hit or rest to the next what follows a push is free, for a stone is thrown so. Where
    there is a second push nothing is, for then what slows the stone in between is no ice either.

    Parameters
    ----------
    pieces : sequence of Piece
        Those of a stone one after the other.
    pushed : collection of int
        Ranks of those in which a stone is pushed.
    changes : mapping
        Stone to times, s, at which its motion changes without a hit; none where absent.

    Returns
    -------
    ndarray of bool, shape (len(pieces),)
    """
    led = {stone for stone, times in changes.items() if _led(times)}
    free = np.array([piece.stone not in led for piece in pieces], bool)
    for ranks in _stretches(pieces):
        first, last = pieces[ranks[0]], pieces[ranks[-1]]
        pushes = [rank for rank in ranks if rank in pushed]
        times = [t for t in changes.get(first.stone, ()) if first.start <= t <= last.end]
        if len(pushes) > 1 or _led(times):
            free[ranks] = False
        elif pushes:
            free[ranks[0] : pushes[0] + 1] = False
    return free


def _led(times: Sequence[float]) -> bool:
    """Whether a stone's motion changes at so many times, s, that it is led."""
    return len(times) > LED and len(times) - 1 > OFTEN * (max(times) - min(times))


def _stretches(pieces: Sequence[Piece]) -> list[list[int]]:
    """Ranks of pieces that follow each other without a hit or a rest between."""
    out: list[list[int]] = []
    for rank, piece in enumerate(pieces):
        before = pieces[rank - 1] if rank else None
        goes_on = (
            before is not None
            and before.stone == piece.stone
            and piece.opens is None
            and not (before.rest or before.stops or piece.rest)
            and piece.start <= before.end  # pieces at rest may have been left out
        )
        if goes_on:
            out[-1].append(rank)
        else:
            out.append([rank])
    return out
