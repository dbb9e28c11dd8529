"""Positions, velocities and spins from sightings: a Kalman filter, smoothed backwards.

State x, y, vx, vy, θ, ω. Between two times a stone moves on with its velocity, which the ice
lowers; what the ice does otherwise is white noise of acceleration. The known part of the
deceleration is taken out of the measurements before the filter and put back afterwards, so
that the filter itself stays linear and the backward pass (Rauch, Tung and Striebel, 1965,
AIAA J. 3, 1445) exact. A filter never runs across a hit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from data.tracks import TRACK_COLUMNS, empty_tracks
from physics.contacts import Contact, cut_all
from physics.fit import fit_shot
from physics.glides import FREE, measure_glides, stop_time
from physics.shot_fit import ShotFit
from physics.traces import Trace, traces

Floats = NDArray[np.float64]

START_SD = np.array([3.0, 10.0])
"""What is known of speed (m/s) and spin (rad/s) before the first sighting."""

JUMP_SD = np.array([1.0, 5.0])
"""How much speed (m/s) and spin (rad/s) may change where a motion changes of itself."""

STILL_SD = np.array([1e-3, 1e-3])
"""How still a stone at rest lies, m/s and rad/s."""

STOPPED_SD = 0.01
"""How well a stone is known to have stopped, m/s: the moment of it is not exactly known."""

MEMORY = 0.5
"""Time over which a deceleration keeps its deviation from the mean, s."""

SPIN_LOSS_SD, SPIN_LOSS_STOPPED_SD = 0.05, 0.5
"""How much the loss of spin differs from none, rad/s²: moving, and spinning on the spot."""

GATE = 25.0
"""Squared normalised innovation beyond which a sighting is refused."""


@dataclass(frozen=True)
class _Model:
    """How one stone's speed is expected to change.

    ``a`` is the deceleration (m/s²), ``spread`` its deviation, ``noise`` the factor on the
    variance of the sightings.
    """

    a: float
    spread: float
    noise: float


def smooth(sightings: pd.DataFrame, contacts: Sequence[Contact], *, radius: float) -> pd.DataFrame:
    """Turn sightings into tracks: one row per stone and time from its first to its last.

    Parameters
    ----------
    sightings : DataFrame
        `data.tracks.SIGHTING_COLUMNS`; standard deviations are estimated where missing.
    contacts : sequence of Contact
        The hits; nothing on one side of a hit has a say on its other side.
    radius : float
        Of the discs, m.

    Returns
    -------
    DataFrame
        `data.tracks.TRACK_COLUMNS`. ``seen`` is 0 in rows at which other stones were seen
        but not this one, or at which its sighting was refused as an outlier. Angles are
        NaN where the stone's angle was never seen, velocities where it was seen once. The
        standard deviations of places include what the sightings share (``sd_place``).
    """
    known = traces(sightings)
    if not known:
        return empty_tracks()
    clock = sightings.groupby("t", sort=True)["frame"].first()
    times, frames = clock.index.to_numpy(float), clock.to_numpy(int)
    fit, model = _survey(known, contacts, radius)
    tables = []
    for name, trace in known.items():
        inside = (times >= trace.t[0]) & (times <= trace.t[-1])
        hits = sorted(c.t for c in contacts if name in c.stones)
        tables.append(_track(trace, times[inside], frames[inside], hits, fit, model))
    return pd.concat(tables, ignore_index=True)[list(TRACK_COLUMNS)]


def _survey(
    known: dict[str, Trace], contacts: Sequence[Contact], radius: float
) -> tuple[ShotFit, _Model]:
    """Fit each stretch between hits by itself: where stones rest, and how the ice slows them."""
    by_hits, _ = cut_all(known, contacts, radius)
    pieces = [replace(piece, opens=None, closes=None) for piece in by_hits]
    loose = fit_shot(known, pieces, (), radius, deceleration=FREE)
    _, friction, prior = measure_glides(loose, known, radius)
    fit = fit_shot(known, pieces, (), radius, deceleration=prior)
    a = prior.mean if friction.value is not None else 0.0
    return fit, _Model(max(a, 0.0), prior.along, fit.inflation)


def _track(
    trace: Trace,
    t: Floats,
    frames: NDArray[np.int64],
    hits: Sequence[float],
    fit: ShotFit,
    model: _Model,
) -> pd.DataFrame:
    """Run the filter over one stone, hit to hit."""
    row = np.clip(np.searchsorted(trace.t, t), 0, len(trace.t) - 1)
    sighted = trace.t[row] == t
    place, rest, idle, speed = _modes(trace.stone, t, fit)
    z = np.column_stack([trace.xy[row], trace.theta[row]])
    z[~sighted] = np.nan
    sd = np.column_stack([trace.sd[row], trace.sd_theta[row]]) * np.sqrt(model.noise)
    mean, spread = np.full((len(t), 6), np.nan), np.full((len(t), 6), np.nan)
    seen = np.zeros(len(t), dtype=int)
    part = np.searchsorted(np.asarray(hits, float), t, side="right")
    for k in np.unique(part):
        at = np.flatnonzero(part == k)
        if np.isfinite(z[at, 0]).any():
            mean[at], spread[at], seen[at] = _run(
                t[at], z[at], sd[at], place[at], rest[at], idle[at], speed[at], model
            )
        else:
            mean[at], spread[at] = _bridge(trace, t[at])
    spread[:, :2] = np.hypot(spread[:, :2], trace.sd_place[row][:, None])
    size = np.hypot(mean[:, 2], mean[:, 3])
    spread[:, 2:4] = np.hypot(spread[:, 2:4], (trace.sd_scale[row] * size)[:, None])
    if not np.isfinite(trace.theta).any():
        mean[:, 4:], spread[:, 4:] = np.nan, np.nan
    if len(trace.t) == 1:
        # One look tells a place and an angle, but nothing of motion.
        mean[:, [2, 3, 5]], spread[:, [2, 3, 5]] = np.nan, np.nan
    columns = ("x", "y", "vx", "vy", "theta", "omega")
    table = {"stone": trace.stone, "frame": frames, "t": t, "seen": seen}
    table |= {name: mean[:, i] for i, name in enumerate(columns)}
    table |= {f"sd_{name}": spread[:, i] for i, name in enumerate(columns)}
    return pd.DataFrame(table)


def _modes(
    stone: str, t: Floats, fit: ShotFit
) -> tuple[NDArray[np.int64], NDArray[np.bool_], NDArray[np.bool_], Floats]:
    """Per time: its piece, whether the stone rests, whether it also spins not, rough velocity."""
    place = np.zeros(len(t), dtype=int)
    rest = np.ones(len(t), dtype=bool)
    idle = np.ones(len(t), dtype=bool)
    speed = np.zeros((len(t), 2))
    for i, piece in enumerate(fit.pieces):
        if piece.stone != stone:
            continue
        inside = np.flatnonzero((t >= piece.start) & (t < piece.end))
        place[inside] = i
        if piece.rest:
            continue
        x = fit.theta[6 * i : 6 * i + 6].reshape(2, 3)
        stop = stop_time(x, fit.origins[i], np.inf)
        rest[inside] = t[inside] > stop
        idle[inside] = False  # it may spin on the spot for a while
        tau = np.minimum(t[inside], stop) - fit.origins[i]
        speed[inside] = x[:, 1] + tau[:, None] * x[:, 2]
    return place, rest, idle, speed


def _bridge(trace: Trace, t: Floats) -> tuple[Floats, Floats]:
    """Straight line over a stretch between two hits in which the stone was never seen."""
    k = int(np.clip(np.searchsorted(trace.t, t[0]), 1, len(trace.t) - 1))
    gap = float(trace.t[k] - trace.t[k - 1])
    mean, spread = np.full((len(t), 6), np.nan), np.full((len(t), 6), np.nan)
    for axis in range(2):
        mean[:, axis] = np.interp(t, trace.t, trace.xy[:, axis])
        mean[:, 2 + axis] = (trace.xy[k, axis] - trace.xy[k - 1, axis]) / gap
    spread[:, :2] = gap
    spread[:, 2:4] = START_SD[0]
    return mean, spread


def _run(
    t: Floats,
    z: Floats,
    sd: Floats,
    place: NDArray[np.int64],
    rest: NDArray[np.bool_],
    idle: NDArray[np.bool_],
    speed: Floats,
    model: _Model,
) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Filter and smooth one stretch between two hits.

    Returns
    -------
    mean, spread : (n, 6) array
        x, y, vx, vy, θ, ω and their standard deviations.
    seen : (n,) int array
        Whether the sighting at each time was used.
    """
    from filterpy.kalman import KalmanFilter

    n = len(t)
    first = int(np.flatnonzero(np.isfinite(z[:, 0]))[0])
    angles = np.isfinite(z[:, 2])
    theta = float(z[np.flatnonzero(angles)[0], 2]) if angles.any() else 0.0
    start = np.where([rest[0], idle[0]], STILL_SD, START_SD)
    filter_ = KalmanFilter(dim_x=6, dim_z=3)
    filter_.x = np.array([z[first, 0], z[first, 1], 0.0, 0.0, theta, 0.0])
    filter_.P = np.diag([100.0, 100.0, start[0] ** 2, start[0] ** 2, 1e4, start[1] ** 2])
    rows = np.zeros((3, 6))
    rows[[0, 1, 2], [0, 1, 4]] = 1.0
    drift = np.zeros((n, 6))
    means, covs = np.empty((n, 6)), np.empty((n, 6, 6))
    steps, noises = np.empty((n, 6, 6)), np.empty((n, 6, 6))
    steps[0], noises[0] = np.eye(6), np.zeros((6, 6))
    seen = np.zeros(n, dtype=int)
    refused = wrong = 0
    for k in range(n):
        if k:
            dt = t[k] - t[k - 1]
            steps[k], noises[k] = _step(
                dt, rest[k - 1 : k + 1], idle[k - 1 : k + 1], place[k] != place[k - 1], model
            )
            drift[k] = steps[k] @ drift[k - 1]
            if not rest[k]:
                drift[k, :4] += _slowing(dt, speed[k - 1], model.a)
            filter_.predict(F=steps[k], Q=noises[k])
        if np.isfinite(z[k, 0]):
            near = _distance(filter_, rows[:2], z[k, :2] - drift[k, :2], sd[k, :2]) < GATE
            # Three refusals in a row mean that the filter is wrong and the sightings right.
            if near or refused >= 2:
                seen[k], refused = 1, 0
                filter_.update(z[k, :2] - drift[k, :2], R=np.diag(sd[k, :2] ** 2), H=rows[:2])
            else:
                refused += 1
        if np.isfinite(z[k, 2]):
            turn, error = z[k, 2:] - drift[k, 4:5], sd[k, 2:]
            near = _distance(filter_, rows[2:], turn, error) < GATE
            if near or wrong >= 2:
                wrong = 0
                filter_.update(turn, R=np.diag(error**2), H=rows[2:])
            else:
                wrong += 1
        means[k], covs[k] = filter_.x, filter_.P
    # The method reads Fs[k + 1] on the way from k + 1 to k, as uneven steps need.
    mean, cov, _, _ = filter_.rts_smoother(means, covs, list(steps), list(noises))
    spread = np.sqrt(np.maximum(np.diagonal(cov, axis1=1, axis2=2), 0.0))
    mean = mean + drift
    mean[rest, 2:4], mean[idle, 5] = 0.0, 0.0
    return mean, spread, seen


