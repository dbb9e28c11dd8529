"""As much of a shot as the simulator can follow, fitted."""

from __future__ import annotations

from physics.law_choice import fit_with_chosen_laws
from physics.shot_model import Watched
from physics.whole_fit import GlobalFit

BEFORE = 0.1
"""How long before a hit that is not as simulated the shot is left, s: its time is not certain."""


def fit_followed(shot: Watched) -> tuple[GlobalFit, str | None]:
    """Fit a shot up to the first hit that the simulator has and the tracks do not, or the reverse.

    Parameters
    ----------
    shot : Watched
        With a hit at least.

    Returns
    -------
    fit : GlobalFit
        Of the whole shot, or of its beginning, where that is followed and has a hit; else of
        the whole shot, not followed.
    end : str or None
        When and why it ends sooner than the shot.
    """
    whole = fit = fit_with_chosen_laws(shot)
    end = None
    while not followed(fit):
        time, why = _obstacle(fit)
        shorter = fit.shots[0].until(time - BEFORE)
        if not shorter.hits:
            return whole, None
        end = f"until {time - BEFORE:.2f} s: {why}"
        fit = fit_with_chosen_laws(shorter)
    return fit, end


def _obstacle(fit: GlobalFit) -> tuple[float, str]:
    """Time, s, of the hit at which a shot is not followed, and why it is not."""
    shot = fit.shots[0]
    other = shot.first_other_hit(fit.simulation())
    if other is not None:
        return other[0], f"the hit of {other[1]} is not as simulated"
    return shot.times[-1], f"with the hit of {' and '.join(shot.hits[-1])} the fit does not settle"


def followed(fit: GlobalFit) -> bool:
    """Whether a fit came to its end and its hits are those that were seen."""
    return fit.settled and fit.hits_as_seen
