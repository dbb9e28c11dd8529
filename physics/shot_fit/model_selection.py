"""The whole shot fitted once: which law of the ice and whether curl shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from curlshot.data.results import Estimate, Law
from curlshot.data.sheet import curling_size
from curlshot.physics.filter.slowing import V_C
from curlshot.physics.shot_fit.global_fit import LOST, fit_shots
from curlshot.physics.shot_fit.observed import THROWN
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.physics.shot_fit.shot_model import ObservedShot, penner

STRAIGHT = {"slope": 0.0, "v_c": V_C, "turn": 0.0}
"""Constant friction and no curl: one of two ways that a first fit sets out from, and what unknowns
of the ice are without."""

STICKING = {"stone_friction": 2.0}
"""Stones that stop sliding on each other before they part: any greater friction does the same."""

ROUGH = 0.2
"""Friction with which stones stick in most hits: the most that simulators take."""

USUAL = {"slope": 0.002, "turn": 0.008}
"""Ice as in FCV1 (Uehara and Ito, 2021), from where the first fit sets out beside even ice: stones
that go straight may miss each other."""

BEFORE = 0.1
"""How long before a hit a part of the shot ends that is to be without it, s: its time is not
certain."""

ELSEWHERE = 0.5
"""By how much of the deviance of a fit that of one with fewer unknowns is larger, beyond what noise
does, if it has come to rest at another place: what the first tells of the unknowns does not hold
there."""

ALIKE = 0.3
"""Part of its error by which an unknown differs, at most, in two fits that are one."""

SELDOM = 9.0
"""Twice the log of odds beyond which other laws do not count."""


def fit_with_chosen_laws(shot: ObservedShot, fixed: Mapping[str, float] | None = None) -> ShotFit:
    """Fit a shot with the laws that the detections ask for, some unknowns held if `fixed`.

    First friction depends on the speed and the paths curl. Each of the two is left out, and
    friction between stones is, where the detections are the more probable without: then the
    friction is constant, the paths are straight, the stones stick. A wrong law would lead the
    others astray if they were taken up one after the other.

    What the other choices of laws would give is in the errors, each by its probability
    (Buckland et al., 1997, Biometrics 53, 603). So is what Penner's law gives where friction
    falls: the one that is reported follows any ice but not to the last per cent.
    """
    held = {"v_c": V_C, **(fixed or {})}
    first, *others = _either_sense(shot, held)
    places = [_with_laws(first, held, 0.0, fixed or {})]
    places += [_with_laws(other, held, _beside(other, first), fixed or {}) for other in others]
    best = min(places, key=lambda place: place.least).best
    every = [pair for place in places for pair in zip(place.criteria, place.fits, strict=True)]
    criteria, fits = zip(*_distinct(every, best), strict=True)
    return _with_others(best, fits, np.array(criteria))


def _with_laws(
    fit: ShotFit, held: dict[str, float], criterion: float, fixed: Mapping[str, float]
) -> _Tried:
    """Try the laws that a fit may do with or without, from where it came to rest."""
    tried = _Tried([fit], [criterion], held)
    _leave_out(tried)
    falls = "slope" in tried.best.names and "v_c" not in fixed
    if falls:
        _let_bend(tried)
    if fit.shots[0].hits:
        stuck = tried.refitted(tried.held | STICKING)
        if stuck.settled:
            tried.add(stuck, tried.least + _beside(stuck, tried.best), tried.held | STICKING)
    if falls:
        # Beside stones that do not slide as these do no other ice would fit either.
        even = {"slope": 0.0, "v_c": V_C, **tried.held}
        uneven = replace(fit.shots[0], ice=penner)  # it needs no slope to be so
        start, noise = _values(tried.best), tried.best.inflation
        rooted = fit_shots([uneven], fixed=even, start=start, noise=noise)
        if rooted.settled:
            tried.add(rooted, tried.least + _beside(rooted, tried.best))
    return tried


def _distinct(every: Sequence[tuple[float, ShotFit]], best: ShotFit) -> list[tuple[float, ShotFit]]:
    """Leave out fits that came to the same place as another by the same laws: they count once."""
    kept: list[tuple[float, ShotFit]] = []
    for criterion, fit in sorted(every, key=lambda pair: (pair[0], pair[1] is not best)):
        if not any(_same(fit, other) for _, other in kept):
            kept.append((criterion, fit))
    return kept


def _same(one: ShotFit, two: ShotFit) -> bool:
    """Whether two fits have the same laws and values, but for a friction that neither tells."""
    names, others = (
        [name for name in fit.names if name != "stone_friction" or fit.identifies(name)]
        for fit in (one, two)
    )
    if names != others or one.shots[0].ice is not two.shots[0].ice:
        return False
    at = [one.names.index(name) for name in names]
    there = [two.names.index(name) for name in names]
    off = np.abs(one.values[at] - two.values[there])
    return bool((off < ALIKE * np.sqrt(np.diag(two.cov)[there])).all())


@dataclass
class _Tried:
    """Fits of a shot with some laws and others, and the best of them.

    Attributes
    ----------
    fits : list of ShotFit
    criteria : list of float
        Of each, minus twice the log probability of the detections, but for what all share.
    held : dict
        Unknowns that the best holds, and at what.
    rank : int
        Of the best.
    """

    fits: list[ShotFit]
    criteria: list[float]
    held: dict[str, float]
    rank: int = 0

    @property
    def best(self) -> ShotFit:
        """The fit that makes the detections most probable, of those that may be the best."""
        return self.fits[self.rank]

    @property
    def least(self) -> float:
        """Its criterion."""
        return self.criteria[self.rank]

    def add(self, fit: ShotFit, criterion: float, held: dict[str, float] | None = None) -> None:
        """Count a fit in; it is the best from then on if it is better, and says what it holds."""
        if held is not None and criterion < self.least:
            self.held, self.rank = held, len(self.fits)
        self.fits.append(fit)
        self.criteria.append(criterion)

    def refitted(self, held: Mapping[str, float]) -> ShotFit:
        """Fit with other laws from where the best fit has them, with the noise that it has told."""
        best = self.best
        return fit_shots(best.shots, fixed=held, start=_values(best, held), noise=best.inflation)


def _leave_out(tried: _Tried) -> None:
    """Try without friction that falls and paths that curl, what speaks most against it first."""
    asked = [name for name in ("slope", "turn") if name in tried.best.names]
    while asked:
        best = tried.best
        against = {name: _against(best, name) for name in asked}
        name = max(asked, key=lambda each: against[each])
        asked.remove(name)
        if against[name] < -SELDOM:
            continue
        held = {**tried.held, name: STRAIGHT[name]}
        less = tried.refitted(held)
        more = less.deviance - best.deviance
        if less.settled and more <= max(ELSEWHERE * best.deviance, SELDOM * best.inflation):
            tried.add(less, tried.least - against[name], held)


def _let_bend(tried: _Tried) -> None:
    """Find the speed about which friction falls, and take that fit for the best."""
    free = {name: value for name, value in tried.held.items() if name != "v_c"}
    bent = tried.refitted(free)
    if bent.settled:
        tried.fits[tried.rank], tried.held = bent, free


def _either_sense(shot: ObservedShot, held: Mapping[str, float]) -> list[ShotFit]:
    """Fit a shot with spins that nobody saw of either sense, the better first.

    A path curls to the side to which its stone spins, which after a hit may be the other, and no
    slope leads across: what is known of a spin that does nothing else would draw it to none. The
    worse fit counts too, if it came as far. Other discs than curling stones may not spin at all.
    """
    ways = [shot.spinning(Estimate(sense * THROWN, THROWN)) for sense in (1, -1)]
    if not (shot.hits and curling_size(shot.radius)) or ways[0].unknowns == ways[1].unknowns:
        return [_hit_by_hit(shot, held)]
    fits = [_hit_by_hit(way, held) for way in ways]
    best = _best_of(fits)
    return [best, *(fit for fit in fits if fit is not best and _as_good(fit, best))]


def _as_good(fit: ShotFit, best: ShotFit) -> bool:
    """Whether a fit came as far as another: to its end, with the hits that were seen."""
    return (fit.settled, fit.hits_as_seen) >= (best.settled, best.hits_as_seen)


def _hit_by_hit(shot: ObservedShot, held: Mapping[str, float]) -> ShotFit:
    """Fit a shot up to its second hit, then up to the next, each from where the one before ended.

    From first guesses stones would miss what they hit later, from where no slope leads back. Nor
    does one from stones that stick to such as slide, or from a spin that is lost before a hit to
    another: fits set out from sliding too, from spins of either sense, the first from even ice.
    """
    start = {name: value for name, value in USUAL.items() if name not in held}
    apart = [two for one, two in pairwise(shot.times) if two - one > 2 * BEFORE]
    best: ShotFit | None = None
    for part in [*(shot.until(time - BEFORE) for time in apart), shot]:
        own = {unknown.name for unknown in part.unknowns}
        known = {name: value for name, value in start.items() if name in own}
        further = {n: v for n, v in known.items() if n != "stone_friction"}
        if best is None:
            further = _values(fit_shots([part], fixed={**STRAIGHT, **held}))
        best = _best(part, held, [known, further])
        none = [n for n in best.names if n.endswith("omega") and abs(best[n].value or 0.0) < LOST]
        if none and part.hits:
            ways = [further | dict.fromkeys(none, omega) for omega in (-THROWN, THROWN)]
            best = _best(part, held, ways, best)
        if "stone_friction" in best.names:
            ways = [_values(best) | {"stone_friction": other} for other in (0.0, ROUGH)]
            best = _best(part, held, ways, best)
        start |= _values(best)
    assert best is not None
    return best


def _best(
    shot: ObservedShot,
    held: Mapping[str, float],
    ways: Sequence[dict[str, float]],
    *others: ShotFit,
) -> ShotFit:
    """Fit a shot from where each of the ways sets out, and return the best, or another's."""
    fits = [*others]
    for way in ways:
        fits.append(fit_shots([shot], fixed=held, start=way, ends=fits))
    return _best_of(fits)


