"""The whole shot fitted once: which law of the ice and whether curl shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from physics.global_fit import GlobalFit, fit_shots
from physics.shot_model import Watched

STRAIGHT = {"slope": 0.0, "turn": 0.0}
"""Constant friction and no curl: what a shot is fitted with first."""

STICKING = {"stone_friction": 2.0}
"""Stones that stop sliding on each other before they part: any greater friction does the same."""


def fit_with_chosen_laws(shots: Sequence[Watched]) -> GlobalFit:
    """Fit shots with the laws that the sightings ask for.

    Friction that depends on the speed and curl are each taken up, and friction between stones
    is kept as an unknown, where Schwarz's criterion (1978, Ann. Stat. 6, 461) is the better for
    it, the deviance counted in the noise that the residuals show. Otherwise the stones stick.
    """
    held = dict(STRAIGHT)
    best = fit_shots(shots, fixed=held)
    for name in STRAIGHT:
        fewer = {key: value for key, value in held.items() if key != name}
        more = fit_shots(shots, fixed=fewer, start=_start(best))
        if more.settled and _criterion(more, more.inflation) < _criterion(best, more.inflation):
            best, held = more, fewer
    if any(shot.hits for shot in shots):
        stuck = fit_shots(shots, fixed=held | STICKING, start=_start(best))
        if stuck.settled and _criterion(stuck, best.inflation) < _criterion(best, best.inflation):
            best = stuck
    return best


def _start(fit: GlobalFit) -> dict[str, float]:
    """Where the next fit sets out from: all but the friction between stones.

    Under the wrong laws they may have come to stick, from where no slope leads back.
    """
    values = dict(zip(fit.names, fit.values.tolist(), strict=True))
    return {name: value for name, value in values.items() if "stone_friction" not in name}


def _criterion(fit: GlobalFit, noise: float) -> float:
    return fit.deviance / noise + len(fit.names) * float(np.log(2 * fit.sightings / noise))
