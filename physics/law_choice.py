"""The whole shot fitted once: which law of the ice and whether curl shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from data.results import Estimate, Law
from physics.global_fit import LOST, fit_shots
from physics.shot_model import V_C, Watched, penner
from physics.watched import THROWN
from physics.whole_fit import GlobalFit

STRAIGHT = {"slope": 0.0, "v_c": V_C, "turn": 0.0}
"""Constant friction and no curl: what a shot is fitted with first."""

STICKING = {"stone_friction": 2.0}
"""Stones that stop sliding on each other before they part: any greater friction does the same."""


ELSEWHERE = 1.5
"""How many times the deviance of a fit one with more freedom must have to have come to rest
elsewhere: it can be no larger where both follow the shot alike."""


def fit_with_chosen_laws(shot: Watched, fixed: Mapping[str, float] | None = None) -> GlobalFit:
    """Fit a shot with the laws that the sightings ask for, some unknowns held if `fixed`.

    Friction that depends on the speed and curl are each taken up, and friction between stones
    is kept as an unknown, where the sightings are the more probable for it. Otherwise the
    friction is constant, the paths are straight, the stones stick.

    What the other choices of laws would give is in the errors, each by its probability
    (Buckland et al., 1997, Biometrics 53, 603). So is what Penner's law gives where friction
    falls: the one that is reported follows any ice but not to the last per cent.
    """
    held = STRAIGHT | dict(fixed or {})
    best = _turning(fit_shots([shot], fixed=held), shot, held)
    tried, criteria, least = [best], [0.0], 0.0
    for name in ("slope", "turn"):
        fewer = {key: value for key, value in held.items() if key != name}
        more = _freer(shot, fewer, best)
        if _elsewhere(more, best):
            continue
        if best.astray and not more.astray:
            best = fit_shots([shot], fixed=held, start=_start(more))
            tried[criteria.index(least)] = best
        criterion = least + _against(more, name)
        if criterion < least:
            if name == "slope":  # where friction falls there is a knee to be found
                free = {key: value for key, value in fewer.items() if key != "v_c"}
                bent = fit_shots([shot], fixed=free, start=_start(more))
                more, fewer = (bent, free) if bent.settled else (more, fewer)
            best, held, least = more, fewer, criterion
        tried.append(more)
        criteria.append(criterion)
    if "slope" not in held:
        even = {"slope": 0.0, "v_c": V_C, **held}
        rooted = fit_shots([replace(shot, ice=penner)], fixed=even, start=_start(best))
        if rooted.settled:
            tried.append(rooted)
            criteria.append(least + _beside(rooted, best))
    if shot.hits:
        stuck = fit_shots([shot], fixed=held | STICKING, start=_start(best))
        if stuck.settled:
            tried.append(stuck)
            criteria.append(least + _beside(stuck, best))
            if criteria[-1] < least:
                best = stuck
    return _with_others(best, tried, np.array(criteria))


def _elsewhere(fit: GlobalFit, best: GlobalFit) -> bool:
    """Whether a fit with more freedom has not come to an end where the one with less is."""
    return not fit.settled or fit.deviance > ELSEWHERE * best.deviance


def _freer(shot: Watched, held: Mapping[str, float], best: GlobalFit) -> GlobalFit:
    """Fit with more freedom from where the fit with less is, or from where that one set out.

    Under the wrong laws stones may have come to miss or to slide off each other, from where no
    slope leads back.
    """
    more = fit_shots([shot], fixed=held, start=_start(best))
    if not (_elsewhere(more, best) or more.astray):
        return more
    again = fit_shots([shot], fixed=held)
    return min(
        (more, again),
        key=lambda fit: (not fit.settled, not fit.hits_as_seen, fit.astray, fit.deviance),
    )


def _turning(fit: GlobalFit, shot: Watched, held: Mapping[str, float]) -> GlobalFit:
    """Fit again from spins of either sense where a fit has come to rest at a spin of nothing.

    A spin that is lost before the hit changes nothing there, and with it the stones may have come
    to stick, so that no slope leads back.
    """
    none = [
        name
        for name, value in zip(fit.names, fit.values.tolist(), strict=True)
        if name.endswith("omega") and abs(value) < LOST
    ]
    if not none or not shot.hits:
        return fit
    spun = [
        fit_shots([shot], fixed=held, start=dict.fromkeys(none, omega))
        for omega in (-THROWN, THROWN)
    ]
    return min((fit, *spun), key=lambda each: (not each.settled, each.deviance))


def _against(fit: GlobalFit, name: str) -> float:
    """Twice the log of how much more probable the sightings are if an unknown is 0.

    It is the density of what the fit tells of the unknown over that of what was known of it
    beforehand, both at 0 (Dickey, 1971, Annals of Mathematical Statistics 42, 204). So an error
    that places share counts as it does in the unknown's own error, and what a bent map of the
    ice makes of a straight path is not taken for curl.
    """
    k = fit.names.index(name)
    told = -(fit.values[k] ** 2 / fit.cov[k, k] + np.log(fit.cov[k, k]))
    known = -((fit.prior_mean[k] / fit.prior_sd[k]) ** 2 + 2 * np.log(fit.prior_sd[k]))
    return float(told - known)


def _with_others(
    best: GlobalFit, tried: Sequence[GlobalFit], criteria: NDArray[np.float64]
) -> GlobalFit:
    """Put what the fits with other laws say into the errors of the best one.

    Every variance becomes the mean over the fits of their own and of the square of their
    difference from the best. What goes together in the best goes together no longer quite so:
    where whole shots are drawn each is drawn from one of the `choices`.
    """
    weights = np.exp(-0.5 * (criteria - criteria.min()))
    weights /= weights.sum()
    between, variance = np.zeros_like(best.cov), np.zeros(len(best.cov))
    for fit, weight in zip(tried, weights.tolist(), strict=True):
        values, own = _told_by(fit, best)
        off = values - best.values
        between += weight * np.outer(off, off)
        variance += weight * (own + off * off)
    cov = best.cov + between
    scale = np.sqrt(variance / np.diag(cov))
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
    choices = tuple((float(weights[k]), tried[k]) for k in order)
    return replace(best, cov=cov * np.outer(scale, scale), laws=laws, choices=choices)


def _told_by(fit: GlobalFit, best: GlobalFit) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Values and variances of the best fit's unknowns in another; its own where that holds them."""
    values, variance = best.values.copy(), np.diag(best.cov).copy()
    for k, name in enumerate(best.names):
        if name in fit.names:
            rank = fit.names.index(name)
            values[k], variance[k] = fit.values[rank], fit.cov[rank, rank]
    return values, variance


