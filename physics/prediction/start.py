"""The measured shot as it stood just before its first hit, with what is not known of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from data.errors import InputError
from data.results import Estimate, MeasuredState, Results
from data.sheet import SHEET, STONE, curling_size
from physics.curl import NoCurl
from physics.ice import IceLaw
from physics.local_fit.traces import shared_correlation
from physics.prediction.laws import measured_laws
from physics.prediction.throws import first_hit, newcomers
from physics.simulator.bounds import Bounds
from physics.simulator.curve import Curve, curve_for
from physics.simulator.motion import Motion, Path
from physics.simulator.simulation import Shot, StoneStart
from physics.whole_shot.priors import SPIN
from physics.whole_shot.shot_model import STATE
from physics.whole_shot.watched import THROWN

Array = NDArray[np.float64]

BACK = 1.0
"""How far the thrown stone is taken back from its first hit, m, to have room for changes."""
HOG_TO_TEE = SHEET.far_tee - SHEET.hog_line
"""From the hog line where the stone is let go to the tee, m."""


@dataclass(frozen=True)
class Start:
    """A shot before its first hit.

    Attributes
    ----------
    shot : Shot
        The stones and the laws.
    thrown : int
        Rank of the thrown stone.
    sd : ndarray, shape (stones, 5)
        Standard errors of x, y, vx, vy, omega of each stone, without what places share.
    together : ndarray, shape (stones, stones)
        Covariance of what the places of the stones share, m², on either axis.
    sd_restitution, sd_stone_friction, sd_friction, sd_turn, sd_size : float
        Standard errors of restitution, of the friction between stones, of the ice's friction
        relative to it, of the turn of the paths at 1 m/s, rad/s, and of the distance at which
        stones meet, relative to it.
    release : float
        Distance that the thrown stone has come since it was let go, m.
    house : bool
        Whether places count from the tee of a house.
    assumed : tuple of str
        What had to be assumed.
    """

    shot: Shot
    thrown: int
    sd: Array
    together: Array
    sd_restitution: float = 0.0
    sd_stone_friction: float = 0.0
    sd_friction: float = 0.0
    sd_turn: float = 0.0
    sd_size: float = 0.0
    release: float = 0.0
    house: bool = True
    assumed: tuple[str, ...] = ()


def written_start(shot: Shot) -> Start:
    """Return a shot written by hand: known exactly, let go where it begins."""
    count = len(shot.stones)
    return Start(
        shot,
        _fastest(shot.stones),
        np.zeros((count, len(STATE))),
        np.zeros((count, count)),
        house=curling_size(shot.radius),
    )


def measured_start(tracks: pd.DataFrame, results: Results) -> Start:
    """Return a measured shot as it stood just before its first hit.

    Parameters
    ----------
    tracks : DataFrame
        `data.tracks.TRACK_COLUMNS`, as written beside the results.
    results : Results
        Of the same shot.

    Returns
    -------
    Start
        The thrown stone, the fastest, is taken back by `BACK` on its way, or less where
        another stone lies in it or moves too. If it is a curling stone on a sheet, it is let go at
        the hog line, and stones that leave the sheet are taken away.

    Raises
    ------
    InputError
        Where no stone moves.
    """
    laws = measured_laws(results, results.radius)
    time = _time(tracks, results)
    late = newcomers(tracks, time)
    tracks = tracks[~tracks["stone"].isin(late.keys())]
    rows = [_row(group, time, laws.ice) for _, group in tracks.groupby("stone", sort=True)]
    table, unseen = _with_spins(pd.DataFrame(rows).reset_index(drop=True), results)
    stones = tuple(
        StoneStart(
            str(row["stone"]),
            **{key: float(row[key]) for key in STATE},
            mass=results.masses.get(str(row["stone"]), STONE.mass),
        )
        for row in table.to_dict("records")
    )
    if not any(_moves(stone) for stone in stones):
        raise InputError("tracks: no stone moves before the first hit; nothing to throw again")
    sd, together = _errors(table, stones, results.shared_error or 0.0)
    thrown = _fastest(stones)
    stone = stones[thrown]
    # With another one under way too, the measured moment is where both are known.
    alone = sum(map(_moves, stones)) == 1
    way = _room(stones, thrown, results.radius) if results.collisions and alone else 0.0
    moved = list(stones)
    moved[thrown] = _taken_back(stone, way, laws.ice)
    radius = results.radius * (laws.size.value or 1.0)
    release, bounds = 0.0, None
    house = results.sheet and curling_size(results.radius)
    if house:
        ahead = (stone.x * stone.vx + stone.y * stone.vy) / math.hypot(stone.vx, stone.vy)
        release = max(HOG_TO_TEE + ahead - way, 0.0)
        bounds = Bounds(1 if stone.vy > 0 else -1)
    return Start(
        Shot(tuple(moved), laws.frictional, laws.ice, laws.curl, radius, bounds),
        thrown,
        sd,
        together,
        laws.restitution.stderr or 0.0,
        laws.stone_friction.stderr or 0.0,
        laws.sd_friction,
        laws.sd_turn,
        laws.size.stderr or 0.0,
        release,
        house,
        (*laws.assumed.values(), *unseen, *_left_out(late)),
    )


def _with_spins(table: pd.DataFrame, results: Results) -> tuple[pd.DataFrame, tuple[str, ...]]:
    """Give spins to stones that were not seen to turn, with their errors, and say which.

    Of one that moves what fits the whole shot best, or else any of either sense.
    """
    curling = curling_size(results.radius)
    anyhow = Estimate(0.0, math.hypot(THROWN, THROWN)) if curling else SPIN
    table, simulated, said = table.copy(), results.simulations.get("frictional"), []
    first: dict[str, MeasuredState] = {}
    for hit in simulated.hits if simulated is not None else ():
        first = {**hit.before, **first}
    for k in table.index[table["omega"].isna()]:
        name, spin = str(table.loc[k, "stone"]), Estimate(0.0, 0.0)
        if math.hypot(table.loc[k, "vx"], table.loc[k, "vy"]) > 0:
            state = first.get(name)
            told = state is not None and state.omega is not None and bool(state.sd_omega)
            spin = Estimate(state.omega, state.sd_omega) if state and told else anyhow
            how = "by what fits the whole shot" if told else "assumed"
            said.append(
                f"spin of {name} not seen: {spin.value:.2g} ± {spin.stderr:.2g} rad/s {how}"
            )
        table.loc[k, ["omega", "sd_omega"]] = spin.value, spin.stderr
    return table, tuple(said)


def _moves(stone: StoneStart) -> bool:
    return math.hypot(stone.vx, stone.vy) > 0


def _errors(
    table: pd.DataFrame, stones: Sequence[StoneStart], lasting: float
) -> tuple[Array, Array]:
    """Own errors of the stones' states, (stones, 5), and what places share, (stones, stones).

    `lasting` is a standard error that all places have in common, m.
    """
    sd = np.nan_to_num(table[[f"sd_{key}" for key in STATE]].to_numpy(float))
    # A stone at rest is known to rest.
    sd[[not _moves(stone) for stone in stones], 2:] = 0.0
    # What the places share is alike near each other, of which none can be more than all.
    shared = np.minimum(lasting, sd[:, :2].min(axis=1))
    sd[:, :2] = np.sqrt(sd[:, :2] ** 2 - shared[:, None] ** 2)
    xy = np.array([(stone.x, stone.y) for stone in stones])
    return sd, np.outer(shared, shared) * shared_correlation(xy)


def _left_out(late: Mapping[str, float]) -> tuple[str, ...]:
    """Say so where stones do not lie there from the beginning."""
    if not late:
        return ()
    each = ", ".join(f"{name} at {when:.2f} s" for name, when in late.items())
    return (f"first seen after this shot begins and left out, for where from is not known: {each}",)


def speed_before(speed: Array, way: float, ice: IceLaw) -> Array:
    """Speeds that stones had a distance `way` (m) before, or have after where it is negative.

    Parameters
    ----------
    speed : ndarray
        In m/s; the outcome is 0 where a stone does not come that far.
    way : float
        Distance along the path, m.
    ice : IceLaw
        The ice.
    """
    curve = curve_for(ice, NoCurl(), float(np.max(speed)))
    while _reach(curve)[-1] < np.interp(np.max(speed), curve.speed, _reach(curve)) + way:
        curve = curve_for(ice, NoCurl(), 2 * float(curve.speed[-1]))
    # The square of the speed is nearly linear in the distance.
    square = curve.speed**2
    left = np.interp(speed**2, square, _reach(curve)) + way
    return np.asarray(np.sqrt(np.interp(left, _reach(curve), square)))


def _reach(curve: Curve) -> Array:
    """Distance to rest at the nodes of a curve, m."""
    last = curve.coefficients[-1, 4] @ (curve.tau[-1] - curve.tau[-2]) ** np.arange(4)
    return np.append(curve.coefficients[:, 4, 0], last)


def _time(tracks: pd.DataFrame, results: Results) -> float:
    """Time at which the shot begins: the last before its first hit.

    Without a hit, the first at which the fastest stone is seen.
    """
    first = first_hit(results.collisions)
    early = tracks["t"] < first
    if math.isfinite(first) and early.any():
        return float(tracks.loc[early, "t"].max())
    speed = np.nan_to_num(np.hypot(tracks["vx"].to_numpy(float), tracks["vy"].to_numpy(float)))
    fastest = tracks["stone"].iloc[int(speed.argmax())]
    return float(tracks.loc[tracks["stone"] == fastest, "t"].min())


def _row(group: pd.DataFrame, time: float, ice: IceLaw) -> pd.Series:
    """State of a stone at a time: its last one, from where it glides on, or its first one."""
    early = group[group["t"] <= time]
    row = group.iloc[0 if early.empty else len(early) - 1].copy()
    spin = float(row["omega"])  # is not known where the stone was not seen to turn
    row[list(STATE)] = row[list(STATE)].astype(float).fillna(0.0)
    if early.empty:
        # It comes into view later: its way there is not known.
        row[["vx", "vy", "omega"]] = 0.0
    elif row["t"] < time:
        x, y, vx, vy, omega = (float(row[key]) for key in STATE)
        then = Path(0.0, Motion(x, y, 0.0, vx, vy, omega), ice, NoCurl()).at(time - row["t"])
        row[list(STATE)] = [then.x, then.y, then.vx, then.vy, then.omega]
    if not early.empty and math.isnan(spin):
        row["omega"] = spin
    return row


def _fastest(stones: tuple[StoneStart, ...]) -> int:
    return max(range(len(stones)), key=lambda k: math.hypot(stones[k].vx, stones[k].vy))


def _taken_back(stone: StoneStart, way: float, ice: IceLaw) -> StoneStart:
    """Return the stone a distance before, on its straight way."""
    speed = math.hypot(stone.vx, stone.vy)
    ux, uy = stone.vx / speed, stone.vy / speed
    then = float(speed_before(np.array([speed]), way, ice)[0])
    return replace(stone, x=stone.x - way * ux, y=stone.y - way * uy, vx=then * ux, vy=then * uy)


def _room(stones: tuple[StoneStart, ...], thrown: int, radius: float) -> float:
    """Return how far the thrown stone can be taken back without meeting another, m."""
    stone = stones[thrown]
    speed = math.hypot(stone.vx, stone.vy)
    ways = np.linspace(0, BACK, 21)
    way = np.array([[stone.x, stone.y]]) - ways[:, None] * [stone.vx / speed, stone.vy / speed]
    clear = np.ones(len(ways), bool)
    for k, other in enumerate(stones):
        if k != thrown:
            apart = np.hypot(*(way - [other.x, other.y]).T)
            clear &= (apart > 2.2 * radius) | (np.diff(apart, prepend=apart[0]) >= 0)
    return float(ways[-1] if clear.all() else ways[max(int(np.argmin(clear)) - 1, 0)])
