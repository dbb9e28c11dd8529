"""Outer edge of paint with a thin dark outline, or of an outline alone, by a model of its profile.

The rules measure the 12-ft circle to its outer edge, and an outline is part of it. Half way from
paint to ice lies beyond that edge, for the line draws the profile down. So the mean profile is
explained by paint, a line and ice under one blur: that tells at which level a profile crosses
the edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import erfc, sqrt

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.sheet.edges import crossings

Array = NDArray[np.float64]

WIDTH, WIDTH_SPREAD = 1.4, 0.7
"""Usual width of a line, px, and the standard deviation of its logarithm."""

BLUR, BLUR_SPREAD = 0.85, 0.7
"""Usual standard deviation of the blur, px, and that of its logarithm."""

DEPTH_SD = 0.5
"""How far a line may be from the paint's colour, in steps from paint to ice."""

MISFIT = 0.01
"""What is left of a mean profile by the model, in steps from paint to ice."""

UNSEEN = 0.2
"""How far outlines draw the edge out, px: what is not known of it where they are not looked for."""

BARE = 0.04
"""How well an edge without a line is made out, px, as clips with truth show."""

DOUBT = 0.7
"""Share of the way from half way to the edge that is in doubt, as clips with truth show: under one
blur, a narrow dark line looks much like a wider one that is less dark."""

HALF_IN_DOUBT = 0.3
"""The same of half the width of an outline that is drawn alone."""

CLEAR_OF = 4.0
"""How far normals reach beyond the edge of an outline drawn alone, in halves of its width: the
outer quarters of a profile, which tell what is beside it, are clear of it so."""

LEAST_SIDE = 4
"""Samples of a profile on either side without which no line is looked for: what paint and ice are
like there is not known."""

LIGHT = np.array([-1.5, 0.4, 0.0, 0.0, -0.5, 0.0])
"""Where the fit starts a second time, beside what is usual: with a line nearer to the ice in colour
than to the paint half way from ice to paint is on its inner side, and the way to its outer one
leads through worse fits."""

RARE = 4.0
"""How much rarer such lines are than others, as a logarithm."""

FROM_ICE = 0.15
"""Least that such a line differs from the ice, in steps from paint to ice: what differs less has no
edge that single profiles show."""

STEEP = 1.5
"""How much steeper than single profiles, which are noisy, their mean may be where nothing moves."""

ROUNDS, DONE = 60, 1e-3
"""Most steps of the fit (Levenberg, 1944), and the gain of a step after which it is done."""


@dataclass(frozen=True)
class PaintEdge:
    """The edge of the paint in the profiles across it.

    Attributes
    ----------
    level : float
        Level of a profile there: −0.5 in the ice, 0.5 in the paint.
    sd : float
        Standard deviation of the edge's place, px, alike all along it.
    line : float
        How far the line moves the place half way between ice and paint off the edge, px, if the
        edge is blurred by much more than the line is wide: its depth times its width. At least as
        far as the level is from half way where nothing blurs the edge.
    within : float
        How far within the edge the middle of an outline lies that is drawn alone, px; alike for
        all circles, each of which is measured to its outer side.
    light : tuple of float
        Levels at which the circles (12, 8 and 4 ft) are crossed beside that, as light was blurred
        before it was coded (see `curlshot.vision.sheet.mixing`).
    """

    level: float = 0.0
    sd: float = UNSEEN
    line: float = 0.0
    within: float = 0.0
    light: tuple[float, ...] = (0.0, 0.0, 0.0)

    @property
    def reach(self) -> float:
        """How much longer normals must be to show what is beside an outline drawn alone, px."""
        return CLEAR_OF * self.within

    def beyond(self, slope: Array | float) -> Array:
        """How far beyond the edge profiles cross the level, px, by their slopes there, per px.

        The level is that of a picture in which things rest. Where a pan blurs the edge, the level
        lies far from half way, but the edge lies no farther than the line would have it.
        """
        away = self.level / slope
        return np.asarray(away - np.clip(away, -abs(self.line), abs(self.line)))

    def aside(self, slope: float) -> Array:
        """How far along their normals circles are from half way, (3,), px; slope as `beyond`."""
        found = np.array(self.light) / slope
        found[0] += self.level / slope - float(self.beyond(slope))
        return found - self.within


HALF_WAY = PaintEdge()
"""An edge without a line: half way from ice to paint."""


