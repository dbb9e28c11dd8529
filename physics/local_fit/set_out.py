"""Where a fit of a whole shot sets out from: times and straight lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from physics.local_fit.segments import Piece
from physics.local_fit.shot_fit import Meeting
from physics.local_fit.traces import Trace

Floats = NDArray[np.float64]


def origin(piece: Piece, trace: Trace, meetings: Sequence[Meeting]) -> float:
    """Time at which a piece's state is to be given, s: of the hit that opens it, else its first.

    Parameters
    ----------
    piece : Piece
    trace : Trace
        All sightings of its stone.
    meetings : sequence of Meeting
        Those that the piece's ranks are of.
    """
    if piece.opens is not None:
        return meetings[piece.opens].t
    if len(piece.samples):
        return float(trace.t[piece.samples[0]])
    return piece.start if np.isfinite(piece.start) else piece.end


def line(piece: Piece, trace: Trace, start: float) -> tuple[Floats, Floats]:
    """Place and velocity of a piece at a time, s, by a straight line: m and m/s, 0 at rest.

    The shortest pieces take those of sightings beside them.
    """
    samples = piece.samples
    if len(samples) < 3:
        low = max(int(np.searchsorted(trace.t, piece.start)) - 1, 0)
        high = min(int(np.searchsorted(trace.t, piece.end)) + 1, len(trace.t))
        samples = np.arange(low, high)
    tau = trace.t[samples] - start
    degree = 0 if piece.rest or len(samples) < 2 else 1
    found = np.polynomial.polynomial.polyfit(tau, trace.xy[samples], degree)
    return found[0], found[1] if degree else np.zeros(2)
