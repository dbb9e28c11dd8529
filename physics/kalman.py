"""Positions, velocities and spins from detections: a Kalman filter, smoothed backwards.

State x, y, vx, vy, θ, ω. Between two times a stone moves on with its velocity, which the ice
lowers; what the ice does otherwise is white noise of acceleration. The known part of the
deceleration is taken out of the measurements before the filter and put back afterwards, so
that the filter itself stays linear and the backward pass (Rauch, Tung and Striebel, 1965,
AIAA J. 3, 1445) exact. A filter never runs across a hit.

The noise of detections is estimated from the shot itself (`curlshot.physics.local_fit.noise`): its
white part is the filter's measurement noise, its correlated part a further state of each pair. The
error that all places share is added in the end, to places and, as an error of the scale, to
velocities.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import erfc, sqrt
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from curlshot.data.measurement import Duplicate
from curlshot.data.tracks import TRACK_COLUMNS, Columns, Table, no_rows, teams
from curlshot.physics.filter.rate_filter import filtered, shared_response
from curlshot.physics.filter.spin_loss import spin_loss
from curlshot.physics.filter.stretch import GATE, PATIENCE, START_SD, Filter, Model, Stretch
from curlshot.physics.local_fit.fit import fit_shot
from curlshot.physics.local_fit.glides import free, measure_glides
from curlshot.physics.local_fit.hit_detection import HitCandidate, cut_all
from curlshot.physics.local_fit.last_pictures import widen_last
from curlshot.physics.local_fit.noise import Noise, noises
from curlshot.physics.local_fit.off_centre import centred
from curlshot.physics.local_fit.segments import lies_still
from curlshot.physics.local_fit.shared_spin import share_spins
from curlshot.physics.local_fit.solution import LocalFit
from curlshot.physics.local_fit.traces import Trace, traces

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]

UNTOLD = 2.5
"""Standard deviation from which a spin is unknown, rad/s."""

UNSEEN_SCALE = 0.4
"""Part of `Trace.sd_scale` that adds to the errors of velocities: the rest, which changes under
way, is among the lasting errors of the places, which the filter knows. Of the velocities of 68
drawn clips of three makers .965 lie within two standard errors (.976 with 0.8, .961 with none of
it); clip by clip these are .90 to .98 in 28, fewer in 5 and more in 35 (with 0.8 in 21, 2, 45)."""


def smooth(
    detections: Table,
    contacts: Sequence[HitCandidate],
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
    run: Filter = filtered,
    duplicates: Mapping[int, Duplicate] = MappingProxyType({}),
) -> pd.DataFrame:
    """Turn detections into tracks, as a DataFrame: see `smoothed`."""
    import pandas as pd

    return pd.DataFrame(
        smoothed(detections, contacts, radius=radius, masses=masses, run=run, duplicates=duplicates)
    )


def smoothed(
    detections: Table,
    contacts: Sequence[HitCandidate],
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
    run: Filter = filtered,
    duplicates: Mapping[int, Duplicate] = MappingProxyType({}),
) -> Columns:
    """Turn detections into tracks: one row per stone and time from its first to its last.

    Parameters
    ----------
    detections : Table
        Of `curlshot.data.tracks.DETECTION_COLUMNS` at least ``stone, t, x, y``; standard deviations
        are estimated where missing, frames without a number are counted.
    contacts : sequence of HitCandidate
        The hits. The filter never runs across one. What both sides share is put right besides:
        their spins, by how hits change them; caps beside centres; and where a stone was seen once
        at most between two hits, its way is told by its motion outside them.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; all are equal if not given.
    run : Filter
        Filters one stone from hit to hit; `curlshot.physics.filter.reference_filter.filtered` does
        it with matrices.
    duplicates : mapping of int to Duplicate
        Frames that repeat one before. Nothing was measured in them, and they have states at their
        own times, also those that repeat the last frame in which a stone was seen.

    Returns
    -------
    Columns
        `curlshot.data.tracks.TRACK_COLUMNS`. ``seen`` is 0 in rows at which other stones were seen
        but not this one, at `duplicates`, or at which its detection was refused as an outlier.
        Angles and spins are NaN where the stone's angle was not seen from one hit to the next,
        velocities where it was seen once. The standard deviations of places include what the
        detections share (``sd_place_x``, ``sd_place_y``).
    """
    known = centred(traces(detections), contacts, radius)
    if not known:
        return no_rows(TRACK_COLUMNS)
    t = np.asarray(detections["t"], float)
    rank = detections["frame"] if "frame" in detections else np.unique(t, return_inverse=True)[1]
    times, first = np.unique(np.append(t, [d.t for d in duplicates.values()]), return_index=True)
    frames = np.append(np.asarray(rank, int), np.array([*duplicates], int))[first]
    fit, model, noise = _fit_pieces(known, contacts, radius)
    stones, at_end = {}, {}
    for name, trace in known.items():
        last = frames[times == trace.t[-1]]
        after = (times > trace.t[-1]) & np.isin(frames, _repeating(last, duplicates))
        inside = (times >= trace.t[0]) & (times <= trace.t[-1]) | after
        at_end[name] = int(after.sum())
        hits = sorted((c for c in contacts if name in c.stones), key=lambda c: c.t)
        when = times[inside], frames[inside]
        stones[name] = _cut_at_hits(trace, *when, hits, fit, model, noise[name], radius)
    loss = spin_loss([glide for stone in stones.values() for glide in stone.glides])
    model = replace(model, spin_loss=loss[0], sd_spin_loss=loss[1])
    each: dict[str, Columns] = {}
    shared: dict[str, Floats] = {}
    for name, stone in stones.items():
        each[name], shared[name] = _track(stone, model, run)
    share_spins(each, contacts, radius, masses, shared)
    for name, stone in stones.items():
        for column, alike in zip(("sd_x", "sd_y"), stone.trace.sd_place[stone.row].T, strict=True):
            each[name][column] = np.hypot(each[name][column], alike)
    widen_last(each, contacts, radius, masses, at_end)
    team, tables = teams(detections), list(each.values())
    tracks = {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}
    tracks["team"] = np.array([team[stone] for stone in tracks["stone"].tolist()])
    return {name: tracks[name] for name in TRACK_COLUMNS}


def _repeating(frames: NDArray[np.int64], duplicates: Mapping[int, Duplicate]) -> list[int]:
    """Return the frames that show one of these again, as duplicates of it or of a duplicate."""
    known = set(frames.tolist())
    found = []
    for frame, duplicate in sorted(duplicates.items()):
        if duplicate.of in known:
            known.add(frame)
            found.append(frame)
    return found


def _fit_pieces(
    known: dict[str, Trace], contacts: Sequence[HitCandidate], radius: float
) -> tuple[LocalFit, Model, dict[str, Noise]]:
    """Fit each stretch between hits by itself: rests, the law of the ice, noise of detections."""
    by_hits, _ = cut_all(known, contacts, radius)
    pieces = [replace(piece, opens=None, closes=None) for piece in by_hits]
    loose = fit_shot(known, pieces, (), radius, deceleration=free(radius))
    glides = measure_glides(loose, known, radius)
    prior = glides.prior
    fit = fit_shot(known, pieces, (), radius, deceleration=prior)
    a = prior.mean if glides.told else 0.0
    along = float(np.hypot(prior.along, min(a, 0.0)))  # what gains speed does not slow
    return fit, Model(max(a, 0.0), along, prior.share, prior.sd_share), noises(fit, known)


@dataclass(frozen=True)
class _Stone:
    """One stone all the time: its stretches from hit to hit, where it is seen in them at all.

    Attributes
    ----------
    trace : Trace
        Its detections.
    t, frames, row, part : (n,) array
        Times, s, with their frames, the detection nearest to each, and how many hits it comes
        after.
    hits : sequence of HitCandidate
        Of the stone, in order of time.
    stretches : list of (array of int, Stretch)
        Which of the times each holds, and what the filter is given.
    """

    trace: Trace
    t: Floats
    frames: NDArray[np.int64]
    row: NDArray[np.int64]
    part: NDArray[np.int64]
    hits: Sequence[HitCandidate]
    stretches: list[tuple[NDArray[np.intp], Stretch]]

    @property
    def glides(self) -> list[tuple[Stretch, Floats]]:
        """Stretches, and what their angles are off by together, (n, 2), rad."""
        return [(stretch, self.trace.rise[self.row[at]]) for at, stretch in self.stretches]


def _cut_at_hits(
    trace: Trace,
    t: Floats,
    frames: NDArray[np.int64],
    hits: Sequence[HitCandidate],
    fit: LocalFit,
    model: Model,
    noise: Noise,
    radius: float,
) -> _Stone:
    """Cut one stone's detections at its hits; leave out what begins a stretch, or a rest, far off.

    Parameters
    ----------
    trace : Trace
        The detections.
    t, frames : (n,) array
        Times at which states are wanted, s, and their frames.
    hits : sequence of HitCandidate
        Of the stone, in order of time.
    fit : LocalFit
        Of the pieces of all stones, each by itself.
    model : Model
        How the ice slows it.
    noise : Noise
        Of the detections.
    radius : float
        Of the discs, m.
    """
    row = np.clip(np.searchsorted(trace.t, t), 0, len(trace.t) - 1)
    sighted = trace.t[row] == t
    piece, rest, idle, speed = _modes(trace.stone, t, fit)
    z = np.column_stack([trace.xy[row], trace.theta[row]])
    z[~sighted] = np.nan
    white, slow = noise.white[row], noise.slow[row]
    residual = _residuals(fit, piece, t, z[:, :2]) / np.hypot(white, slow)[:, :2]
    part = np.searchsorted(np.array([hit.t for hit in hits]), t, side="right")
    motion = _motions(trace, piece, rest, fit, radius)
    stretches = []
    for k in np.unique(part):
        at = np.flatnonzero(part == k)
        stretch = Stretch(
            t[at], z[at], white[at], slow[at], motion[at], rest[at], idle[at], speed[at], model
        )
        for begin in (0, *(np.flatnonzero(stretch.moved) + 1).tolist()):
            stretch.z[_false_start(at[begin:], residual) - at[0]] = np.nan
        if np.isfinite(stretch.z[:, 0]).any():
            stretches.append((at, stretch))
    return _Stone(trace, t, frames, row, part, hits, stretches)


def _track(stone: _Stone, model: Model, run: Filter) -> tuple[Columns, Floats]:
    """Run the filter over one stone, hit to hit; errors of places without what these share.

    Also gives the errors that its spins share, (n, 3), rad/s: by one standard error each of what
    its angles share along either axis of the cap, and of what spin the ice takes.
    """
    trace, t, row, hits, part = stone.trace, stone.t, stone.row, stone.hits, stone.part
    mean, spread = np.full((len(t), 6), np.nan), np.full((len(t), 6), np.nan)
    seen, shared = np.zeros(len(t), dtype=int), np.zeros((len(t), 2, 3))
    sighted = np.zeros(len(t), dtype=bool)
    for at, cut in stone.stretches:
        sighted[at] = np.isfinite(cut.z[:, 0])
        stretch = replace(cut, model=model)
        mean[at], spread[at], seen[at] = run(stretch)
        _carry(stretch, mean, spread, at)
        shared[at] = shared_response(stretch, trace.rise[row[at]])
    spread[:, 4:] = np.hypot(spread[:, 4:], np.linalg.norm(shared, axis=2))
    for k in np.unique(part):
        at = np.flatnonzero(part == k)
        if 0 < k < len(hits) and sighted[at].sum() < 2:
            _interpolate(hits, part, t, mean, spread, at)
    untold = spread[:, 5] > UNTOLD
    if not np.isfinite(trace.theta).any():
        untold[:] = True
    mean[untold, 4:], spread[untold, 4:] = np.nan, np.nan
    _widen(hits, part, t, mean, spread)
    size = np.hypot(mean[:, 2], mean[:, 3])
    spread[:, 2:4] = np.hypot(spread[:, 2:4], UNSEEN_SCALE * trace.sd_scale[row] * size[:, None])
    if len(trace.t) == 1:
        # One look tells a place and an angle, but nothing of motion.
        mean[:, [2, 3, 5]], spread[:, [2, 3, 5]] = np.nan, np.nan
    columns = ("x", "y", "vx", "vy", "theta", "omega")
    table = {"stone": np.full(len(t), trace.stone), "frame": stone.frames, "t": t, "seen": seen}
    table |= {name: mean[:, i] for i, name in enumerate(columns)}
    table |= {f"sd_{name}": spread[:, i] for i, name in enumerate(columns)}
    return table, shared[:, 1]


def _carry(cut: Stretch, mean: Floats, spread: Floats, at: NDArray[np.intp]) -> None:
    """Carry a stone that rests elsewhere than before from there to here, in the time between.

    Between the last detection at one place and the first at the other it may be anywhere on the
    way, and move and turn at any speed.
    """
    sighted = np.flatnonzero(np.isfinite(cut.z[:, 0]))
    for row in np.flatnonzero(cut.moved).tolist():
        before, after = sighted[sighted <= row], sighted[sighted > row]
        if not (len(before) and len(after)):
            continue
        ends = [before[-1], after[0]]
        rows, (begin, end) = at[ends[0] + 1 : ends[1]], at[ends]
        way, lasts = mean[end, :2] - mean[begin, :2], cut.t[ends[1]] - cut.t[ends[0]]
        share = (cut.t[ends[0] + 1 : ends[1]] - cut.t[ends[0]]) / lasts
        mean[rows, :2] = mean[begin, :2] + share[:, None] * way
        far = float(np.hypot(*way))
        spread[rows, :2] = np.hypot(spread[end, :2], far / sqrt(12))
        mean[rows, 2:4], spread[rows, 2:4] = way / lasts, far / lasts
        mean[rows, 4:], spread[rows, 4:] = np.nan, np.nan


def _residuals(fit: LocalFit, piece: NDArray[np.int64], t: Floats, xy: Floats) -> Floats:
    """How far detections are from the fits of their pieces, (n, 2), m; NaN where there are none."""
    out = np.empty_like(xy)
    for rank in np.unique(piece):
        own = piece == rank
        out[own] = xy[own] - fit.places(int(rank), t[own])
    return out


def _false_start(at: NDArray[np.intp], residual: Floats) -> NDArray[np.intp]:
    """Tell which rows begin a stretch far off its fit, where those after them lie on it.

    A filter believes what it begins with, and would refuse the good ones that follow.

    Parameters
    ----------
    at : (m,) array of int
        The rows between two hits, or from where it lies elsewhere on.
    residual : (n, 2) array
        How far all detections are from their fits, in their standard deviations.
    """
    seen = at[np.isfinite(residual[at, 0])]
    good = (residual[seen[: PATIENCE + 1]] ** 2).sum(axis=1) < GATE
    return np.asarray(seen[: int(good.argmax())] if good.any() else seen[:0])


def _modes(
    stone: str, t: Floats, fit: LocalFit
) -> tuple[NDArray[np.int64], NDArray[np.bool_], NDArray[np.bool_], Floats]:
    """Per time: rank of its piece, whether it rests, whether its spin does too, rough velocity."""
    ranks = np.zeros(len(t), dtype=int)
    rest = np.ones(len(t), dtype=bool)
    idle = np.ones(len(t), dtype=bool)
    speed = np.zeros((len(t), 2))
    for i, piece in enumerate(fit.pieces):
        if piece.stone != stone:
            continue
        inside = np.flatnonzero((t >= piece.start) & (t < piece.end))
        ranks[inside] = i
        if piece.rest:
            continue
        rest[inside] = t[inside] > fit.stop(i)
        idle[inside] = False  # it may spin on the spot for a while
        speed[inside] = fit.speeds(i, t[inside])
    return ranks, rest, idle, speed


def _motions(
    trace: Trace, piece: NDArray[np.int64], rest: NDArray[np.bool_], fit: LocalFit, radius: float
) -> NDArray[np.int64]:
    """Tell motions apart: pieces, but a rest that is kept apart for a hit is one with its stop."""
    out = piece.copy()
    for k in np.flatnonzero(rest[:-1] & rest[1:] & (np.diff(piece) != 0)).tolist():
        before, after = fit.pieces[piece[k]], fit.pieces[piece[k + 1]]
        lay = before.samples[before.rest | (trace.t[before.samples] > fit.stop(piece[k]))]
        # One that was not seen to lie elsewhere lies where it came to rest.
        if lies_still(trace, replace(before, samples=lay), after, radius):
            out[piece == piece[k + 1]] = out[k]
    return out


def _interpolate(
    hits: Sequence[HitCandidate],
    part: NDArray[np.int64],
    t: Floats,
    mean: Floats,
    spread: Floats,
    at: NDArray[np.int64],
) -> None:
    """Interpolate between two hits a stone that was seen once there or never.

    On a straight line between its places at the two hits, extrapolated from its motion before the
    first and after the second.

    Parameters
    ----------
    hits : sequence of HitCandidate
        Of the stone, in order of time.
    part : (n,) array of int
        How many of them each row comes after.
    t : (n,) array
        Times of the rows, s.
    mean, spread : (n, 6) array
        States and their standard deviations, NaN where the stone was never seen; rows `at` are
        changed.
    at : (m,) array of int
        The rows between the two hits.
    """
    told = np.flatnonzero(np.isfinite(mean[:, 0]) & (part != part[at[0]]))
    after = int(np.searchsorted(told, at[0]))
    beside = told[after - 1 : after + 1]
    first, last = hits[part[beside[0]]], hits[part[beside[1]] - 1]
    ahead = np.array([first.t, last.t])[:, None] - t[beside][:, None]
    place = mean[beside, :2] + ahead * mean[beside, 2:4]
    speed = (place[1] - place[0]) / (last.t - first.t)
    late = np.array([[first.stderr_t], [last.stderr_t]]) * (speed - mean[beside, 2:4])
    error = np.sqrt(spread[beside, :2] ** 2 + (ahead * spread[beside, 2:4]) ** 2 + late**2)
    more_hits = part[beside[1]] - part[beside[0]] - 2  # the line knows nothing of them
    mean[at, 2:4] = speed
    spread[at, 2:4] = np.hypot(*error) / (last.t - first.t) + START_SD[0] * more_hits
    unseen = at[np.isnan(mean[at, 0])]
    mean[unseen, :2] = place[0] + (t[unseen] - first.t)[:, None] * speed
    spread[unseen, :2] = np.hypot(*error) + START_SD[0] * more_hits * (last.t - first.t)


def _widen(
    hits: Sequence[HitCandidate], part: NDArray[np.int64], t: Floats, mean: Floats, spread: Floats
) -> None:
    """Widen the errors of velocity and spin of rows that may lie on the other side of a hit.

    With the probability p that a row does, its rates have p (1 - p) times the square of their
    change in the hit added to their variance. Parameters as of `_interpolate`; ``spread`` is
    changed.
    """
    rates = [2, 3, 5]
    for k, hit in enumerate(hits, 1):
        after = int(np.searchsorted(part, k))
        if not 0 < after < len(t):
            continue
        for row in (after - 1, after):
            p = 0.5 * erfc(abs(t[row] - hit.t) / max(sqrt(2) * hit.stderr_t, 1e-9))
            change = np.nan_to_num(mean[after, rates] - mean[after - 1, rates])
            spread[row, rates] = np.hypot(spread[row, rates], sqrt(p * (1 - p)) * change)
