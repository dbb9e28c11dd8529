"""The evidence that what is seen at a place is a stone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.appearance import Appearance
from curlshot.vision.detection.circles import Fits
from curlshot.vision.detection.edges import Views, falling_off
from curlshot.vision.detection.patch import Effort
from curlshot.vision.detection.samples import Samples

Array = NDArray[np.float64]

PALER = 3.0
"""Standard deviations of the granite's lightness by which the ring around a cap is lighter at most.
Under lamps thrown stones have 2.3; ice that letters of a cap's colour enclose 4 to 5."""

ON_ONE_SIDE = 0.2, 0.5
"""An arc on which both edges of a stone are seen counts for it from the first share of the way
around on, and more and more up to the second. On clothes edges like a stone's lie here and there,
on 0.1 to 0.35 of the way around at one side; of a stone that somebody covers by half 0.35 to 0.5
shows them. Before colours are learned, paint would profit as well."""

ENOUGH = 1.6
"""Evidence beyond which such an arc adds nothing: what changes with it would look like a stone that
has been pushed aside."""


def evidence_of(
    samples: Samples,
    fit: Fits,
    views: Views,
    appearance: Appearance,
    disc: Stone,
    effort: Effort,
) -> tuple[Array, Array]:
    """Say how much there is to be said for stones.

    Parameters
    ----------
    samples : Samples
        What is seen on the rays about n places.
    fit : Fits
        The circles of caps and granite there.
    views : Views
        How the places are seen.
    appearance : Appearance
        What stones look like here.
    disc : Stone
        Size of the stones.
    effort : Effort
        How each place is measured.

    Returns
    -------
    evidence, excused : ndarray, shape (n,)
        0 to about 3; how much more of it there would be but for a hue that is coded coarsely.
    """
    cap_radius = disc.cap_radius * appearance.outline[0]
    shown = fit.shares.sum(1) - _uneven(samples, views, disc, effort) + 0.5 * samples.response
    whole = 2 * (np.clip(fit.unbroken, *ON_ONE_SIDE) - ON_ONE_SIDE[0])

    def told(spread: Array | float) -> Array:
        misfit = ((fit.radii[:, 0] / cap_radius - 1) / spread) ** 2
        evidence, more = shown - 0.5 * misfit, whole - 0.25 * misfit
        enlarged = np.where(evidence < ENOUGH, np.minimum(evidence + more, ENOUGH), evidence)
        return np.asarray(enlarged if appearance.caps else evidence)

    usual = 0.06 + appearance.slack
    of_hue = 1 - ((samples.cap - samples.granite) * samples.apart)[:, 0]
    evidence = told(usual)
    excused = told(usual + effort.coarse * of_hue * views.pixel / cap_radius) - evidence
    return evidence - _paler(samples.level[:, 0], appearance), excused


def _uneven(samples: Samples, views: Views, disc: Stone, effort: Effort) -> Array:
    """Say how much the granite of stones is not of one lightness all around, shape (n,).

    Caps and shoulders of people are not. Behind a shoulder that falls off ice may shine.
    """
    odd = samples.light - samples.level
    through = falling_off(disc) * views.behind(effort.rays) > effort.most_tilt
    odd = np.where(through, np.minimum(odd, 0), odd)
    stony = samples.stony
    return np.asarray(np.sqrt((odd**2 * stony).sum(1) / np.maximum(stony.sum(1), 1)) / 40)


def _paler(level: Array, appearance: Appearance) -> Array:
    """Say what it counts against a stone that the ring around its cap is too light for granite.

    Parameters
    ----------
    level : ndarray, shape (n,)
        Lightness of the rings, L*.
    appearance : Appearance

    Returns
    -------
    ndarray, shape (n,)
        To be taken off the evidence; 0 where no granite is known.
    """
    if appearance.granite is None:
        return np.zeros(len(level))
    away = level - appearance.granite.mean[0]
    sd = np.sqrt(appearance.granite.covariance[0, 0])
    return np.asarray(np.maximum(away / sd - PALER, 0.0))