def _name(fit: GlobalFit) -> str:
    """Return the laws of a fit in words."""
    ice = "constant" if "slope" in fit.fixed else "fit"
    if fit.shots[0].ice is penner:
        ice = "penner"
    curl = "none" if "turn" in fit.fixed else "fcv1"
    hits = "stones stick" if "stone_friction" in fit.fixed else "stones slide"
    return f"ice {ice}, curl {curl}, {hits}"


def _start(fit: GlobalFit) -> dict[str, float]:
    """Where the next fit sets out from: all but the friction between stones.

    Under the wrong laws they may have come to stick, from where no slope leads back.
    """
    values = dict(zip(fit.names, fit.values.tolist(), strict=True))
    return {name: value for name, value in values.items() if "stone_friction" not in name}


def _beside(fit: GlobalFit, best: GlobalFit) -> float:
    """Twice the log of how much more probable the best fit makes the sightings than another."""
    return _criterion(fit, best.inflation) - _criterion(best, best.inflation)


def _criterion(fit: GlobalFit, noise: float) -> float:
    """Minus twice the log probability of the sightings, but for what all fits share.

    By Laplace's method (Kass and Raftery, 1995, J. Am. Stat. Assoc. 90, 773).
    """
    known = fit.prior_sd[np.isfinite(fit.prior_sd)]
    sd = np.sqrt(np.diag(fit.cov))  # apart, for determinants leave what numbers can hold
    volume = float(np.linalg.slogdet(fit.cov / np.outer(sd, sd))[1]) + 2 * np.sum(np.log(sd))
    volume -= len(fit.names) * np.log(fit.inflation / noise)
    prior = 2 * np.sum(np.log(known))
    return float(fit.deviance / noise + fit.elsewhere + prior - volume)
