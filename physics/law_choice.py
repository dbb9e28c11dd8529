"""The whole shot fitted once: which law of the ice and whether curl shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from physics.global_fit import GlobalFit, fit_shots
from physics.shot_model import Watched

STRAIGHT = {"slope": 0.0, "turn": 0.0}
"""Constant friction and no curl: what a shot is fitted with first."""


def fit_with_chosen_laws(shots: Sequence[Watched]) -> GlobalFit:
    """Fit shots with the laws that the sightings ask for.

    Friction that depends on the speed and curl are each taken up where Schwarz's criterion
    (1978, Ann. Stat. 6, 461) is the better for it, the deviance counted in the noise that the
    residuals show.
    """
    held = dict(STRAIGHT)
    best = fit_shots(shots, fixed=held)
    for name in STRAIGHT:
        fewer = {key: value for key, value in held.items() if key != name}
        start = dict(zip(best.names, best.values.tolist(), strict=True))
        # Under the wrong law stones may have come to stick, from where no slope leads back.
        start = {key: value for key, value in start.items() if "stone_friction" not in key}
        more = fit_shots(shots, fixed=fewer, start=start)
        if more.settled and _criterion(more, more.inflation) < _criterion(best, more.inflation):
            best, held = more, fewer
    return best


def _criterion(fit: GlobalFit, noise: float) -> float:
    return fit.deviance / noise + len(fit.names) * float(np.log(2 * fit.sightings / noise))
