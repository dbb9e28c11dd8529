"""How well a simulated shot is known: the same shot again and again, within what is not known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.results import MeasuredState, SimulatedHit, StoneState
from curlshot.physics.curl import FCV1Curl
from curlshot.physics.local_fit.traces import shared_correlation
from curlshot.physics.shot_fit.shot_model import STATE
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import HitEvent, Shot, Simulation, StoneStart

Floats = NDArray[np.float64]

DRAWS = 64
"""Simulated shots from which a spread is taken."""

MOMENTS = 40
"""Times at which the spread of the paths is taken; between them it is interpolated."""


@dataclass(frozen=True)
class InitialUncertainty:
    """Standard errors of what a simulated shot begins with.

    Attributes
    ----------
    states : mapping of str to (5,) array
        Of x, y (m), vx, vy (m/s) and the spin (rad/s) of each stone at the start.
    spins_after : mapping of str to tuple of float
        Of the spins after its hits that a stone is given, rad/s.
    restitution, stone_friction : float
        Of the hits.
    friction : float
        Of the ice, as a part of its friction.
    turn : float
        Of the turn of the paths at 1 m/s, rad/s.
    size : float
        Of the stones' radius, as a part of it.
    shared : mapping of str to (2,) array
        Of each stone's place, m, what stones near each other have in common.
    """

    states: dict[str, Floats]
    spins_after: dict[str, tuple[float, ...]]
    restitution: float = 0.0
    stone_friction: float = 0.0
    friction: float = 0.0
    turn: float = 0.0
    size: float = 0.0
    shared: Mapping[str, Floats] = field(default_factory=dict)


def simulated(shots: Iterable[Shot]) -> list[Simulation]:
    """Simulate those of some shots that can be."""
    out = []
    for shot in shots:
        try:
            out.append(simulate(shot))
        except InputError:
            continue
    return out


def simulated_hits(
    run: Simulation, others: Sequence[Simulation], start: float
) -> tuple[SimulatedHit, ...]:
    """Give the hits of a simulation with the spread that they have in others.

    Parameters
    ----------
    run : Simulation
        The one that counts.
    others : sequence of Simulation
        From `simulated`. A hit that fewer than half of them have gets no standard errors.
    start : float
        Time of its beginning in the clip, s.
    """
    by_key: dict[tuple[frozenset[str], int], list[HitEvent]] = {}
    for other in others:
        for key, hit in _keyed(other.hits):
            by_key.setdefault(key, []).append(hit)
    out = []
    for key, hit in _keyed(run.hits):
        same = by_key.get(key, [])
        enough = len(same) > max(len(others) / 2, 2)
        sides = [
            {name: _with_errors(side(hit)[name], [side(h)[name] for h in same if enough])
             for name in hit.stones}
            for side in (_before, _after)
        ]  # fmt: skip
        stderr = float(np.std([h.t for h in same])) if enough else None
        out.append(SimulatedHit(hit.t + start, stderr, hit.stones, *sides))
    return tuple(out)


def path_spread(others: Sequence[Simulation], times: Floats) -> pd.DataFrame:
    """Tell the standard deviations of the simulated states at given times since the start.

    Returns
    -------
    DataFrame
        ``stone, t, sd_x, sd_y, sd_vx, sd_vy, sd_omega``, one row per stone and time; empty for
        fewer than three simulations.
    """
    columns = [f"sd_{name}" for name in STATE]
    if len(others) < 3 or not len(times):
        return pd.DataFrame(columns=["stone", "t", *columns])
    moments = np.linspace(times[0], times[-1], min(MOMENTS, len(times)))
    every = pd.concat([other.sample(moments) for other in others])
    spread = every.groupby(["stone", "t"], sort=True)[list(STATE)].std()
    tables = []
    for stone, group in spread.groupby(level="stone"):
        at = group.index.get_level_values("t").to_numpy(float)
        values = {f"sd_{name}": np.interp(times, at, group[name]) for name in STATE}
        tables.append(pd.DataFrame({"stone": stone, "t": times, **values}))
    return pd.concat(tables, ignore_index=True)


def drawn(shot: Shot, uncertainty: InitialUncertainty, rng: np.random.Generator) -> Shot:
    """Return a shot with all that is doubtful drawn from normal distributions.

    What is drawn is independent but for what places share: stones near each other move together
    (`curlshot.physics.local_fit.traces.shared_correlation`).
    """
    together = _together(shot, uncertainty, rng)
    stones = tuple(
        _moved(stone, uncertainty, by, rng) for stone, by in zip(shot.stones, together, strict=True)
    )
    known = {item.name for item in fields(shot.impact)}  # type: ignore[arg-type]
    laws: dict[str, float] = {}
    for name, sd, top in (
        ("restitution", uncertainty.restitution, 1.0),
        ("stone_friction", uncertainty.stone_friction, np.inf),
    ):
        if name in known:
            value = getattr(shot.impact, name) + sd * rng.standard_normal()
            laws[name] = float(np.clip(value, 0.0, top))
    impact: Any = replace(shot.impact, **laws)  # type: ignore[type-var]
    factor = max(1.0 + uncertainty.friction * rng.standard_normal(), 0.1)
    radius = shot.radius * (1.0 + uncertainty.size * rng.standard_normal())
    curl = shot.curl
    if uncertainty.turn > 0 and isinstance(curl, FCV1Curl):
        curl = replace(curl, turn=curl.turn + uncertainty.turn * rng.standard_normal())
    ice = shot.ice.scaled(factor)
    return replace(shot, stones=stones, impact=impact, ice=ice, curl=curl, radius=radius)


def _together(shot: Shot, uncertainty: InitialUncertainty, rng: np.random.Generator) -> Floats:
    """Draw what the places share: displacements of all stones, shape (n, 2), m."""
    xy = np.array([(stone.x, stone.y) for stone in shot.stones])
    size = np.array([uncertainty.shared.get(stone.name, np.zeros(2)) for stone in shot.stones])
    shared = rng.multivariate_normal(np.zeros(len(xy)), shared_correlation(xy), 2, method="eigh").T
    return np.asarray(size * shared)


def _moved(
    stone: StoneStart, uncertainty: InitialUncertainty, together: Floats, rng: np.random.Generator
) -> StoneStart:
    values = np.array([getattr(stone, name) for name in STATE])
    sd = uncertainty.states[stone.name].copy()
    sd[:2] = np.sqrt(
        np.maximum(sd[:2] ** 2 - uncertainty.shared.get(stone.name, np.zeros(2)) ** 2, 0.0)
    )
    moved = values + sd * rng.standard_normal(len(STATE))
    moved[:2] += together
    after = stone.omega_after
    errors = uncertainty.spins_after.get(stone.name, ())
    if isinstance(after, tuple) and len(after) == len(errors):
        after = tuple(
            (np.array(after) + np.array(errors) * rng.standard_normal(len(errors))).tolist()
        )
    return replace(stone, **dict(zip(STATE, moved.tolist(), strict=True)), omega_after=after)


def _keyed(hits: Sequence[HitEvent]) -> Iterator[tuple[tuple[frozenset[str], int], HitEvent]]:
    """Pair each hit with whom it is of and how many of the two came before it."""
    seen: Counter[frozenset[str]] = Counter()
    for hit in hits:
        pair = frozenset(hit.stones)
        yield (pair, seen[pair]), hit
        seen[pair] += 1


def _before(hit: HitEvent) -> dict[str, StoneState]:
    return dict(hit.before)


def _after(hit: HitEvent) -> dict[str, StoneState]:
    return dict(hit.after)


def _with_errors(state: StoneState, others: Sequence[StoneState]) -> MeasuredState:
    known = state.x, state.y, state.vx, state.vy, state.omega
    if not others:
        return MeasuredState(*known)
    spread = np.std([[getattr(o, name) for name in STATE] for o in others], axis=0).tolist()
    return MeasuredState(*known, *spread)