def _best_of(fits: Sequence[ShotFit]) -> ShotFit:
    """Return the fit that explains a shot best: of those that settle, with the hits as seen."""
    noise = min(fit.inflation for fit in fits)
    return min(fits, key=lambda fit: (not fit.settled, not fit.hits_as_seen, _cost(fit, noise)))


def _cost(fit: ShotFit, noise: float) -> float:
    """Least squares of a fit: its detections' with that much noise, and what else it heeds."""
    return fit.deviance / noise + fit.elsewhere


def _against(fit: ShotFit, name: str) -> float:
    """Twice the log of how much more probable the detections are if an unknown is 0.

    It is the density of what the fit tells of the unknown over that of what was known of it
    beforehand, both at 0 (Dickey, 1971, Annals of Mathematical Statistics 42, 204). So an error
    that places share counts as it does in the unknown's own error, and what a bent map of the
    ice makes of a straight path is not taken for curl.
    """
    k = fit.names.index(name)
    told = -(fit.values[k] ** 2 / fit.cov[k, k] + np.log(fit.cov[k, k]))
    known = -((fit.prior_mean[k] / fit.prior_sd[k]) ** 2 + 2 * np.log(fit.prior_sd[k]))
    return float(told - known)


def _with_others(best: ShotFit, tried: Sequence[ShotFit], criteria: NDArray[np.float64]) -> ShotFit:
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
            _name(tried[k], best),
            float(criteria[k] - criteria.min()),
            float(weights[k]),
            tried[k]["friction"] if tried[k].identifies("friction") else Estimate(),
        )
        for k in order
    )
    choices = tuple((float(weights[k]), tried[k]) for k in order)
    return replace(best, cov=cov * np.outer(scale, scale), laws=laws, choices=choices)


