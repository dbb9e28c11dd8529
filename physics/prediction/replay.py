"""The measured shot simulated again, with its own laws: as the fit of the whole of it has it.

What is foretold without what follows the first hit is in `curlshot.physics.prediction.forecast`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.results import SimulatedHit, SimulationScore
from curlshot.data.sheet import STONE
from curlshot.physics.estimate import Estimates
from curlshot.physics.impact import Impact, PointMass, RigidBody
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.local_fit.untold import OFTEN, SUDDEN
from curlshot.physics.local_fit.ways import SLOWING
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.physics.prediction.fitted_shot import by_itself, fitted_ensemble
from curlshot.physics.prediction.laws import Laws, assumed_of, measured_laws
from curlshot.physics.prediction.throws import first_hit, foreseen_until, newcomers
from curlshot.physics.prediction.uncertainty import (
    InitialUncertainty,
    path_spread,
    simulated,
    simulated_hits,
)
from curlshot.physics.shot_fit.priors import SPIN
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.physics.shot_fit.shot_model import STATE
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart

MOVED = 0.05
"""Distance by which a stone must move to count in the score, m."""

AT_REST = 0.01
"""Speed below which a stone lies still before the first hit, m/s."""

WITHIN = 0.1
"""Time within which a change of velocity is sudden, s."""


@dataclass(frozen=True)
class Replay:
    """A measured shot simulated again.

    Attributes
    ----------
    samples : dict of str to DataFrame
        Model to the simulated states at the tracks' times from the start on, with the
        columns ``stone, frame, t, x, y, theta, vx, vy, omega`` and the standard deviations
        ``sd_x, sd_y, sd_vx, sd_vy, sd_omega`` that the errors of the start and the laws give.
    scores : dict of str to SimulationScore
        Root mean square distance over the stones that moved, m, and each stone's distance
        between its simulated and measured last place; both without what follows when
        something else (a wall, a hand) moved a stone.
    warnings : tuple of str
        What had to be assumed.
    ensemble : Ensemble or None
        Shots that may have been this one, with hits as `frictional` has them; None where there is
        nothing to simulate.
    """

    samples: dict[str, pd.DataFrame]
    scores: dict[str, SimulationScore]
    warnings: tuple[str, ...]
    ensemble: Ensemble | None = None


def simulate_measured(
    tracks: pd.DataFrame,
    estimates: Estimates,
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
) -> Replay:
    """Simulate a measured shot with each impact model and score it against the tracks.

    Start and laws are those of the fit of the whole shot, so that `frictional` tells how far the
    simulator can follow the shot. Without such a fit the start is the last state of `tracks` before
    the first hit, which rests on what was seen before it alone.

    Parameters
    ----------
    tracks : DataFrame
        `curlshot.data.tracks.TRACK_COLUMNS`, split at the hits as `curlshot.physics.kalman.smooth`
        gives them.
    estimates : Estimates
        Of the same tracks.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; equal where absent.

    Returns
    -------
    Replay
    """
    if tracks.empty:
        return Replay({}, {}, ("no tracks to simulate",))
    if tracks["vx"].isna().all():
        return Replay({}, {}, ("no stone was detected twice: places only, nothing to simulate",))
    start = _start_time(tracks, estimates)
    fit = estimates.shot_fit
    told = {*fit.shots[0].traces} if fit is not None else set()
    # What may not have lain there, and nothing brings back in time, can't begin with the others.
    late = newcomers(tracks, start).keys() - told
    stones = _states(tracks[~tracks["stone"].isin(late)], start, estimates, masses or {})
    laws = measured_laws(estimates, radius)
    models, notes = _models(laws, estimates, stones)
    clock = tracks.groupby("frame", sort=True)["t"].first()
    clock = clock[clock >= start]
    uncertainty = _uncertainty(tracks, start, estimates, laws)
    again = Shot(stones, laws.frictional, laws.ice, laws.curl, radius * (laws.size.value or 1.0))
    may = _may_have_been(fit, again, uncertainty, start)
    explained = explained_until(tracks, estimates, start)
    ends = foreseen_until(explained, estimates.collisions, {stone.name for stone in stones})
    samples: dict[str, pd.DataFrame] = {}
    scores: dict[str, SimulationScore] = {}
    for name, impact in models.items():
        if impact is None:
            scores[name] = SimulationScore(None, {}, notes[name])
            continue
        try:
            table, hits = _sampled(may.by(impact), clock)
        except InputError as error:
            scores[name] = SimulationScore(None, {}, f"cannot be simulated: {error}")
            continue
        samples[name] = table
        found = score(tracks, table, start, ends, notes.get(name))
        scores[name] = replace(found, hits=hits, rest_sd=_rest_sd(tracks, table, found))
    warnings = _assumptions(estimates, assumed_of(laws, may.likely), explained)
    return Replay(samples, scores, warnings, may.by(laws.frictional))


def _assumptions(
    estimates: Estimates, assumed: Mapping[str, str], explained: Mapping[str, float]
) -> tuple[str, ...]:
    """Say what is assumed of the laws of a shot, and until when, s, its stones are compared."""
    out = [] if estimates.collisions else ["simulation: no hit, the stones only glide"]
    used = ("restitution", "friction") if estimates.collisions else ("friction",)
    out += [f"simulation: {assumed[name]}" for name in used if name in assumed]
    out += [
        f"simulation: {name} is compared until {end:.2f} s; neither the ice nor a detected hit"
        " explains its motion afterwards"
        for name, end in explained.items()
        if np.isfinite(end)
    ]
    return tuple(out)


def _sampled(
    shots: Ensemble, clock: pd.Series[float]
) -> tuple[pd.DataFrame, tuple[SimulatedHit, ...]]:
    """Simulate a shot and its variants: table of `Replay.samples` at a clock of frames, hits.

    Raises
    ------
    InputError
        The likeliest shot cannot be simulated.
    """
    run, others = simulate(shots.likely), simulated(shots.others)
    since = np.asarray(clock, float) - shots.start
    table = run.sample(since).merge(path_spread(others, since), "left", ["stone", "t"])
    table["frame"] = clock.index.to_numpy()[table["frame"].to_numpy()]
    table["t"] = table["t"] + shots.start
    return table, simulated_hits(run, others, shots.start)


def _may_have_been(
    fit: ShotFit | None, shot: Shot, uncertainty: InitialUncertainty, start: float
) -> Ensemble:
    """Shots that may have been the one seen: of the fit of the whole of it where that is so."""
    if fit is not None:
        with suppress(InputError):
            return fitted_ensemble(fit, shot, uncertainty, start)
    return by_itself(shot, uncertainty, start)


def _start_time(tracks: pd.DataFrame, estimates: Estimates) -> float:
    """Time of the last frame before the first hit; without one of the first with all that move."""
    times = np.unique(tracks["t"].to_numpy(float))
    if not estimates.collisions:
        each = tracks.groupby("stone", sort=True)
        wide, high = (np.asarray(each[axis].agg(np.ptp), float) for axis in ("x", "y"))
        seen = each["t"].first().to_numpy(float)[np.hypot(wide, high) > MOVED]
        return float(seen.max(initial=times[0]))
    before = times[times < first_hit(estimates.collisions)]
    return float(before[-1] if len(before) else times[0])


def _states(
    tracks: pd.DataFrame, start: float, estimates: Estimates, masses: Mapping[str, float]
) -> tuple[StoneStart, ...]:
    """Every stone's state at the start; one first seen later starts where it is then."""
    first = first_hit(estimates.collisions)
    out = []
    for name, group in tracks.groupby("stone", sort=True):
        early = group[group["t"] < first]
        late = early.empty
        row = group.iloc[0] if late else early.iloc[-1]
        if not estimates.collisions:
            row = group.iloc[max(int((group["t"] <= start).sum()) - 1, 0)]
        # A stone that comes into view later is where it lies; its way there is not known.
        ahead = 0.0 if late else start - float(row["t"])
        vx, vy = (0.0, 0.0) if late else (_or_zero(row["vx"]), _or_zero(row["vy"]))
        spins = [hit.after[str(name)].omega for hit in estimates.collisions if name in hit.stones]
        known = [spin for spin in spins if spin is not None]
        omega = 0.0 if late else _or_zero(row["omega"])
        # A stone that was not hit keeps its spin, should the simulation hit it.
        after = tuple(known) if len(known) == len(spins) else None
        out.append(
            StoneStart(
                name=str(name),
                x=float(row["x"]) + ahead * vx,
                y=float(row["y"]) + ahead * vy,
                vx=vx,
                vy=vy,
                omega=omega,
                theta=_or_zero(row["theta"]),
                omega_after=after or (None if spins else omega),
                mass=masses.get(str(name), STONE.mass),
            )
        )
    return tuple(out)


