"""As much of a shot as the simulator can follow, fitted."""

from __future__ import annotations

import numpy as np

from curlshot.physics.shot_fit.model_selection import BEFORE, fit_with_chosen_laws
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.physics.shot_fit.shot_model import ObservedShot
from curlshot.physics.shot_fit.track_residuals import fit_without_bent_tracks

AWAY, QUIETER, UNEXPLAINED = 0.2, 2.0, 2.0
"""Time, s, in which nothing is seen if a clip shows something else; how many times less noise the
shot has before that if what comes after is not its continuation; and the least misfit of the whole
(`ShotFit.misfit`) at which it may be none. Of a clip a longer part is noisier, for its map errs:
six that were shown on after something else came to 1.8 at most, with 20 ms lost to 3.6 and more."""


def fit_valid_interval(shot: ObservedShot) -> tuple[ShotFit, str | None]:
    """Fit a shot up to the first hit that the simulator has and the tracks do not, or the reverse.

    Parameters
    ----------
    shot : ObservedShot
        As `curlshot.physics.shot_fit.observed.observe` makes it.

    Returns
    -------
    fit : ShotFit
        Of the whole shot, or of its beginning, where that is followed and has a hit; else of
        the whole shot, not followed, as always without a hit.
    end : str or None
        When and why it ends sooner than the shot.
    """
    whole = fit = fit_without_bent_tracks(shot)
    end = None
    while shot.hits and not followed(fit):
        time, why = _obstacle(fit)
        shorter = fit.shots[0].until(time - BEFORE)
        if not shorter.hits:
            return whole, None
        end = f"until {time - BEFORE:.2f} s: {why}"
        fit = fit_with_chosen_laws(shorter)
    return _until_resumed(fit, end)


def _until_resumed(fit: ShotFit, end: str | None) -> tuple[ShotFit, str | None]:
    """Leave a shot where it is not shown for a while, if it does not go on from there as it was.

    Such a clip may have lost time, or its map of the ice may be another one since.
    """
    shot = fit.shots[0]
    if fit.misfit < UNEXPLAINED:
        return fit, end
    seen = np.unique(np.concatenate([trace.t for trace in shot.traces.values()]))
    steps = np.diff(seen)
    away = steps > max(AWAY, 4 * float(np.median(steps)) if len(steps) else 0.0)
    for time in seen[1:][away].tolist():
        shorter = shot.until(time)
        if shorter.hits:
            part = fit_with_chosen_laws(shorter)
            if followed(part) and QUIETER * part.inflation < fit.inflation:
                why = "the clip does not continue the same motion from there"
                return part, f"until {time:.2f} s: {why}"
    return fit, end


def _obstacle(fit: ShotFit) -> tuple[float, str]:
    """Time, s, of the hit at which a shot is not followed, and why it is not."""
    shot = fit.shots[0]
    other = shot.first_other_hit(fit.simulation())
    if other is not None:
        return other[0], f"the hit of {other[1]} differs from the simulated one"
    return shot.times[
        -1
    ], f"the fit does not converge with the hit of {' and '.join(shot.hits[-1])}"


def followed(fit: ShotFit) -> bool:
    """Whether a fit came to its end and its hits are those that were seen."""
    return fit.settled and fit.hits_as_seen