def _told_by(fit: ShotFit, best: ShotFit) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Values and variances of the best fit's unknowns in another; its own where that holds them."""
    values, variance = best.values.copy(), np.diag(best.cov).copy()
    for k, name in enumerate(best.names):
        if name in fit.names:
            rank = fit.names.index(name)
            values[k], variance[k] = fit.values[rank], fit.cov[rank, rank]
    return values, variance


def _name(fit: ShotFit, best: ShotFit) -> str:
    """Return the laws of a fit in words, and whether it expects spins the other way round."""
    ice = "constant" if "slope" in fit.fixed else "fit"
    if fit.shots[0].ice is penner:
        ice = "penner"
    curl = "none" if "turn" in fit.fixed else "fcv1"
    hits = "stones stick" if "stone_friction" in fit.fixed else "stones slide"
    other = fit.shots[0].unknowns != best.shots[0].unknowns
    return f"ice {ice}, curl {curl}, {hits}" + ", spins of the other sense" * other


def _values(fit: ShotFit, held: Mapping[str, float] = MappingProxyType({})) -> dict[str, float]:
    """Where the next fit sets out from: what this one tells, if the ice is as it is held.

    Without a slope friction is another, and speeds with it: from where they are with one a fit may
    come to rest on the way.
    """
    known = [name for name in STRAIGHT if name in held and name in fit.names]
    at = [fit.names.index(name) for name in known]
    aside = np.array([held[name] for name in known]) - fit.values[at]
    values = fit.values + fit.cov[:, at] @ np.linalg.solve(fit.cov[np.ix_(at, at)], aside)
    return dict(zip(fit.names, values.tolist(), strict=True))


def _beside(fit: ShotFit, best: ShotFit) -> float:
    """Twice the log of how much more probable the best fit makes the detections than another."""
    return _criterion(fit, best.inflation) - _criterion(best, best.inflation)


def _criterion(fit: ShotFit, noise: float) -> float:
    """Minus twice the log probability of the detections, but for what all fits share.

    By Laplace's method (Kass and Raftery, 1995, J. Am. Stat. Assoc. 90, 773).
    """
    known = fit.prior_sd[np.isfinite(fit.prior_sd)]
    sd = np.sqrt(np.diag(fit.cov))  # apart, for determinants leave what numbers can hold
    volume = float(np.linalg.slogdet(fit.cov / np.outer(sd, sd))[1]) + 2 * np.sum(np.log(sd))
    volume -= len(fit.names) * np.log(fit.inflation / noise)
    prior = 2 * np.sum(np.log(known))
    return float(_cost(fit, noise) + prior - volume)