def _uncertainty(
    tracks: pd.DataFrame, start: float, estimates: Estimates, laws: Laws
) -> InitialUncertainty:
    """Collect the standard errors of start and laws; stones at rest have those of places alone."""
    states, spins = {}, {}
    for name, group in tracks.groupby("stone", sort=True):
        early = group[group["t"] <= start]
        row = group.iloc[0] if early.empty else early.iloc[-1]
        still = _or_zero(np.hypot(row["vx"], row["vy"])) < AT_REST
        errors = np.nan_to_num(row[[f"sd_{key}" for key in STATE]].to_numpy(float))
        if np.isnan(row["omega"]):
            errors[4] = SPIN.stderr
        states[str(name)] = np.where([False, False, still, still, still], 0.0, errors)
        own = [hit.after[str(name)] for hit in estimates.collisions if name in hit.stones]
        spins[str(name)] = tuple(state.sd_omega or 0.0 for state in own)
    return InitialUncertainty(
        states,
        spins,
        restitution=laws.restitution.stderr or 0.0,
        stone_friction=laws.stone_friction.stderr or 0.0,
        friction=laws.sd_friction,
        turn=laws.sd_turn,
        size=laws.size.stderr or 0.0,
        shared=_shared(estimates.local.known, start),
    )


def _rest_sd(
    tracks: pd.DataFrame, table: pd.DataFrame, found: SimulationScore
) -> dict[str, float | None]:
    """Tell the standard deviation of each stone that is scored where it was last seen, m."""
    both = tracks.loc[tracks["seen"] != 0, ["stone", "frame"]].merge(table, on=["stone", "frame"])
    last = both.groupby("stone")[["sd_x", "sd_y"]].last().dropna()
    spread = dict(zip(last.index, np.hypot(last["sd_x"], last["sd_y"]).tolist(), strict=True))
    return {name: spread.get(name) for name in found.rest_error}


