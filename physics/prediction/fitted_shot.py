"""A shot as the fit of the whole of it has it, and what else it may have been."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.physics.prediction.uncertainty import DRAWS, InitialUncertainty, drawn
from curlshot.physics.shot_fit.result import ShotFit, draw_choices
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart, check_shot

Floats = NDArray[np.float64]

RULED_OUT = 20.0
"""Sum of squares of a stone's way off the best fit, in errors of its places, beyond one for each
of their numbers, that cannot be."""

TRIES = 4
"""Draws at most for each that is asked for."""


def by_itself(
    shot: Shot, uncertainty: InitialUncertainty, at: float, count: int = DRAWS
) -> Ensemble:
    """Return a shot that begins at a time, s, with laws and states drawn each by itself."""
    rng = np.random.default_rng(0)
    return Ensemble(at, shot, _sound(drawn(shot, uncertainty, rng) for _ in range(count)))


def fitted_ensemble(
    fit: ShotFit, shot: Shot, uncertainty: InitialUncertainty, at: float, count: int = DRAWS
) -> Ensemble:
    """Return a shot as the fit of the whole of it has it.

    Other shots are drawn from the fits with all choices of laws, by their probabilities, the
    unknowns of each together. Draws whose stones go elsewhere than they were seen are left out:
    the errors are those of a linear fit, which knows nothing of hits that are missed, nor of the
    friction at which stones begin to slide on each other.

    Parameters
    ----------
    fit : ShotFit
        Of one shot.
    shot : Shot
        As it is otherwise known: stones of which the fit knows nothing, angles, spins after hits.
    uncertainty : InitialUncertainty
        The errors of that.
    at : float
        Time of `shot`, s.
    count : int
        Number of draws.

    Raises
    ------
    InputError
        Where it cannot be simulated.
    """
    rng = np.random.default_rng(0)
    seen = fit.shots[0]
    since = at - seen.start

    def joined(other: Shot, own: ShotFit, values: Floats) -> Shot:
        whole = own.shots[0].shot(own.state(values=values))
        known = {stone.name: stone for stone in whole.stones}
        stones = tuple(_joined(stone, known.get(stone.name), since) for stone in other.stones)
        # Of hits a shot without any tells nothing.
        return replace(whole, stones=stones, impact=whole.impact if seen.hits else other.impact)

    likely = joined(shot, fit, fit.values)
    run = simulate(likely, until=since)
    turned = {stone.name: run.state(stone.name, since).theta for stone in shot.stones}
    shot = replace(
        shot, stones=tuple(replace(s, theta=2 * s.theta - turned[s.name]) for s in shot.stones)
    )
    possible = islice(_possible(fit, rng, TRIES * count), count)
    others = _sound(joined(drawn(shot, uncertainty, rng), own, values) for own, values in possible)
    return Ensemble(seen.start, joined(shot, fit, fit.values), others)


def _sound(shots: Iterable[Shot]) -> list[Shot]:
    """Leave out what cannot be: stones that are drawn into one another."""
    found = []
    for shot in shots:
        with suppress(InputError):
            check_shot(shot)
            found.append(shot)
    return found


def _possible(
    fit: ShotFit, rng: np.random.Generator, tries: int
) -> Iterator[tuple[ShotFit, Floats]]:
    """Draw laws and values of their unknowns, and give those that the detections allow."""
    best: dict[int, list[Floats]] = {}
    for own, values in draw_choices(fit, tries, rng):
        if id(own) not in best:
            best[id(own)] = own.shots[0].residuals(own.simulation())
        if _off(own, values, best[id(own)]) < RULED_OUT:
            yield own, values


def _off(fit: ShotFit, values: Floats, best: Sequence[Floats]) -> float:
    """Sum of squares, beyond one for each number, by which they move the stone they move most."""
    seen = fit.shots[0]
    try:
        there = seen.residuals(seen.replay(fit.state(values=values)))
    except InputError:
        return np.inf
    return max(
        float(np.sum((now - then) ** 2 / (fit.inflation + (trace.sd_place / trace.sd) ** 2) - 1))
        for now, then, trace in zip(there, best, seen.traces.values(), strict=True)
    )


def _joined(stone: StoneStart, own: StoneStart | None, since: float) -> StoneStart:
    """Return a stone as it was a time before, s: as the fit has it, else on a straight way."""
    if own is None:
        return replace(stone, x=stone.x - since * stone.vx, y=stone.y - since * stone.vy)
    return replace(own, theta=stone.theta, omega_after=stone.omega_after)
