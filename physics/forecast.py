"""The shot predicted: from sightings before its first hit alone, with laws fixed in advance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from data.errors import InputError
from data.results import Estimate, Prediction
from physics.contacts import cut_all
from physics.estimate import Estimates
from physics.fit import fit_shot
from physics.glides import free
from physics.global_fit import fit_shots
from physics.hindcast import explained_until, score
from physics.impact import Frictional, Impact, PointMass
from physics.law_choice import STRAIGHT
from physics.simulate import simulate
from physics.simulation import Simulation
from physics.traces import traces
from physics.watched import LITERATURE, watch
from physics.whole_fit import GlobalFit

Floats = NDArray[np.float64]

AFTER = 1.16
"""Time after the first hit, s, at which the study of the 2018 Olympic final states its error."""

DRAWS = 48
"""Simulated shots from which the spread of the last places is taken."""


def predict(
    sightings: pd.DataFrame,
    tracks: pd.DataFrame,
    estimates: Estimates,
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
    restitution: Estimate = LITERATURE.restitution,
    friction: Estimate = LITERATURE.friction,
) -> dict[str, Prediction]:
    """Predict a shot from what was seen before its first hit and score it against the tracks.

    The states come from a fit through the simulator to the sightings before the hit; of what
    follows nothing is used but to score the outcome.

    Parameters
    ----------
    sightings : DataFrame
        `data.tracks.SIGHTING_COLUMNS`.
    tracks : DataFrame
        `data.tracks.TRACK_COLUMNS`, to score against.
    estimates : Estimates
        Of the same shot, for the time of its first hit.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; equal where absent.
    restitution, friction : Estimate
        Assumed beforehand, with their standard errors; those of the literature by default.

    Returns
    -------
    dict of str to Prediction
        By impact model; empty where there is no hit to predict.
    """
    if not estimates.collisions:
        return {}
    first = min(hit.t for hit in estimates.collisions)
    rigid = Prediction(None, note="needs spins after the hit, which only the shot itself tells")
    fit = _before(sightings[sightings["t"] < first], radius, masses or {}, restitution, friction)
    if fit is None:
        note = "too little is seen before the first hit"
        return {name: Prediction(None, note=note) for name in ("point-mass", "frictional")}
    out = {}
    for name in ("point-mass", "frictional"):
        try:
            out[name] = _scored(fit, name, tracks, estimates, first, restitution, friction)
        except InputError as error:
            out[name] = Prediction(None, note=f"cannot be simulated: {error}")
    return {"point-mass": out["point-mass"], "rigid-body": rigid, "frictional": out["frictional"]}


def _before(
    sightings: pd.DataFrame,
    radius: float,
    masses: Mapping[str, float],
    restitution: Estimate,
    friction: Estimate,
) -> GlobalFit | None:
    """Fit the states of all stones to what was seen before the hit; None where none moves."""
    known = traces(sightings)
    pieces, _ = cut_all(known, (), radius)
    if not pieces:
        return None
    loose = fit_shot(known, pieces, (), radius, deceleration=free(radius), masses=masses)
    moving = {piece.stone for piece in pieces if not piece.rest}
    watched = watch(
        known, loose, radius, priors=LITERATURE, masses=masses, bystanders=sorted({*known} - moving)
    )
    if watched is None:
        return None
    laws = {
        "restitution": restitution.value or 0.0,
        "friction": friction.value or 0.0,
        "stone_friction": LITERATURE.stone_friction.value or 0.0,
        "size": 1.0,
    }
    return fit_shots([watched], fixed=laws | STRAIGHT)


def _scored(
    fit: GlobalFit,
    model: str,
    tracks: pd.DataFrame,
    estimates: Estimates,
    first: float,
    restitution: Estimate,
    friction: Estimate,
) -> Prediction:
    start = fit.shots[0].start
    clock = tracks.groupby("frame", sort=True)["t"].first()
    clock = clock[clock >= first]
    if clock.empty:
        return Prediction(None, note="nothing is seen after the first hit")
    times = clock.to_numpy(float) - start
    table = _run(fit, fit.state(), model, float(times[-1])).sample(times)
    table["frame"] = clock.index.to_numpy()[table["frame"].to_numpy()]
    table["t"] += start
    found = score(tracks, table, first, explained_until(tracks, estimates, first), None)
    spread = _spread(fit, model, times[-1], restitution, friction)
    return Prediction(
        found.rmse,
        found.rest_error,
        {name: spread[name] for name in found.rest_error if name in spread},
        restitution,
        friction,
        found.note,
        _errors_at(tracks, table, first + AFTER, found.rest_error),
    )


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


def _run(fit: GlobalFit, values: Mapping[str, float], model: str, end: float) -> Simulation:
    shot = fit.shots[0].shot(values)
    e = values["restitution"]
    impact: Impact = PointMass(e)
    if model == "frictional":
        impact = Frictional(e, values["stone_friction"], fit.shots[0].inertia)
    return simulate(replace(shot, impact=impact), until=end)


def _spread(
    fit: GlobalFit, model: str, end: float, restitution: Estimate, friction: Estimate
) -> dict[str, float]:
    """Spread of each stone's last place over what is not known of states and laws, m."""
    rng = np.random.default_rng(0)
    between = LITERATURE.stone_friction
    laws = {"restitution": restitution, "friction": friction, "stone_friction": between}
    states = rng.multivariate_normal(fit.values, fit.cov, DRAWS, method="eigh")
    ends: dict[str, list[Floats]] = {}
    for row in states:
        values = fit.state(values=row)
        for name, law in laws.items():
            drawn = rng.normal(law.value or 0.0, law.stderr or 0.0)
            values[name] = float(np.clip(drawn, 1e-5, 1.0))
        for stone, group in _run(fit, values, model, end).sample(np.array([end])).groupby("stone"):
            ends.setdefault(str(stone), []).append(group[["x", "y"]].to_numpy(float)[0])
    return {name: float(np.hypot(*np.std(np.array(xy), axis=0))) for name, xy in ends.items()}
