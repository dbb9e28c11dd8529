"""Prune candidates of contacts at which the relative velocity of the two stones did not change.

Stones that lie or move side by side are near each other all the time, so that each pair has
candidates at many times. To fit hundreds of them takes minutes; a test of the relative velocity
before and after each takes none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from curlshot.physics.local_fit.solution import Meeting
from curlshot.physics.local_fit.traces import Trace

MANY = 24
"""Meetings up to which all are fitted: of shots with three hits there are ten."""

SPAN, FEWEST = 0.4, 8
"""Time on either side of a meeting within which a hit shows, s, or more for as many detections."""

CHANGED = 14.0
"""Squared normalised change of a relative velocity, two axes, below which it is none: chance, which
brings stones near each other where noise does, leaves one in twenty as large."""


def prune_candidates(meetings: Sequence[Meeting], known: Mapping[str, Trace]) -> list[Meeting]:
    """Return all meetings if they are few, else those at which a relative velocity changed.

    Parameters
    ----------
    meetings : sequence of Meeting
        What may have been hits.
    known : mapping of str to Trace
    """
    if len(meetings) <= MANY:
        return list(meetings)
    return [m for m in meetings if _change(m, known) > CHANGED]


def _change(meeting: Meeting, known: Mapping[str, Trace]) -> float:
    """Squared normalised change of a pair's relative velocity; 0 where too little is seen."""
    one, other = (known[stone] for stone in meeting.stones)
    span = max(SPAN, FEWEST * one.step, FEWEST * other.step)
    near = one.between(meeting.t - span, meeting.t + span)
    near &= (one.t >= other.t[0]) & (one.t <= other.t[-1])
    t = one.t[near]
    tau = t - meeting.t
    if min((tau < 0).sum(), (tau > 0).sum()) < 3:
        return 0.0
    total = 0.0
    for axis in range(2):
        apart = np.interp(t, other.t, other.xy[:, axis]) - one.xy[near, axis]
        sd = np.hypot(np.interp(t, other.t, other.sd[:, axis]), one.sd[near, axis])
        basis = np.stack([np.ones_like(tau), tau, np.maximum(tau, 0.0)], axis=1) / sd[:, None]
        cov = np.linalg.inv(basis.T @ basis)
        change = float((cov @ (basis.T @ (apart / sd)))[2])
        total += change**2 / float(cov[2, 2])
    return total