def find_edge(profile: Array, step: float) -> PaintEdge:
    """Find the edge of the paint in a mean profile.

    Parameters
    ----------
    profile : ndarray, shape (n,)
        From the ice (about −0.5) to the paint (about 0.5), 0 near the middle; NaN where unknown.
    step : float
        From one sample to the next, px.
    """
    known = np.isfinite(profile)
    x = np.asarray(step * (np.arange(len(profile)) - len(profile) // 2)[known], np.float64)
    y = profile[known]
    if len(y) < 12 or min(-x[0], x[-1]) < LEAST_SIDE * abs(step):
        return HALF_WAY
    ice, paint = float(y[:3].mean()), float(y[-3:].mean())
    alone = y.max() - paint > 2 * (paint - ice)  # an outline, and ice behind it as well
    outlined = x[y > 0.5 * (y.max() + ice)] if alone else _half_way(x, y)
    if not len(outlined):
        return HALF_WAY
    depth = y.max() - paint if alone else 0.0
    mean: Array = np.array([outlined[0], np.log(WIDTH), np.log(BLUR), paint, depth, ice])
    if alone:
        start = mean.copy()
        start[1] = np.log(np.ptp(outlined) + abs(step))
        _, now, covariance = _fitted(x, y, mean, start)
        half = 0.5 * float(np.exp(now[1]))
        sd = half * np.hypot(np.sqrt(covariance[1, 1]), HALF_IN_DOUBT)
        return PaintEdge(0.0, float(np.hypot(sd, BARE)), within=half)
    cost, now, covariance = _fitted(x, y, mean, mean)
    light_cost, light, light_covariance = _fitted(x, y, mean, mean + LIGHT)
    other = 0.0
    if 1 + light[4] > FROM_ICE:
        taken = 0.5 + 0.5 * np.tanh(0.25 * (cost - light_cost) - 0.5 * RARE)
        other = (light[0] - now[0]) * np.sqrt(min(taken, 1 - taken))
        if taken > 0.5:
            now, covariance = light, light_covariance
    moved = now[0] - mean[0]
    sd = np.sqrt(covariance[0, 0] + (DOUBT * moved) ** 2 + BARE**2 + other**2)
    level = float(np.interp(now[0], x, y))
    _, slope = _model(now[:1], now)
    flat = STEEP * level / max(-float(slope[0, 0]), 1e-3)
    line = float(now[4] * np.exp(now[1]))
    return PaintEdge(level, float(sd), max(line, flat, key=abs))


def _fitted(x: Array, y: Array, mean: Array, start: Array) -> tuple[float, Array, Array]:
    """Fit the model of a profile from a start: cost, unknowns as `_model`'s, and covariance."""
    weight = np.array([1.0, WIDTH_SPREAD, BLUR_SPREAD, 0.3, DEPTH_SD, 0.3]) ** -2.0
    now, damping = start.copy(), 1e-3
    value, slope = _model(x, now)
    cost = _cost(y - value, now - mean, weight)
    normal = np.diag(weight)
    for _ in range(ROUNDS):
        normal = slope.T @ slope / MISFIT**2 + np.diag(weight)
        right = slope.T @ (y - value) / MISFIT**2 - weight * (now - mean)
        change = np.linalg.solve(normal + damping * np.diag(normal.diagonal()), right)
        tried = np.asarray(now + change, np.float64)
        ahead, ahead_slope = _model(x, tried)
        new = _cost(y - ahead, tried - mean, weight)
        gain = cost - new
        if gain > 0:
            now, value, slope, cost, damping = tried, ahead, ahead_slope, new, damping / 5
            if gain < DONE:
                break
        else:
            damping *= 10
    return cost, now, np.asarray(np.linalg.inv(normal), np.float64)


def _half_way(x: Array, y: Array) -> Array:
    """Where a profile rises from ice to paint, shape (1,), or (0,) if it does not.

    What is expected of a line is beside that place, wherever the profile was expected to rise: else
    what was found by the profiles of one measurement would be found beside it by the next, and on.
    """
    sample, _, found = crossings(y[:, None].astype(np.float32))
    return np.asarray(np.interp(sample[found], np.arange(len(x)), x))


def _cost(residual: Array, off: Array, weight: Array) -> float:
    return float((residual**2).sum()) / MISFIT**2 + float(weight @ off**2)


def _model(x: Array, unknown: Array) -> tuple[Array, Array]:
    """Profile of ice, line and paint, and its derivatives, shape (n, 6).

    Unknowns: place of the edge, logarithms of the line's width and of the blur, levels of the
    paint, of the line below the paint, and of the ice.
    """
    edge, log_width, log_blur, paint, depth, ice = unknown
    width, blur = np.exp(log_width), np.exp(log_blur)
    u, v = (x - edge) / blur, (x - edge - width) / blur
    within, beyond = _normal(u), _normal(v)
    bell = np.exp(-0.5 * np.stack([u, v]) ** 2) / (np.sqrt(2 * np.pi) * blur)
    line = paint + depth
    value = ice + (line - ice) * within - depth * beyond
    by_edge = -(line - ice) * bell[0] + depth * bell[1]
    by_blur = -(line - ice) * bell[0] * u * blur + depth * bell[1] * v * blur
    columns = [by_edge, depth * bell[1] * width, by_blur, within, within - beyond, 1 - within]
    return value, np.stack(columns, axis=-1)


def _normal(deviates: Array) -> Array:
    """Cumulative normal distribution; scipy's would take a tenth of a second to import."""
    return np.array([0.5 * erfc(-deviate / sqrt(2)) for deviate in deviates.tolist()])
