"""What if the stone had been thrown a little differently: changes, samples, odds."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import ndtri

from data.errors import InputError
from data.progress import Progress, no_progress
from data.sheet import GRAVITY, HOUSE
from physics.curl import Curl, FCV1Curl
from physics.ice import IceLaw
from physics.prediction.laws import Scaled
from physics.prediction.start import Start, speed_before
from physics.simulator.many import simulate_many
from physics.simulator.simulation import States, StoneStart

Array = NDArray[np.float64]

THROW_SD = (0.0076, 0.0018)
"""What players are off by as they let go: speed (m/s) and direction (rad)."""
FASTEST_THROW, MOST_SPIN = 10.0, 20.0
"""Speed (m/s) and spin (rad/s) beyond which a throw is a mistake."""
LAWS = 64
"""Equally likely pairs of the ice's friction and of its curl: equal ones share work."""


@dataclass(frozen=True)
class Amount:
    """A value to set, or where `relative` a factor to multiply by."""

    value: float
    relative: bool = False

    def of(self, present: float) -> float:
        """Return the new value in place of the present one."""
        return self.value * present if self.relative else self.value


@dataclass(frozen=True)
class Changes:
    """What is to be different; None leaves it as it was.

    Attributes
    ----------
    restitution, friction : float, optional
        Of the hits, and of the ice at 1 m/s.
    speed, spin : Amount, optional
        Of the thrown stone at the start, m/s and rad/s.
    aim_offset : float
        Distance by which the way of the thrown stone is moved to its left, m.
    """

    restitution: float | None = None
    friction: float | None = None
    speed: Amount | None = None
    spin: Amount | None = None
    aim_offset: float = 0.0


@dataclass(frozen=True)
class Odds:
    """Where one stone comes to rest: mean and spread (m), and how often (0..1).

    Mean and spread are those of the samples in which it stays ``in_play``; None if it never does,
    the spread also if it does once. Without a sheet there is none to stay on, nor a house to be in
    for discs that are no curling stones and where places do not count from its tee.
    """

    x: float | None
    y: float | None
    sd_x: float | None
    sd_y: float | None
    moved: float
    in_play: float | None
    in_house: float | None
    shot_stone: float | None


def changed(start: Start, changes: Changes) -> Start:
    """Return the start with the changes made; what is set is known exactly.

    Raises
    ------
    InputError
        Where the thrown stone would begin on top of another or off the sheet, or be faster
        than any.
    """
    shot = start.shot
    if changes.restitution is not None:
        impact: Any = replace(shot.impact, restitution=changes.restitution)  # type: ignore[type-var]
        shot, start = replace(shot, impact=impact), replace(start, sd_restitution=0.0)
    if changes.friction is not None:
        present = float(shot.ice.deceleration(1.0)) / GRAVITY
        ice = Scaled(shot.ice, changes.friction / present)
        shot, start = replace(shot, ice=ice), replace(start, sd_friction=0.0)
    stones = list(shot.stones)
    stones[start.thrown] = stone = _thrown(stones[start.thrown], changes)
    if changes.aim_offset:
        if shot.bounds is not None and shot.bounds.beyond(stone.x, stone.y, shot.radius) > 0:
            raise InputError(
                f"aim offset {changes.aim_offset:g} m: {stone.name} would begin off the sheet;"
                " choose another"
            )
        for other in stones:
            apart = math.dist((stone.x, stone.y), (other.x, other.y))
            if other is not stone and apart < 2 * shot.radius:
                raise InputError(
                    f"aim offset {changes.aim_offset:g} m: {stone.name} would begin on top of"
                    f" {other.name}; choose another"
                )
    return replace(start, shot=replace(shot, stones=tuple(stones)))


def sample(
    start: Start,
    count: int,
    throw_sd: tuple[float, float] = THROW_SD,
    progress: Progress = no_progress,
) -> pd.DataFrame:
    """Simulate a shot many times, each a little off.

    States, restitution, frictions, curl and the distance at which stones meet are drawn from their
    standard errors, speed and direction of the throw from what players are off by; their errors
    grow on the way to the start.

    Parameters
    ----------
    start : Start
        The shot and what is not known of it.
    count : int
        Number of samples.
    throw_sd : (float, float)
        Standard deviations of speed (m/s) and direction (rad) of the stone as it is let go.
    progress : callable
        Called as the work goes on.

    Returns
    -------
    DataFrame
        ``sample, stone, x, y, hits, in_play``: places of rest, m, hits of each stone, and 0
        for one that has left the sheet at that place.
    """
    rng = np.random.default_rng(0)
    shot = start.shot
    places = States.of(shot, count)
    for item, sd in zip(fields(places), start.sd.T, strict=True):
        getattr(places, item.name)[:] += sd * rng.standard_normal((count, len(sd)))
    none = np.zeros(len(shot.stones))
    # The errors that places share are drawn once for all stones, for x and for y.
    shared = rng.multivariate_normal(none, start.together, (2, count), method="eigh")
    places.x[:] += shared[0]
    places.y[:] += shared[1]
    rank = rng.permutation(np.arange(count) % LAWS)
    pairs = _laws(start, rng)
    _throw(start, places, throw_sd, rng)
    vary = {}
    for name, sd, top in (
        ("restitution", start.sd_restitution, 1.0),
        ("stone_friction", start.sd_stone_friction, np.inf),
    ):
        if sd > 0:  # which says that the model has it
            mean = float(getattr(shot.impact, name))
            vary[name] = np.clip(mean + sd * rng.standard_normal(count), 0.0, top)
    ice, curl = ([pair[k] for pair in (pairs[r] for r in rank)] for k in range(2))
    radius = shot.radius * (1 + start.sd_size * rng.standard_normal(count))
    done = simulate_many(
        shot, places, ice=ice, curl=curl, radius=radius, vary=vary, progress=progress
    )
    names = [stone.name for stone in shot.stones]
    return pd.DataFrame(
        {
            "sample": np.repeat(np.arange(count), len(names)),
            "stone": np.tile(np.array(names, object), count).astype(str),
            "x": done.x.ravel(),
            "y": done.y.ravel(),
            "hits": done.hits.ravel(),
            "in_play": done.in_play.ravel().astype(int),
        }
    )


