"""The shot predicted: from detections before its first hit alone, and what was known beforehand."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.results import Estimate, Hit, Prediction
from curlshot.data.sheet import STONE
from curlshot.physics.estimate import Estimates
from curlshot.physics.impact import PointMass
from curlshot.physics.local_fit.fit import fit_shot
from curlshot.physics.local_fit.glides import free
from curlshot.physics.local_fit.hit_detection import cut_all
from curlshot.physics.local_fit.traces import traces
from curlshot.physics.prediction.replay import explained_until, score
from curlshot.physics.prediction.throws import first_hit, foreseen_until
from curlshot.physics.shot_fit.model_selection import fit_with_chosen_laws
from curlshot.physics.shot_fit.observed import observe
from curlshot.physics.shot_fit.priors import Priors, literature
from curlshot.physics.shot_fit.result import ShotFit, draw_choices
from curlshot.physics.shot_fit.shot_model import penner
from curlshot.physics.simulator.simulate import simulate

Floats = NDArray[np.float64]

AFTER = 1.16
"""Time after the first hit, s, at which the study of the 2018 Olympic final states its error."""

DRAWS = 48
"""Simulated shots from which the spread of the last places is taken."""

MOST = {"restitution": 1.0, "stone_friction": 1.0, "size": 1.3}
"""Bounds of what is drawn of the laws of hits, of which nothing is seen before one."""

OFF_CENTRE = 0.5
"""How far caps may be off the centres of their stones, as a part of the error that all places of
a stone have in common, where only what comes before a hit is fitted. There stones turn by little,
and a cap aside may pass for an aim: with all of it aims of 35 clips were 1.6 mm off (r.m.s.), 0.49
of what is stated, with half 1.5 mm and 0.7; with 1 mm besides the last places of a drawn shot were
5 cm off, not 2. A whole shot tells where its caps are."""

UNSURE = 3.0
"""Odds up to which other laws of the ice are no reason to give up plainer ones."""


def assumed(radius: float) -> Priors:
    """Return laws of a shot of which nothing is known, for discs of a radius, m.

    Those of the literature, and discs that meet at two radii.
    """
    return replace(literature(radius), size=Estimate(1.0, 0.0))


ASSUMED = assumed(STONE.radius)
"""Laws of a shot of curling stones of which nothing is known."""


def predict(
    detections: pd.DataFrame,
    tracks: pd.DataFrame,
    estimates: Estimates,
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
    laws: Priors = ASSUMED,
) -> dict[str, Prediction]:
    """Predict a shot from what was seen before its first hit and score it against the tracks.

    The states and the laws of the ice come from a fit through the simulator to all detections
    before the hit, the laws of hits from what is assumed; of what follows nothing is used but to
    score the outcome.

    Parameters
    ----------
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`.
    tracks : DataFrame
        `curlshot.data.tracks.TRACK_COLUMNS`, to score against.
    estimates : Estimates
        Of the same shot, for the time of its first hit.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; equal where absent.
    laws : Priors
        What is assumed of hits and ice, with standard errors; what has none is held.

    Returns
    -------
    dict of str to Prediction
        By impact model; empty where there is no hit to predict.
    """
    if not estimates.collisions:
        return {}
    first = first_hit(estimates.collisions)
    rigid = Prediction(None, note="needs the spins after the hit, which a prediction does not have")
    note = "too few detections before the first hit"
    try:
        fit = _before(detections[detections["t"] < first], radius, masses or {}, laws)
    except InputError as error:
        fit, note = None, f"cannot be simulated: {error}"
    if fit is None:
        return {name: Prediction(None, note=note) for name in ("point-mass", "frictional")}
    out = {}
    for name in ("point-mass", "frictional"):
        try:
            out[name] = _scored(fit, name, tracks, estimates, first, laws)
        except InputError as error:
            out[name] = Prediction(None, note=f"cannot be simulated: {error}")
    return {"point-mass": out["point-mass"], "rigid-body": rigid, "frictional": out["frictional"]}


def _before(
    detections: pd.DataFrame, radius: float, masses: Mapping[str, float], laws: Priors
) -> ShotFit | None:
    """Fit the states of all stones to what was seen before the hit; None where none moves.

    Of a stone that something else than ice has moved, as a hand does, to what was seen since.
    What is assumed of the ice is known beforehand but not held: where it is wrong, it would draw
    places and velocities aside.
    """
    known = traces(detections)
    pieces, _ = cut_all(known, (), radius)
    if not pieces:
        return None
    loose = fit_shot(known, pieces, (), radius, deceleration=free(radius), masses=masses)
    moving = {piece.stone for piece in pieces if not piece.rest}
    observed = observe(
        known, loose, radius, priors=laws, masses=masses, bystanders=sorted({*known} - moving)
    )
    if observed is None:
        return None
    moved = {
        name: float(trace.t[-1])
        for name, trace in observed.traces.items()
        if len(trace.t) < len(known[name].t)
    }
    if moved:
        since = detections["stone"].map(moved).fillna(-np.inf).astype(float)
        return _before(detections[detections["t"] > since], radius, masses, laws)
    held = {
        name: law.value or 0.0 for name, law in vars(laws).items() if name in MOST or not law.stderr
    }
    return fit_with_chosen_laws(replace(observed, off_centre=OFF_CENTRE), held)


@dataclass(frozen=True)
class _Predicted:
    """A shot as foretold: its simulated table, and who hits whom when, s."""

    table: pd.DataFrame
    hits: tuple[tuple[frozenset[str], float], ...]

    def pairs(self, lasts: Mapping[str, float]) -> set[frozenset[str]]:
        """Give who hit each other, by when each stone is looked at last, s; never if absent."""
        ends = {stones: min(lasts.get(name, 0.0) for name in stones) for stones, _ in self.hits}
        return {stones for stones, t in self.hits if t < ends[stones]}


def _scored(
    fit: ShotFit,
    model: str,
    tracks: pd.DataFrame,
    estimates: Estimates,
    first: float,
    laws: Priors,
) -> Prediction:
    clock = tracks.groupby("frame", sort=True)["t"].first()
    clock = clock[clock >= first]
    if clock.empty:
        return Prediction(None, note="no detections after the first hit")
    times = clock.to_numpy(float)
    seen = tracks[(tracks["seen"] != 0) & (tracks["t"] >= first)]
    at = {str(stone): float(t) for stone, t in seen.groupby("stone")["t"].max().items()}
    ends = sorted({first + AFTER, *at.values()})
    every = np.union1d(times, ends)
    likely = _likely(fit, laws, model, first, every)
    places = [_places(likely.table, rank) for rank in np.searchsorted(every, ends).tolist()]
    drawn = _drawn(fit, laws, model, first, ends)
    stones = min(estimates.collisions, key=lambda hit: hit.earliest).stones
    soon_enough = dict.fromkeys(stones, first + AFTER)
    if not any(frozenset(stones) in one.pairs(soon_enough) for one in (likely, *drawn)):
        # None of the draws is of this shot: as where a hand moves a stone before the hit.
        note = f"in the prediction, {' and '.join(stones)} do not hit each other within {AFTER} s"
        return Prediction(None, note=note)
    spread = dict(zip(ends, _spreads(drawn, ends, places), strict=True))
    frames = pd.Series(clock.index, index=np.searchsorted(every, times))
    table = likely.table
    table = table.assign(frame=table["frame"].map(frames)).dropna(subset="frame")
    until = explained_until(tracks, estimates, first)
    until = foreseen_until(until, estimates.collisions, set(table["stone"]))
    found = score(tracks, table, first, until, None)
    after = _errors_at(tracks, table, first + AFTER, found.rest_error)
    soon = spread[first + AFTER]
    return Prediction(
        found.rmse,
        found.rest_error,
        {name: spread[at[name]][name] for name in found.rest_error if name in spread[at[name]]},
        laws.restitution,
        laws.friction,
        _other_hits(likely.pairs(at), estimates.collisions, found.note),
        after,
        {name: soon[name] for name, off in after.items() if off is not None and name in soon},
    )


def _other_hits(
    pairs: set[frozenset[str]], collisions: Sequence[Hit], note: str | None
) -> str | None:
    """Add to a note who hit each other as foretold and did not, or the other way round."""
    seen = {frozenset(hit.stones) for hit in collisions}
    notes = [note] if note else []
    for stones in sorted(map(sorted, pairs - seen)):
        notes.append(
            f"in the prediction, {' and '.join(stones)} hit each other; in the clip they did not"
        )
    for stones in sorted(map(sorted, seen - pairs)):
        notes.append(f"in the prediction, {' and '.join(stones)} do not hit each other")
    return "; ".join(notes) or None


def _errors_at(
    tracks: pd.DataFrame, predicted: pd.DataFrame, time: float, stones: Iterable[str]
) -> dict[str, float | None]:
    """Distance between predicted and measured places of stones at a time, m; None if unseen."""
    out: dict[str, float | None] = {}
    for stone in stones:
        places = []
        for table in (tracks, predicted):
            own = table[table["stone"] == stone]
            t = own["t"].to_numpy(float)
            if not len(t) or not t[0] <= time <= t[-1]:
                break
            places.append([np.interp(time, t, own[axis].to_numpy(float)) for axis in "xy"])
        out[stone] = None
        if len(places) == 2:
            out[stone] = math.dist(*places)
    return out


def _likely(fit: ShotFit, laws: Priors, model: str, first: float, times: Floats) -> _Predicted:
    """Simulate the shot with what is assumed of hits, and the plainest laws of the ice that may be.

    Those are the ones of fewest unknowns that `UNSURE` allows; Penner's, which has as few as
    constant friction, comes after it.
    """
    most = max((weight for weight, _ in fit.choices), default=0.0)
    may_be = [own for weight, own in fit.choices if UNSURE * weight >= most] or [fit]
    plain = min(may_be, key=lambda own: (len(own.names), own.shots[0].ice is penner))
    hits = {name: getattr(laws, name).value or 0.0 for name in MOST}
    return _sampled(plain, plain.state(), hits, model, first, times)


def _sampled(
    fit: ShotFit,
    values: Mapping[str, float],
    laws: Mapping[str, float],
    model: str,
    first: float,
    times: Floats,
) -> _Predicted:
    """Simulate a shot as fitted, its hits by given laws, at some times after the first."""
    seen = fit.shots[0]
    approach = seen.shot(values)
    run = simulate(approach, until=first - seen.start)
    # The stones may meet a little sooner than they were seen to.
    lasts = min([first - seen.start, *(hit.t for hit in run.hits[:1])])
    stones = []
    for stone in approach.stones:
        now = run.paths[stone.name][0].at(lasts)
        stones.append(
            replace(stone, x=now.x, y=now.y, vx=now.vx, vy=now.vy, omega=now.omega, theta=now.theta)
        )
    onward = seen.shot({**values, **laws})
    impact = onward.impact if model == "frictional" else PointMass(laws["restitution"])
    since = times - seen.start - lasts
    rest = simulate(replace(onward, stones=tuple(stones), impact=impact), until=float(since[-1]))
    table = rest.sample(since)
    table["t"] += seen.start + lasts
    hits = ((frozenset(hit.stones), seen.start + lasts + hit.t) for hit in rest.hits)
    return _Predicted(table, tuple(hits))


def _places(table: pd.DataFrame, rank: int) -> dict[str, Floats]:
    """Places of the stones at one of the times of a simulated table, m."""
    now = table[table["frame"] == rank]
    return dict(zip(now["stone"], now[["x", "y"]].to_numpy(float), strict=True))


def _drawn(
    fit: ShotFit, laws: Priors, model: str, first: float, times: Sequence[float]
) -> list[_Predicted]:
    """Simulate the shot by draws of what is not known of states and laws, at increasing times."""
    rng = np.random.default_rng(0)
    out = []
    for own, row in draw_choices(fit, DRAWS, rng):
        drawn = {}
        for name, most in MOST.items():
            law: Estimate = getattr(laws, name)
            value = rng.normal(law.value or 0.0, law.stderr or 0.0)
            drawn[name] = float(np.clip(value, 1e-5, most))
        out.append(_sampled(own, own.state(values=row), drawn, model, first, np.array(times)))
    return out


def _spreads(
    drawn: Sequence[_Predicted], times: Sequence[float], likely: Sequence[Mapping[str, Floats]]
) -> list[dict[str, float]]:
    """Tell how far each stone's place may be off at some times, both axes together, m.

    It is the root mean square distance from the likeliest places over the draws.
    """
    squares: list[dict[str, list[float]]] = [{stone: [] for stone in places} for places in likely]
    for one in drawn:
        for rank, (found, usual) in enumerate(zip(squares, likely, strict=True)):
            there = _places(one.table, rank)
            for stone in there.keys() & usual.keys():
                found[stone].append(float(np.sum((there[stone] - usual[stone]) ** 2)))
    return [
        {stone: float(np.sqrt(np.mean(off))) for stone, off in found.items() if off}
        for found in squares
    ]
