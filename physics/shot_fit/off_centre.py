"""Caps that sit beside the centres of their stones: an error of places that turns with them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.local_fit.off_centre import moved
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.physics.statistics.residuals import huber_weights

Floats = NDArray[np.float64]


def centred(trace: Trace, residuals: Floats, noise: float, sd: float) -> tuple[Floats, Floats]:
    """Take out of residuals what the stone's cap is beside its centre by, as far as it shows.

    The cap stays where it is in the stone's frame.

    Parameters
    ----------
    trace : Trace
        Detections of the stone; where no angle is told for a while nothing is taken out.
    residuals : (n, 2) array
        Sighted less fitted places over their standard deviations.
    noise : float
        Factor on the stated variances of the places.
    sd : float
        By how much the cap may be beside the centre, m; where that is 0, unknown, nothing is taken
        out.

    Returns
    -------
    residuals : (n, 2) array
        Those that are left.
    beside : (2,) array
        By how much the cap is beside the centre, in `sd` on either axis: a residual too.
    """
    if not sd or not np.isfinite(trace.theta).any():
        return residuals, np.zeros(2)
    known = sd * trace.faced[:, None, None] * trace.rotations
    rows = (known / trace.sd[:, :, None]).reshape(-1, 2)
    weighted = rows * np.repeat(huber_weights(residuals), 2)[:, None] / noise
    normal = np.eye(2) + weighted.T @ rows
    beside = np.asarray(np.linalg.solve(normal, weighted.T @ residuals.ravel()), float)
    return residuals - (rows @ beside).reshape(-1, 2), beside


def centred_traces(known: Mapping[str, Trace], fit: ShotFit) -> Mapping[str, Trace]:
    """Put detections over the centres by what a fit of the whole shot has the caps beside them.

    Parameters
    ----------
    known : mapping
        Stone to its detections, of which the shot that was fitted may hold only a part.
    fit : ShotFit
        Of that shot.

    Returns
    -------
    mapping
        The same one where no cap is told.
    """
    shot, out = fit.shots[0], dict(known)
    runs = shot.residuals(fit.simulation())
    for (stone, trace), run in zip(shot.traces.items(), runs, strict=True):
        sd = shot.sd_off_centre(trace)
        _, beside = centred(trace, run, fit.inflation, sd)
        if beside.any():
            whole = known[stone]
            out[stone] = moved(whole, sd * beside)
    return known if all(out[stone] is known[stone] for stone in known) else out
