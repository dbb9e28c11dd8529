"""Spins that are hardly seen between two hits, from those of the stones that were met there.

In a hit both stones are rubbed by the same impulse at the same lever, so that the spins of equal
stones change by the same amount. A stone that is hit twice within a few pictures shows little of
its spin between; the other stones' changes tell it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from data.tracks import Columns
from physics.contacts import Contact

POOR = 0.1
"""Standard error of a spin, rad/s, from which others are asked for help."""

SHORT, VAGUE = 0.4, 0.5
"""Time over which a spin stays the same, s; of a longer stretch it is taken to do so only where its
standard error, rad/s, is larger."""

NEAR = 0.1
"""How far from a hit, s, a spin is that which the hit began or ended with: beside it rows may lie
on its other side."""

SLACK, UNLIKE = 0.05, 0.2
"""How far from the same the two changes are, rad/s, and as a share of them: stones are not quite
equal, and of discs on tables nobody says here which is heavier."""


@dataclass(frozen=True)
class _Side:
    """A stone on one side of a hit: its table, its rows up to the next hit, spin and error."""

    table: Columns
    rows: NDArray[np.intp]
    spin: float
    sd: float


def share_spins(tables: Mapping[str, Columns], contacts: Sequence[Contact]) -> None:
    """Improve poorly seen spins of short stretches between hits, and their standard errors.

    Parameters
    ----------
    tables : mapping
        Stone to its rows of ``t``, ``omega`` and ``sd_omega``; the latter two are changed.
    contacts : sequence of Contact
        The hits.
    """
    left = [hit for hit in contacts if None not in _sides(tables, contacts, hit)]
    while left:
        # That of which most is known first: it may help at another. Each tells but once.
        each = [[s for s in _sides(tables, contacts, hit) if s is not None] for hit in left]
        k = min(range(len(left)), key=lambda k: sum(sorted(s.sd**2 for s in each[k])[:3]))
        _share(each[k])
        del left[k]


def _share(sides: Sequence[_Side]) -> None:
    """Join what is poorly seen of the four spins of a hit with what the other three imply."""
    for k, here in enumerate(sides):
        t, spin, sd = (here.table[name] for name in ("t", "omega", "sd_omega"))
        if here.sd < (POOR if np.ptp(t[here.rows]) <= SHORT else VAGUE):
            continue
        there, (first, last) = sides[k ^ 1], sides[2:] if k < 2 else sides[:2]
        change = last.spin - first.spin
        implied = there.spin + (change if k % 2 else -change)
        variance = there.sd**2 + first.sd**2 + last.sd**2 + SLACK**2 + (UNLIKE * change) ** 2
        share = variance / (variance + sd[here.rows] ** 2)
        spin[here.rows] = share * spin[here.rows] + (1 - share) * implied
        sd[here.rows] = np.sqrt(variance * (1 - share))


def _sides(
    tables: Mapping[str, Columns], contacts: Sequence[Contact], hit: Contact
) -> list[_Side | None]:
    """Give the first stone before and after a hit, then the second; None where it is not told."""
    return [
        _side(tables[stone], contacts, stone, hit.t, late) if stone in tables else None
        for stone in hit.stones
        for late in (False, True)
    ]


def _side(
    table: Columns, contacts: Sequence[Contact], stone: str, time: float, late: bool
) -> _Side | None:
    """Give a stone before or after its hit at a time; None where its spin is not told."""
    hits = [hit.t for hit in contacts if stone in hit.stones]
    t, sd = table["t"], table["sd_omega"]
    if late:
        inside = (t >= time) & (t < min((hit for hit in hits if hit > time), default=np.inf))
    else:
        inside = (t < time) & (t >= max((hit for hit in hits if hit < time), default=-np.inf))
    rows = np.flatnonzero(inside & np.isfinite(sd))
    if not len(rows):
        return None
    near = rows[np.abs(t[rows] - time) <= max(NEAR, float(np.abs(t[rows] - time).min()))]
    best = near[sd[near].argmin()]
    return _Side(table, rows, float(table["omega"][best]), float(sd[best]))
