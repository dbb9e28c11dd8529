"""The shot that is thrown again: written by hand, or measured, with what is not known of it."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.results import Results
from curlshot.data.sheet import SHEET, curling_size
from curlshot.physics.curl import NoCurl
from curlshot.physics.ice import IceLaw
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.physics.prediction.laws import assumed_of, measured_laws
from curlshot.physics.prediction.throws import first_hit, newcomers
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.curve import Curve, curve_for
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import FASTEST, Shot, StoneStart

Array = NDArray[np.float64]

BACK = 1.0
"""How far from its first hit the thrown stone begins at least, m, to have room for changes."""
HOG_TO_TEE = SHEET.far_tee - SHEET.hog_line
"""From the hog line where the stone is let go to the tee, m."""


@dataclass(frozen=True)
class Start:
    """A shot to throw.

    Attributes
    ----------
    shot : Shot
        The stones and the laws, as they are most likely.
    thrown : int
        Rank of the thrown stone.
    others : tuple of Shot
        What it may be as well, all equally likely: the same stones in the same order. None where
        it is known exactly.
    release : float
        Distance that the thrown stone has come since it was let go, m.
    house : bool
        Whether places count from the tee of a house.
    assumed : mapping of str to str
        ``restitution``, ``friction``, ``stone_friction``, ``spin of A`` and the like, or ``left
        out``, to what had to be assumed of it.
    """

    shot: Shot
    thrown: int
    others: tuple[Shot, ...] = ()
    release: float = 0.0
    house: bool = True
    assumed: Mapping[str, str] = field(default_factory=dict)


def written_start(shot: Shot) -> Start:
    """Return a shot written by hand: known exactly, let go where it begins."""
    return Start(shot, _fastest(shot.stones), house=curling_size(shot.radius))


def measured_start(tracks: pd.DataFrame, results: Results, ensemble: Ensemble) -> Start:
    """Return a measured shot as it began.

    Parameters
    ----------
    tracks : DataFrame
        `curlshot.data.tracks.TRACK_COLUMNS`, as written beside the results.
    results : Results
        Of the same shot.
    ensemble : Ensemble
        What the same shot may have been.

    Returns
    -------
    Start
        Without stones that come into view under way after the first hit. Where the clip begins
        less than `BACK` before the first hit of the thrown stone, the fastest, this is taken
        back on its way, if no other stone lies in it or moves too. If it is a curling stone on a
        sheet, it is let go at the hog line, and stones that leave the sheet are taken away.

    Raises
    ------
    InputError
        Where no stone moves.
    """
    late = newcomers(tracks, _before_hit(tracks, results))
    likely, *others = (_without(s, late) for s in (ensemble.likely, *ensemble.others))
    if not any(_moves(stone) for stone in likely.stones):
        raise InputError("tracks: no stone moves before the first hit; nothing to throw")
    thrown = _fastest(likely.stones)
    way = _way_back(likely, thrown)
    shots = [_taken_back(shot, thrown, way) for shot in (likely, *others)]
    stone = shots[0].stones[thrown]
    house = results.origin_at_tee and curling_size(results.radius)
    release = 0.0
    if house:
        ahead = (stone.x * stone.vx + stone.y * stone.vy) / math.hypot(stone.vx, stone.vy)
        release = max(HOG_TO_TEE + ahead, 0.0)
        shots = [replace(shot, bounds=Bounds(1 if stone.vy > 0 else -1)) for shot in shots]
    assumed = {**_laws(results, likely), **_spins(tracks, shots), **_left_out(late)}
    return Start(shots[0], thrown, tuple(shots[1:]), release, house, assumed)


def _before_hit(tracks: pd.DataFrame, results: Results) -> float:
    """Time of the last row before the first hit; without one of the first of the fastest stone."""
    first = first_hit(results.collisions)
    early = tracks["t"] < first
    if math.isfinite(first) and early.any():
        return float(tracks.loc[early, "t"].max())
    speed = np.nan_to_num(np.hypot(tracks["vx"].to_numpy(float), tracks["vy"].to_numpy(float)))
    fastest = tracks["stone"].iloc[int(speed.argmax())]
    return float(tracks.loc[tracks["stone"] == fastest, "t"].min())


def _without(shot: Shot, names: Collection[str]) -> Shot:
    return replace(shot, stones=tuple(s for s in shot.stones if s.name not in names))


def _laws(results: Results, likely: Shot) -> dict[str, str]:
    """Say which laws the shot does not tell, and what is taken for them."""
    assumed = assumed_of(measured_laws(results, results.radius), likely)
    simulated = results.simulations.get("frictional")
    if "stone_friction" in assumed and simulated is not None and simulated.note:
        assumed["stone_friction"] = simulated.note
    return assumed


def _spins(tracks: pd.DataFrame, shots: Sequence[Shot]) -> dict[str, str]:
    """Say which spins of stones that move were not seen, and what is taken for them."""
    seen = set(tracks.loc[tracks["omega"].notna(), "stone"])
    said = {}
    for k, stone in enumerate(shots[0].stones):
        if _moves(stone) and stone.name not in seen:
            sd = float(np.std([shot.stones[k].omega for shot in shots[1:] or shots]))
            spin = f"spin of {stone.name}"
            likely = round(stone.omega, 3) + 0.0  # no -0
            said[spin] = f"{spin} not measured: {likely:.2g} ± {sd:.2g} rad/s assumed"
    return said


def _moves(stone: StoneStart) -> bool:
    return math.hypot(stone.vx, stone.vy) > 0


def _left_out(late: Mapping[str, float]) -> dict[str, str]:
    """Say so where stones do not lie there from the beginning."""
    each = ", ".join(f"{name} at {when:.2f} s" for name, when in late.items())
    why = (
        "first detected after the start of this shot and left out, since the earlier path is"
        " unknown"
    )
    return {"left out": f"{why}: {each}"} if late else {}


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


def _fastest(stones: tuple[StoneStart, ...]) -> int:
    return max(range(len(stones)), key=lambda k: math.hypot(stones[k].vx, stones[k].vy))


def _way_back(shot: Shot, thrown: int) -> float:
    """How far the thrown stone is to be taken back, m: to begin `BACK` before its first hit."""
    stone = shot.stones[thrown]
    hits = [hit for hit in simulate(shot).hits if stone.name in hit.stones]
    # With another one under way too, the moment is one at which both are known.
    if not hits or sum(map(_moves, shot.stones)) > 1:
        return 0.0
    there = hits[0].before[stone.name]
    short = BACK - math.dist((stone.x, stone.y), (there.x, there.y))
    return min(_room(shot, thrown), short) if short > 0 else 0.0


def _taken_back(shot: Shot, thrown: int, way: float) -> Shot:
    """Return the shot with the thrown stone a distance before, from where it comes as it was."""
    stone = shot.stones[thrown]
    speed = math.hypot(stone.vx, stone.vy)
    if not (way and speed):
        return shot
    then = float(speed_before(np.array([speed]), way, shot.ice)[0])
    curve = curve_for(shot.ice, shot.curl, then)
    took = float(np.diff(np.interp([speed, then], curve.speed, curve.tau))[0])
    # Thrown along x it tells how the way turns. It keeps spin: what is lost does not hang on it.
    spun = math.copysign(FASTEST, stone.omega) if stone.omega else 0.0
    lone = StoneStart(stone.name, 0.0, 0.0, then, 0.0, spun)
    end = simulate(replace(shot, stones=(lone,), bounds=None), until=took).state(lone.name, took)
    turn = math.atan2(stone.vy, stone.vx) - math.atan2(end.vy, end.vx)
    ux, uy = math.cos(turn), math.sin(turn)
    omega = stone.omega + (spun - end.omega)
    stones = list(shot.stones)
    stones[thrown] = replace(
        stone,
        x=stone.x - ux * end.x + uy * end.y,
        y=stone.y - uy * end.x - ux * end.y,
        vx=then * ux,
        vy=then * uy,
        omega=omega,
        theta=stone.theta - end.theta + (spun - omega) * took,
    )
    return replace(shot, stones=tuple(stones))


def _room(shot: Shot, thrown: int) -> float:
    """Return how far the thrown stone can be taken back without meeting another, m."""
    stone = shot.stones[thrown]
    speed = math.hypot(stone.vx, stone.vy)
    ways = np.linspace(0, BACK, 21)
    way = np.array([[stone.x, stone.y]]) - ways[:, None] * [stone.vx / speed, stone.vy / speed]
    clear = np.ones(len(ways), bool)
    for k, other in enumerate(shot.stones):
        if k != thrown:
            apart = np.hypot(*(way - [other.x, other.y]).T)
            clear &= (apart > 2.2 * shot.radius) | (np.diff(apart, prepend=apart[0]) >= 0)
    return float(ways[-1] if clear.all() else ways[max(int(np.argmin(clear)) - 1, 0)])
