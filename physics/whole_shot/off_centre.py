"""Caps that sit beside the centres of their stones: an error of places that turns with them."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physics.local_fit.off_centre import turns
from physics.local_fit.traces import Trace
from physics.statistics.residuals import huber_weights
from physics.whole_shot.whole_fit import GlobalFit

Floats = NDArray[np.float64]


def centred(
    trace: Trace, residuals: Floats, noise: float, share: float = 1.0
) -> tuple[Floats, Floats]:
    """Take out of residuals what the stone's cap is beside its centre by, as far as it shows.

    The cap stays where it is in the stone's frame. It is known to be in the middle to `sd_place`,
    the error that all its places have in common, or to a part of that, on either axis.

    Parameters
    ----------
    trace : Trace
        Sightings of the stone; without angles, or without `sd_place`, nothing is taken out.
    residuals : (n, 2) array
        Sighted less fitted places over their standard deviations.
    noise : float
        Factor on the stated variances of the places.
    share : float
        What part of `sd_place`.

    Returns
    -------
    residuals : (n, 2) array
        Those that are left.
    beside : (2,) array
        By how much the cap is beside the centre, in its own standard deviations (`_sd_aside`): a
        residual too.
    """
    size = _sd_aside(trace, share)
    if not size or not np.isfinite(trace.theta).any():
        return residuals, np.zeros(2)
    rows = size * turns(trace, trace.t) / trace.sd[:, :, None]
    weighted = rows * huber_weights(residuals)[:, :, None] / noise
    normal = np.eye(2) + np.einsum("nai,naj->ij", weighted, rows)
    beside = np.linalg.solve(normal, np.einsum("nai,na->i", weighted, residuals))
    return residuals - rows @ beside, beside


def centred_sightings(sightings: pd.DataFrame, fit: GlobalFit) -> pd.DataFrame:
    """Take out of sightings by what a fit of the whole shot has the caps beside the centres.

    Returns
    -------
    DataFrame
        The table itself where no cap is told.
    """
    out, shot = sightings, fit.shots[0]
    runs = shot.residuals(fit.simulation())
    for (stone, trace), run in zip(shot.traces.items(), runs, strict=True):
        _, beside = centred(trace, run, fit.inflation, shot.off_centre)
        if not beside.any():
            continue
        out = sightings.copy() if out is sightings else out
        own = out["stone"] == stone
        beside *= _sd_aside(trace, shot.off_centre)
        out.loc[own, ["x", "y"]] -= turns(trace, out.loc[own, "t"].to_numpy(float)) @ beside
    return out


def _sd_aside(trace: Trace, share: float) -> float:
    """By how much a cap may be beside its stone's centre on either axis, m; 0 if not known."""
    return share * trace.usual_sd_place
