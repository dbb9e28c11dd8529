"""The detections of each stone as arrays, every place with a standard deviation."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from curlshot.data.tracks import Table

Floats = NDArray[np.float64]

SMALLEST_SD = 1e-5
"""Smallest standard deviation of a place, m: what no track at hand surpasses."""

SHARED = "sd_place_x", "sd_place_y"
"""Columns of the standard error that places near each other share."""

RISE = "rise_a", "rise_b"
"""Columns of what angles are off by together."""

PLACE_REACH = 1.0
"""Distance, m, over which the error that places share makes one of the speed: it is independent at
the two ends."""

CORRELATION_LENGTH = 0.5
"""Correlation length of the error that places share, m. Errors of stones under way, in 85
clips with truth, differ by half of their variance 60 cm apart; what differs sooner shows."""

OFF_CENTRE = 0.014
"""Standard deviation of what a cap is beside its stone's centre by, on either axis, in radii: 2 mm,
besides the error that places share, which is less where a camera looks close up. Of 67 stones cut
out of stills and moved, whose way is known, 1.7 mm (r.m.s.) were left where more was taken out."""

AROUND, SLOW = 0.5, 0.02
"""Time around a detection, s, in which a stone that goes on has gone so many m a second: on ice a
slower one stops within a quarter of a second."""

APART = 10
"""Detections at rest, and as many of a stone that goes on, from which each say how they scatter."""

FACED = 0.5
"""Time, s, within which an angle is to be told for it to be known how a stone is turned: a third of
a turn or less."""

LASTING = 0.35
"""Share of the variance of places that lasts for a while, where it is stated and not told by their
scatter. Of 211 filmed paths whose truth is known 97 were cut for nothing with none of it, 8 with
this; with half, a push of 0.1 m/s is missed."""


@dataclass(frozen=True)
class Trace:
    """The detections of one stone as arrays.

    Attributes
    ----------
    stone : str
        Its name.
    t : (n,) array
        Times, s, increasing.
    xy, sd : (n, 2) array
        Places and their standard deviations, m.
    theta, sd_theta : (n,) array
        Angle and its standard deviation, rad; NaN where unknown.
    sd_place : (n, 2) array
        Standard deviation of the error that places share, m; 0 where unknown.
    rise : (n, 2) array
        What the angles are off by together, rad, each times one number of standard deviation 1; 0
        where unknown.
    lasting : float
        Share of the variance of places that lasts for a while.
    """

    stone: str
    t: Floats
    xy: Floats
    sd: Floats
    theta: Floats
    sd_theta: Floats
    sd_place: Floats
    rise: Floats
    lasting: float = LASTING

    @property
    def step(self) -> float:
        """Usual time between two detections, s."""
        return float(np.median(np.diff(self.t))) if len(self.t) > 1 else 0.04

    @property
    def sd_scale(self) -> Floats:
        """Relative error of velocities by that of places, shape (n, 2).

        The error that places share changes under way, as if the stone had moved faster or slower.
        """
        return self.sd_place / PLACE_REACH

    @cached_property
    def usual_sd_place(self) -> float:
        """Usual standard deviation of the error that places share, m; 0 where unknown."""
        return float(np.median(self.sd_place)) if len(self.t) else 0.0

    def sd_off_centre(self, radius: float) -> float:
        """By how much a disc's cap may be beside its centre on either axis, m; 0 where unknown."""
        shared = self.usual_sd_place
        return math.hypot(shared, OFF_CENTRE * radius) if shared else 0.0

    @cached_property
    def rotations(self) -> Floats:
        """Rotations from the stone's frame to the ice, (n, 2, 2), by its angles where told."""
        told = np.isfinite(self.theta)
        theta = np.interp(self.t, self.t[told], self.theta[told])
        cos, sin = np.cos(theta), np.sin(theta)
        return np.stack([np.stack([cos, -sin], axis=1), np.stack([sin, cos], axis=1)], axis=1)

    @cached_property
    def faced(self) -> NDArray[np.bool_]:
        """Whether an angle is told within `FACED` of each of the detections, shape (n,)."""
        told = self.t[np.isfinite(self.theta)]
        if not len(told):
            return np.zeros(len(self.t), bool)
        after = np.searchsorted(told, self.t)
        ends = told[np.clip([after - 1, after], 0, len(told) - 1)]
        return np.asarray(np.abs(ends - self.t).min(0) < FACED)

    def gap(self, time: float) -> float:
        """Time between the detections either side of a time, at least the usual step, s."""
        if len(self.t) < 2:
            return self.step
        k = int(np.clip(np.searchsorted(self.t, time), 1, len(self.t) - 1))
        return max(self.step, float(self.t[k] - self.t[k - 1]))

    def until(self, end: float) -> Trace:
        """Return what was sighted before a time, s."""
        return self._only(self.t < end)

    def since(self, start: float) -> Trace:
        """Return what was sighted from a time on, s."""
        return self._only(self.t >= start)

    def _only(self, keep: NDArray[np.bool_]) -> Trace:
        names = ("t", "xy", "sd", "theta", "sd_theta", "sd_place", "rise")
        return replace(self, **{name: getattr(self, name)[keep] for name in names})

    def between(self, start: float, end: float) -> NDArray[np.bool_]:
        """Which detections lie in [start, end)."""
        return np.asarray((self.t >= start) & (self.t < end))