def _slowing(dt: float, speed: Floats, a: float) -> Floats:
    """Change of place and velocity by the ice in one step."""
    size = float(np.hypot(*speed))
    if size < 1e-6:
        return np.zeros(4)
    loss = min(a, size / dt)
    along = -loss * speed / size
    return np.concatenate([0.5 * dt * dt * along, dt * along])


def _distance(filter_: Any, rows: Floats, value: Floats, sd: Floats) -> float:
    """Squared normalised innovation of a measurement."""
    error = value - rows @ filter_.x
    spread = rows @ filter_.P @ rows.T + np.diag(sd**2)
    return float(error @ np.linalg.solve(spread, error))


def _step(
    dt: float, rest: NDArray[np.bool_], idle: NDArray[np.bool_], changed: bool, model: _Model
) -> tuple[Floats, Floats]:
    """Transition matrix and process noise of one step; `rest`, `idle` at its two ends."""
    step, noise = np.eye(6), np.zeros((6, 6))
    loss = SPIN_LOSS_STOPPED_SD if rest[1] else SPIN_LOSS_SD
    pairs = ((0, 2, model.spread, rest), (1, 3, model.spread, rest), (4, 5, loss, idle))
    for place, rate, deviation, still in pairs:
        at = np.ix_([place, rate], [place, rate])
        kind = int(still is idle)
        if still[1]:
            # What was left of the motion ends somewhere in the step.
            step[place, rate] = 0.0 if still[0] else 0.5 * dt
            step[rate, rate] = 0.0
            noise[rate, rate] = (STILL_SD[kind] if idle[1] else STOPPED_SD) ** 2
            continue
        step[place, rate] = dt
        density = deviation**2 * MEMORY
        noise[at] = density * np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
        if still[0] or changed:
            jump = START_SD[kind] if still[0] else JUMP_SD[kind]
            # At any moment of the step.
            noise[at] += jump**2 * np.array([[dt * dt / 3, dt / 2], [dt / 2, 1.0]])
    return step, noise
