"""What if the stone had been thrown a little differently: changes, samples, odds."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.limits import FRACTION, FRICTION, OFFSET, SPEED, SPIN, Limits
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import HOUSE
from curlshot.physics.prediction.laws import friction_at_1
from curlshot.physics.prediction.start import Start, speed_before
from curlshot.physics.simulator.many import simulate_many
from curlshot.physics.simulator.simulation import Shot, States

Array = NDArray[np.float64]

THROW_SD = (0.0076, 0.0018)
"""What players are off by as they let go: speed (m/s) and direction (rad)."""
FASTEST_THROW, MOST_SPIN = 10.0, 20.0
"""Speed (m/s) and spin (rad/s) beyond which a throw is a mistake."""


@dataclass(frozen=True)
class Amount:
    """A value to set, or where `relative` a factor to multiply by."""

    value: float
    relative: bool = False

    def of(self, present: float) -> float:
        """Return the new value in place of the present one."""
        return self.value * present if self.relative else self.value


def amount_of(given: float | str | Amount, limits: Limits) -> Amount:
    """Return what a person gives, a number or a factor such as ``"1.1x"``, as an amount.

    Raises
    ------
    InputError
        Where it is neither, or lies outside of the limits.

    Examples
    --------
    >>> from curlshot.data.limits import SPEED
    >>> amount_of("1.1x", SPEED).of(2.0)
    2.2
    """
    if isinstance(given, Amount):
        return given
    text = str(given)
    number = text.removesuffix("x")
    try:
        value = math.nan if isinstance(given, bool) else float(number)
    except ValueError:
        value = math.nan
    if not limits.allow(value):
        raise InputError(
            f"{text!r} is not {limits.what}, nor a factor such as 1.1x, at most {limits.high:g}x"
        )
    return Amount(value, number != text)


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

    @classmethod
    def of(
        cls,
        *,
        restitution: float | None = None,
        friction: float | None = None,
        speed: float | str | Amount | None = None,
        spin: float | str | Amount | None = None,
        aim_offset: float = 0.0,
    ) -> Changes:
        """Return the changes that a person asks for.

        Raises
        ------
        InputError
            A value that makes no sense.
        """
        for name, value, limits in (
            ("restitution", restitution, FRACTION), ("friction", friction, FRICTION),
            ("aim_offset", aim_offset, OFFSET),
        ):  # fmt: skip
            if value is not None or name == "aim_offset":
                limits.check(f"`{name}`", value)
        amounts: dict[str, Amount | None] = {}
        for name, given, limits in (("speed", speed, SPEED), ("spin", spin, SPIN)):
            try:
                amounts[name] = None if given is None else amount_of(given, limits)
            except InputError as error:
                raise InputError(f"`{name}`: {error}") from None
        return cls(restitution, friction, **amounts, aim_offset=float(aim_offset))


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
    shot, *others = (
        _changed(other, start.thrown, changes) for other in (start.shot, *start.others)
    )
    stone = shot.stones[start.thrown]
    speed = math.hypot(stone.vx, stone.vy)
    if changes.speed and speed > FASTEST_THROW:
        raise InputError(
            f"`speed`: {stone.name} would be thrown at {speed:.3g} m/s; at most {FASTEST_THROW:g}"
        )
    if changes.spin and abs(stone.omega) > MOST_SPIN:
        raise InputError(
            f"`spin`: {stone.name} would turn at {stone.omega:.3g} rad/s; at most {MOST_SPIN:g}"
        )
    if changes.aim_offset:
        if shot.bounds is not None and shot.bounds.beyond(stone.x, stone.y, shot.radius) > 0:
            raise InputError(
                f"`aim_offset` {changes.aim_offset:g}: {stone.name} would start outside the"
                " sheet; choose another"
            )
        for other in shot.stones:
            apart = math.dist((stone.x, stone.y), (other.x, other.y))
            if other is not stone and apart < 2 * shot.radius:
                raise InputError(
                    f"`aim_offset` {changes.aim_offset:g}: {stone.name} would start on top of"
                    f" {other.name}; choose another"
                )
    told = {
        "restitution": changes.restitution is not None,
        "friction": changes.friction is not None,
        f"spin of {stone.name}": changes.spin is not None and not changes.spin.relative,
    }
    assumed = {name: text for name, text in start.assumed.items() if not told.get(name)}
    return replace(start, shot=shot, others=tuple(others), assumed=assumed)


def sample(
    start: Start,
    count: int,
    throw_sd: tuple[float, float] = THROW_SD,
    progress: Progress = no_progress,
) -> pd.DataFrame:
    """Simulate a shot many times, each a little off.

    Each throw is of one of the shots that it may be, in turn; speed and direction are drawn from
    what players are off by, whose errors grow on the way to the start.

    Parameters
    ----------
    start : Start
        The shot and what it may be as well.
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
    shot, shots = start.shot, start.others or (start.shot,)
    picked = [shots[k] for k in rng.permutation(np.arange(count) % len(shots)).tolist()]
    places = States(
        *(
            np.array([[getattr(s, item.name) for s in one.stones] for one in picked], float)
            for item in fields(States)
        )
    )
    _throw(start, places, throw_sd, rng)
    done = simulate_many(
        shot,
        places,
        ice=[one.ice for one in picked],
        curl=[one.curl for one in picked],
        radius=[one.radius for one in picked],
        vary={
            item.name: [getattr(one.impact, item.name) for one in picked]
            for item in fields(shot.impact)  # type: ignore[arg-type]
        },
        progress=progress,
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


def _changed(shot: Shot, thrown: int, changes: Changes) -> Shot:
    """Return a shot with the changes made."""
    if changes.restitution is not None:
        impact: Any = replace(shot.impact, restitution=changes.restitution)  # type: ignore[type-var]
        shot = replace(shot, impact=impact)
    if changes.friction is not None:
        present = friction_at_1(shot.ice)
        shot = replace(shot, ice=shot.ice.scaled(changes.friction / present))
    stones = list(shot.stones)
    stone = stones[thrown]
    speed = math.hypot(stone.vx, stone.vy)
    if speed == 0:
        return shot
    ux, uy = stone.vx / speed, stone.vy / speed
    speed = changes.speed.of(speed) if changes.speed else speed
    stones[thrown] = replace(
        stone,
        x=stone.x - changes.aim_offset * uy,
        y=stone.y + changes.aim_offset * ux,
        vx=speed * ux,
        vy=speed * uy,
        omega=changes.spin.of(stone.omega) if changes.spin else stone.omega,
    )
    return replace(shot, stones=tuple(stones))


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