def _shared(known: Mapping[str, Trace], start: float) -> dict[str, NDArray[np.float64]]:
    """Tell what stones near each other share of the errors of their places, x and y, m."""
    return {
        name: trace.sd_place[np.argmin(np.abs(trace.t - start))]
        for name, trace in known.items()
        if len(trace.t)
    }


def _or_zero(value: float) -> float:
    return float(value) if np.isfinite(value) else 0.0


def _models(
    laws: Laws, estimates: Estimates, stones: tuple[StoneStart, ...]
) -> tuple[dict[str, Impact | None], dict[str, str]]:
    """Build the three models, None with a note where one cannot run."""
    notes: dict[str, str] = {}
    if estimates.collisions and "stone_friction" in laws.assumed:
        notes["frictional"] = _as_it_fits(estimates.shot_fit) or laws.assumed["stone_friction"]
    e = laws.restitution.value or 0.0
    out: dict[str, Impact | None] = {
        "point-mass": PointMass(e),
        "rigid-body": RigidBody(e),
        "frictional": laws.frictional,
    }
    hit_stones = {stone for hit in estimates.collisions for stone in hit.stones}
    blind = [s.name for s in stones if s.name in hit_stones and s.omega_after is None]
    if blind:
        out["rigid-body"] = None
        notes["rigid-body"] = f"needs the spin after the hit of {', '.join(blind)}"
    return out, notes


