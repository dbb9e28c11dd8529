"""Bias of edges where blur acted on linear light, before gamma coding.

Lens, sensor and shutter blur light; the camera codes what they give by a curve close to a power of
1 / 2.2 (ITU-R BT.709), and later steps (resizing, compression) blur codes. Where light was blurred,
half way between two codes lies inside the darker colour: by a third of a pixel for a navy ring in
white ice. The profile hardly looks otherwise; but channels in which the colours differ more are
moved more, and that tells the one blur from the other. A lens that draws channels apart moves both
edges of a ring the same way; this moves them against each other.
"""

from __future__ import annotations

from dataclasses import replace
from math import erf, inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.paint import CIRCLES, EIGHT, TWELVE
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.robust import regress
from curlshot.vision.sheet.edges import SHARPNESS
from curlshot.vision.sheet.marks import Evidence, profiles
from curlshot.vision.sheet.normals import SAMPLES, lay_out
from curlshot.vision.sheet.outline import PaintEdge
from curlshot.vision.video.picture import TO_CHROMA, Picture

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

GAMMA = 2.2
"""Light is this power of its code, nearly."""

REACH, SPACING, MOST = 7.0, 3.0, 480
"""Half length of the normals, their distance and how many on a circle at most, px."""

LEAST = 40.0
"""Difference of two colours in a channel below which its edge is not looked at, codes."""

ALIKE = 0.15
"""How far the sides of an edge may be from the usual ones, in steps from one to the other."""

LEAST_EDGES = 30
"""Edges of each kind that must show both colours."""

ASTRAY = 0.03
"""How far something else (an outline, a lens, the coding of colours) moves channels apart, px."""

APART = 2.5
"""How far the channels may contradict each other, or what is possible, in standard deviations."""

UNTOLD = 0.25
"""What is not known of the share of light where an outline hides it, or nothing tells it."""

VAGUE = 0.5
"""Standard error of a share that does not tell what is possible from what is not quite."""

MOST_LINE = 0.15
"""Line beside the paint, px, from which on colours moved apart tell nothing of light."""

WHOLE, MOST_SHARE = 0.7, 0.85
"""Share of the blur that channels show where all of it is of light, as pictures with truth show:
pixels, and reading between them, blur codes as well. More than the second is an outline's doing,
which moves channels apart as light does."""

ROUNDS = 4

_SHARES = np.linspace(0.0, 1.0, 101)
_EXPECTED = np.full(101, 1 / 101)
_EXPECTED[0] += 1.0
_EXPECTED[80:] += 1 / 21

_DEVIATES = np.linspace(-5.0, 5.0, 201)
_BLURRED = np.array([0.5 * (1 + erf(x / sqrt(2))) for x in _DEVIATES.tolist()])
_END = SAMPLES // 5


def lit(edge: PaintEdge, picture: Picture, view: View, rig: Array, evidence: Evidence) -> PaintEdge:
    """Correct an edge for blur of linear light, as far as the picture shows how much there was.

    Parameters
    ----------
    edge : PaintEdge
        As it is if codes were blurred. One with a line beside it stays there, but is less sure:
        a line moves channels apart as well.
    picture : Picture
    view, rig : View, ndarray
        The camera, as in `curlshot.vision.optics.pose` and `curlshot.vision.optics.rig`.
    evidence : Evidence
        What was measured with it.
    """
    slope = evidence.steepness
    if not slope > 0:
        return edge
    told = None if abs(edge.line) > MOST_LINE else share_of_light(picture, view, rig, slope)
    share, sd = told or (0.0, UNTOLD)
    levels = half_light(evidence.palette)[:CIRCLES]
    unsure = sd * levels[TWELVE] / slope
    light = tuple((share * levels).tolist())
    return replace(edge, sd=float(np.hypot(edge.sd, unsure)), light=light)


def half_light(palette: Array) -> Array:
    """Tell at which levels of their profiles edges lie if all blur is of light.

    Parameters
    ----------
    palette : ndarray, shape (9, 2, 3)
        Colours (blue, green, red) on either side of each kind of edge; NaN where not known.

    Returns
    -------
    ndarray, shape (9,)
        On the scale of `curlshot.vision.sheet.edges.steps`: 0 half way between the codes, and where
        not known.
    """
    low, high = np.clip(palette, 0.0, None).swapaxes(0, 1)
    half = (0.5 * (low**GAMMA + high**GAMMA)) ** (1 / GAMMA)
    axis = (high - low) @ SHARPNESS
    beyond = (axis * (half - 0.5 * (low + high))).sum(1)
    return np.asarray(np.nan_to_num(beyond / np.maximum((axis * (high - low)).sum(1), 1.0)))


