"""The whole shot fitted once: which law of the ice and whether curl shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from data.results import Estimate, Law
from physics.global_fit import GlobalFit, fit_shots
from physics.shot_model import Watched

STRAIGHT = {"slope": 0.0, "turn": 0.0}
"""Constant friction and no curl: what a shot is fitted with first."""

STICKING = {"stone_friction": 2.0}
"""Stones that stop sliding on each other before they part: any greater friction does the same."""


def fit_with_chosen_laws(shots: Sequence[Watched]) -> GlobalFit:
    """Fit shots with the laws that the sightings ask for.

    Friction that depends on the speed and curl are each taken up, and friction between stones
    is kept as an unknown, where the sightings are the more probable for it: minus twice the
    logarithm of that probability, by Laplace's method, is the criterion (Kass and Raftery,
    1995, J. Am. Stat. Assoc. 90, 773). Otherwise the stones stick.

    What the other choices of laws would give is in the errors: each adds the square of its
    difference, weighted by its probability (Buckland et al., 1997, Biometrics 53, 603).
    """
    held = dict(STRAIGHT)
    best = fit_shots(shots, fixed=held)
    tried = [best]
    for name in STRAIGHT:
        fewer = {key: value for key, value in held.items() if key != name}
        more = fit_shots(shots, fixed=fewer, start=_start(best))
        tried.append(more)
        if more.settled and _criterion(more, more.inflation) < _criterion(best, more.inflation):
            best, held = more, fewer
    if any(shot.hits for shot in shots):
        stuck = fit_shots(shots, fixed=held | STICKING, start=_start(best))
        tried.append(stuck)
        if stuck.settled and _criterion(stuck, best.inflation) < _criterion(best, best.inflation):
            best = stuck
    return _with_others(best, [fit for fit in tried if fit.settled or fit is best])


def _with_others(best: GlobalFit, tried: Sequence[GlobalFit]) -> GlobalFit:
    """Put what the fits with other laws say into the errors of the best one."""
    criteria = np.array([_criterion(fit, best.inflation) for fit in tried])
    weights = np.exp(-0.5 * (criteria - criteria.min()))
    weights /= weights.sum()
    between = np.zeros_like(best.cov)
    for fit, weight in zip(tried, weights.tolist(), strict=True):
        off = _difference(fit, best)
        between += weight * np.outer(off, off)
    order = np.argsort(criteria, kind="stable").tolist()
    laws = tuple(
        Law(
            _name(tried[k]),
            float(criteria[k] - criteria.min()),
            float(weights[k]),
            tried[k]["friction"] if tried[k].told("friction") else Estimate(),
        )
        for k in order
    )
    return replace(best, cov=best.cov + between, laws=laws)


def _difference(fit: GlobalFit, best: GlobalFit) -> NDArray[np.float64]:
    """How far the unknowns of a fit lie from those of the best one; 0 where it holds them."""
    values = dict(zip(fit.names, fit.values.tolist(), strict=True))
    return np.array(
        [values.get(name, own) - own for name, own in zip(best.names, best.values, strict=True)]
    )


def _name(fit: GlobalFit) -> str:
    """Return the laws of a fit in words."""
    ice = "constant" if "slope" in fit.fixed else "fit"
    curl = "none" if "turn" in fit.fixed else "fcv1"
    hits = "stones stick" if "stone_friction" in fit.fixed else "stones slide"
    return f"ice {ice}, curl {curl}, {hits}"


def _start(fit: GlobalFit) -> dict[str, float]:
    """Where the next fit sets out from: all but the friction between stones.

    Under the wrong laws they may have come to stick, from where no slope leads back.
    """
    values = dict(zip(fit.names, fit.values.tolist(), strict=True))
    return {name: value for name, value in values.items() if "stone_friction" not in name}


def _criterion(fit: GlobalFit, noise: float) -> float:
    """Minus twice the log probability of the sightings, but for what all fits share."""
    known = fit.prior_sd[np.isfinite(fit.prior_sd)]
    sd = np.sqrt(np.diag(fit.cov))  # apart, for determinants leave what numbers can hold
    volume = float(np.linalg.slogdet(fit.cov / np.outer(sd, sd))[1]) + 2 * np.sum(np.log(sd))
    volume -= len(fit.names) * np.log(fit.inflation / noise)
    prior = 2 * np.sum(np.log(known))
    return float(fit.deviance / noise + fit.elsewhere + prior - volume)