def _as_it_fits(fit: ShotFit | None) -> str | None:
    """Say with which friction between the stones a shot that does not tell it goes on."""
    if fit is None:
        return None
    if "stone_friction" in fit.fixed:
        return "friction between the stones not identifiable: they stick, as in the shot fit"
    rub = fit.state()["stone_friction"]
    return f"friction between the stones not identifiable: {rub:.2g}, as in the shot fit"


def explained_until(tracks: pd.DataFrame, estimates: Estimates, start: float) -> dict[str, float]:
    """Time until which ice and known hits explain how each stone moves; infinity if to the end."""
    return {
        str(name): _end(group, [hit.t for hit in estimates.collisions if name in hit.stones], start)
        for name, group in tracks.groupby("stone", sort=True)
    }


def _end(track: pd.DataFrame, hits: Sequence[float], start: float) -> float:
    """Time at which something else than ice and known hits moves a stone; infinity if never."""
    seen = track[(track["seen"] != 0) & (track["t"] >= start)]
    t, v = seen["t"].to_numpy(float), seen[["vx", "vy"]].to_numpy(float)
    variance = (seen[["sd_vx", "sd_vy"]].to_numpy(float) ** 2).sum(axis=1)
    later = np.searchsorted(t, t + WITHIN)
    now = np.flatnonzero(later < len(t))
    then = later[now]
    # A change may take from the row before one to the row after the other.
    edge = np.append(np.searchsorted(hits, t), len(hits))
    free = edge[np.maximum(now - 1, 0)] == edge[np.minimum(then + 1, len(t) - 1)]
    change = np.hypot(*(v[then] - v[now]).T)
    # Ice does much in the time for which a stone is out of sight.
    slowed = OFTEN * SLOWING * (t[then] - t[now])
    sudden = free & (change > SUDDEN + slowed + 4 * np.sqrt(variance[now] + variance[then]))
    return float(t[now[sudden][0]]) if sudden.any() else np.inf


def score(
    tracks: pd.DataFrame,
    simulated: pd.DataFrame,
    start: float,
    ends: Mapping[str, float],
    note: str | None,
) -> SimulationScore:
    """Distance between the simulated and the measured shot where stones were seen.

    A stone counts until `ends`; its last place tells nothing where that is before the end.
    """
    later = tracks[(tracks["t"] >= start) & (tracks["seen"] != 0)]
    later = later[later["t"] <= later["stone"].map(ends)]
    both = later.merge(simulated, on=["stone", "frame"], suffixes=("", "_s"))
    apart = both[["x", "y"]].to_numpy(float) - both[["x_s", "y_s"]].to_numpy(float)
    off = np.hypot(apart[:, 0], apart[:, 1])
    squares, rest = [], {}
    for name, group in both.groupby("stone", sort=True):
        spans = [group[[f"x{s}", f"y{s}"]].to_numpy(float) for s in ("", "_s")]
        moved = max(float(np.hypot(*(xy - xy[0]).T).max()) for xy in spans)
        if moved < MOVED:
            continue
        distance = off[group.index.to_numpy()]
        squares.append(distance**2)
        if np.isinf(ends[str(name)]):
            rest[str(name)] = float(distance[-1])
    if not squares:
        return SimulationScore(None, {}, note or "no motion that can be compared")
    return SimulationScore(float(np.sqrt(np.mean(np.concatenate(squares)))), rest, note)