def share_of_light(
    picture: Picture, view: View, rig: Array, slope: float
) -> tuple[float, float] | None:
    """Estimate the share of blur that acted on linear light, by how colour channels disagree.

    Parameters
    ----------
    picture : Picture
    view, rig : View, ndarray
        The camera, as in `curlshot.vision.optics.pose` and `curlshot.vision.optics.rig`.
    slope : float
        Of the profiles across the 12-ft edge half way, steps per px; more than 0.

    Returns
    -------
    share, sd : float
        From 0 (codes were blurred) to 1, and its standard error; what is usual where the edges of
        the outer ring have no colour. None where these are not in view, or moved by something else.
    """
    h, w = picture.shape[:2]
    normals = lay_out(
        view.vector, rig, (w, h), reach=REACH, spacing=SPACING, most=MOST, lines=False
    )
    if not {TWELVE, EIGHT} <= normals.kinds.keys():
        return None
    colours = profiles([picture], normals, normals.point[None])[0].astype(np.float64)
    middle = np.array([[w - 1], [h - 1]]) / 2
    tables: list[list[Array]] = [[], []]
    for part in (normals.kinds[TWELVE], normals.kinds[EIGHT]):
        place, normal = normals.point[:, part] - middle, normals.normal[:, part]
        # Colours are coded half a sample aside, and lenses draw channels apart from the middle.
        aside = np.append(normal, (place * normal).sum(0, keepdims=True) / w, axis=0)
        for table, (drift, apart, good) in zip(tables, _apart(colours[..., part]), strict=True):
            if good.sum() >= LEAST_EDGES:
                table.append(np.stack([np.full(good.sum(), drift), *aside[:, good], apart[good]]))
    told = np.array([_slope_of(np.hstack(t)) for t in tables if len(t) == 2]).reshape(-1, 2)
    if not len(told):
        return likely(0.0, inf)
    (moved, var), blur = told.T, 1 / (sqrt(2 * pi) * slope)
    mean, sd = np.average(moved, weights=1 / var), 1 / sqrt((1 / var).sum())
    contradict = np.abs(moved - mean) > APART * np.sqrt(var)
    share_sd = float(sd / blur) / WHOLE
    beyond = APART * sd if share_sd > VAGUE else 0.0
    if contradict.any() or not -APART * sd < mean < MOST_SHARE * blur + beyond:
        return None
    return likely(float(mean / blur) / WHOLE, share_sd)


def likely(share: float, sd: float) -> tuple[float, float]:
    """Mean and standard deviation of a share of light that was measured with such an error.

    As a rule a computer blurred codes, or a lens light: none of it is of light, or nearly all (from
    0.8 on, equally likely); one time in three it may be anything.
    """
    far = ((_SHARES - share) / sd) ** 2
    weight = _EXPECTED * np.exp(0.5 * (far.min() - far))  # the nearest one is never nothing
    weight /= weight.sum()
    mean = float(weight @ _SHARES)
    return mean, float(np.sqrt(weight @ (_SHARES - mean) ** 2))


def _apart(colours: Array) -> list[tuple[float, Array, Flags]]:
    """Tell where blue and red have the edge beside luma, colours of shape (3, SAMPLES, n).

    Returns
    -------
    list of (float, ndarray of shape (n,), ndarray of bool)
        For each of the two: how far blurred light moves it, in standard deviations of the blur;
        how far it lies aside, px; and which of the edges show it.
    """
    ends = np.stack([colours[:, :_END].mean(1), colours[:, -_END:].mean(1)])
    usual = np.median(ends, axis=2)
    step = usual[1] - usual[0]
    luma = TO_CHROMA[0]
    strength = abs(luma @ step)
    clean = (np.abs(ends - usual[..., None]) < ALIKE * max(strength, LEAST)).all((0, 1))
    drifts = np.array([_drift(*pair) for pair in usual.T])
    by_luma = luma * step / (luma @ step) @ drifts if strength > LEAST else 0.0
    middle = _middle(np.tensordot(luma, colours, 1))
    found = []
    for channel in (0, 2):
        seen = clean & (strength > LEAST) & (abs(step[channel]) > LEAST)
        apart = _middle(colours[channel]) - middle
        found.append((float(drifts[channel] - by_luma), apart, seen & np.isfinite(apart)))
    return found


def _middle(profile: Array) -> Array:
    """Middle of the rise of each profile, shape (SAMPLES, n), px from its own middle."""
    low, high = profile[:_END].mean(0), profile[-_END:].mean(0)
    area = np.trapezoid(profile - low, dx=2 * REACH / (SAMPLES - 1), axis=0)
    step = high - low
    return np.asarray(REACH - np.divide(area, step, np.full(area.shape, np.nan), where=step != 0))


def _drift(low: float, high: float) -> float:
    """How far the middle of the rise between two codes is moved by blurred light, sds of blur."""
    if abs(high - low) < 1:
        return 0.0
    light = max(low, 0.0) ** GAMMA, max(high, 0.0) ** GAMMA
    code = (light[0] + (light[1] - light[0]) * _BLURRED) ** (1 / GAMMA)
    step = _DEVIATES[1] - _DEVIATES[0]
    return float(_DEVIATES[-1] - np.trapezoid((code - low) / (high - low), dx=step))


def _slope_of(table: Array) -> tuple[float, float]:
    """Fit the last row by the others (Cauchy's loss): what the first counts, and its variance."""
    known, value = table[:-1].T, table[-1]
    found, cov, scatter = regress(known, value, width=2.0, least=1e-3, rounds=ROUNDS)
    # Neighbours see the same pixels; and what moves channels apart moves all of them.
    drift = np.abs(known[:, 0]).mean() + 1e-3
    return float(found[0]), float(4 * scatter**2 * cov[0, 0] + (ASTRAY / drift) ** 2)