def traces(detections: Table) -> dict[str, Trace]:
    """Split a table of detections by stone and give every place a standard deviation.

    Where the table has none it is estimated from how places scatter about local parabolas;
    where it has some that are smaller than that scatter, they are scaled up to it.

    Parameters
    ----------
    detections : Table
        Of `curlshot.data.tracks.DETECTION_COLUMNS` at least ``stone, t, x, y``, each stone's rows
        in order of time; of the others what is not there is not known.
    """
    out: dict[str, Trace] = {}
    stones = np.asarray(detections["stone"])
    columns = {name: np.asarray(detections[name], float) for name in ("t", "x", "y")}
    for name in ("theta", "sd_x", "sd_y", "sd_theta", *SHARED, *RISE):
        own = detections[name] if name in detections else np.full(len(stones), np.nan)
        columns[name] = np.asarray(own, float)
    for name in np.unique(stones).tolist():
        own = {key: values[stones == name] for key, values in columns.items()}
        t, xy = own["t"], np.column_stack([own["x"], own["y"]])
        sd = np.column_stack([own["sd_x"], own["sd_y"]])
        theta, goes = own["theta"], _goes(t, xy)
        known = np.isfinite(theta)
        theta[known] = np.unwrap(theta[known])
        turned = theta[known][:, None]
        out[str(name)] = Trace(
            stone=str(name),
            t=t,
            xy=xy,
            sd=_filled(t, xy, sd, SMALLEST_SD, 0.005, goes),
            theta=theta,
            sd_theta=_filled_angles(t[known], turned, own["sd_theta"], known, goes[known]),
            sd_place=np.column_stack([np.nan_to_num(own[axis]) for axis in SHARED]),
            rise=np.column_stack([np.nan_to_num(own[axis]) for axis in RISE]),
            lasting=LASTING if np.isfinite(sd).any() else 0.0,
        )
    return out


def _goes(t: Floats, xy: Floats) -> NDArray[np.bool_]:
    """Whether a stone goes on at each of its detections, as far as others show it."""
    ways = [np.interp(t + 0.5 * AROUND, t, x) - np.interp(t - 0.5 * AROUND, t, x) for x in xy.T]
    return np.asarray(np.hypot(*ways) > SLOW * AROUND)


def _filled_angles(
    t: Floats, theta: Floats, sd: Floats, known: NDArray[np.bool_], goes: NDArray[np.bool_]
) -> Floats:
    out = np.full(len(known), np.nan)
    if known.any():
        out[known] = _filled(t, theta, sd[known][:, None], 1e-4, 0.05, goes)[:, 0]
    return out


def _filled(
    t: Floats, values: Floats, sd: Floats, least: float, default: float, goes: NDArray[np.bool_]
) -> Floats:
    """Fill in or scale up standard deviations from the scatter about local parabolas.

    Where none is stated, that of a stone at rest says nothing of one that goes on.
    """
    given = np.where(np.isfinite(sd) & (sd > 0), sd, np.nan)
    scatter = local_residuals(t, values)
    told = bool(np.isfinite(given).any())
    if not told and len(scatter) < 5:
        return np.full_like(values, default)
    given = np.where(np.isfinite(given), given, np.nanmedian(given) if told else 1.0)
    inner = goes[2:-2]
    apart = not told and min(inner.sum(), (~inner).sum()) >= APART
    for rows in (goes, ~goes) if apart else (np.ones(len(t), bool),):
        own = scatter[rows[2:-2]] / given[2:-2][rows[2:-2]]
        if len(own) >= 5:
            off = level(own)
            # Some of it is chance: a median of that many has an error of some 0.8 / √n.
            given[rows] *= off if not told or off > 1 + 1.6 / np.sqrt(len(own)) else 1.0
    return np.maximum(given, least)


def shared_correlation(xy: Floats) -> Floats:
    """Correlation of the error that places (n, 2), m, share: exp(-d² / 2 L²), d their distance.

    L is `CORRELATION_LENGTH`.
    """
    apart = np.sum((xy[:, None] - xy[None]) ** 2, axis=2)
    out: Floats = np.exp(-apart / (2 * CORRELATION_LENGTH**2))
    return out


def level(scatter: Floats) -> float:
    """Robust standard deviation of residuals of one or two columns, whatever their axes."""
    usual = 0.6745 if scatter.shape[1] == 1 else 1.1774  # medians of |N| and of Rayleigh's law
    return float(np.median(np.sqrt(np.sum(scatter**2, axis=1)))) / usual


def local_residuals(t: Floats, values: Floats) -> Floats:
    """Residual of each sample from the parabola through it and two samples either side.

    Scaled so that white noise keeps its standard deviation. Shape (n − 4, k); empty for
    fewer than 5 samples.
    """
    if len(t) < 5:
        return np.empty((0, values.shape[1]))
    window = np.lib.stride_tricks.sliding_window_view(t, 5)
    tau = window - window[:, 2:3]
    tau = tau / np.abs(tau).max(axis=1, keepdims=True)
    basis = np.linalg.qr(np.stack([np.ones_like(tau), tau, tau**2], axis=-1))[0]
    stack = np.lib.stride_tricks.sliding_window_view(values, 5, axis=0)
    middle = basis[:, 2, :]
    fitted = np.einsum("np,nsp,nks->nk", middle, basis, stack)
    free = 1.0 - np.sum(middle**2, axis=1)
    out: Floats = (values[2:-2] - fitted) / np.sqrt(np.maximum(free, 1e-3))[:, None]
    return out