def _laws(start: Start, rng: np.random.Generator) -> list[tuple[IceLaw, Curl]]:
    """Return as many equally likely pairs of ice and curl, or the one that is known."""
    shot, steps = start.shot, ndtri((np.arange(LAWS) + 0.5) / LAWS)
    ice: list[IceLaw] = [shot.ice] * LAWS
    curl: list[Curl] = [shot.curl] * LAWS
    if start.sd_friction > 0:
        factors = np.maximum(1 + start.sd_friction * steps, 0.1)
        ice = [Scaled(shot.ice, factor) for factor in factors.tolist()]
    if start.sd_turn > 0 and isinstance(shot.curl, FCV1Curl):
        turns = shot.curl.turn + start.sd_turn * rng.permutation(steps)
        curl = [replace(shot.curl, turn=turn) for turn in turns.tolist()]
    return list(zip(ice, curl, strict=True))


def odds(outcomes: pd.DataFrame, start: Start) -> dict[str, Odds]:
    """Sum up the outcomes of `sample` by stone.

    A stone is in the house if it reaches over the 12-ft ring; shot stone is the one of them
    that is nearest to the tee.
    """
    names = [stone.name for stone in start.shot.stones]
    x = outcomes["x"].to_numpy(float).reshape(-1, len(names))
    y = outcomes["y"].to_numpy(float).reshape(-1, len(names))
    hits = outcomes["hits"].to_numpy().reshape(-1, len(names))
    in_play = outcomes["in_play"].to_numpy(bool).reshape(-1, len(names))
    distance = np.where(in_play, np.hypot(x, y), np.inf)
    inside = distance < HOUSE.twelve_foot + start.shot.radius
    nearest = np.where(inside, distance, np.inf).argmin(axis=1)
    out = {}
    for k, stone in enumerate(start.shot.stones):
        moved = (hits[:, k] > 0) | (math.hypot(stone.vx, stone.vy) > 0)
        out[stone.name] = Odds(
            **_spread(x[in_play[:, k], k], y[in_play[:, k], k]),
            moved=float(moved.mean()),
            in_play=None if start.shot.bounds is None else float(in_play[:, k].mean()),
            in_house=float(inside[:, k].mean()) if start.house else None,
            shot_stone=float((inside[:, k] & (nearest == k)).mean()) if start.house else None,
        )
    return out


def _spread(x: Array, y: Array) -> dict[str, float | None]:
    """Mean and standard deviation of places, m; None of none."""
    if not len(x):
        return dict.fromkeys(("x", "y", "sd_x", "sd_y"))
    return {
        "x": float(x.mean()),
        "y": float(y.mean()),
        "sd_x": float(x.std()) if len(x) > 1 else None,
        "sd_y": float(y.std()) if len(y) > 1 else None,
    }


def _thrown(stone: StoneStart, changes: Changes) -> StoneStart:
    """Return the thrown stone with the changes made."""
    speed = math.hypot(stone.vx, stone.vy)
    if speed == 0:
        return stone
    ux, uy = stone.vx / speed, stone.vy / speed
    speed = changes.speed.of(speed) if changes.speed else speed
    spin = changes.spin.of(stone.omega) if changes.spin else stone.omega
    if changes.speed and speed > FASTEST_THROW:
        raise InputError(
            f"speed: {stone.name} would be thrown at {speed:.3g} m/s; at most {FASTEST_THROW:g}"
        )
    if changes.spin and abs(spin) > MOST_SPIN:
        raise InputError(
            f"spin: {stone.name} would turn at {spin:.3g} rad/s; at most {MOST_SPIN:g}"
        )
    return replace(
        stone,
        x=stone.x - changes.aim_offset * uy,
        y=stone.y + changes.aim_offset * ux,
        vx=speed * ux,
        vy=speed * uy,
        omega=spin,
    )


def _throw(
    start: Start, places: States, throw_sd: tuple[float, float], rng: np.random.Generator
) -> None:
    """Put the errors of the throw, grown on the way from the release, onto the thrown stone."""
    k, count = start.thrown, len(places.x)
    vx, vy = places.vx[:, k], places.vy[:, k]
    speed, heading = np.hypot(vx, vy), np.arctan2(vy, vx)
    if not speed.any():
        return
    faster, turned = (sd * rng.standard_normal(count) for sd in throw_sd)
    let_go = speed_before(speed, start.release, start.shot.ice)
    speed = speed_before(np.maximum(let_go + faster, 0.0), -start.release, start.shot.ice)
    places.x[:, k] -= start.release * turned * np.sin(heading)
    places.y[:, k] += start.release * turned * np.cos(heading)
    places.vx[:, k] = speed * np.cos(heading + turned)
    places.vy[:, k] = speed * np.sin(heading + turned)
