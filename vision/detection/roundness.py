"""How far the middle of a stone's edges may be off the stone: by what its edges show.

What displaces an edge (light from a side, a bevel, a highlight, a cap that is not mounted true)
moves the middle of the circle and bends the circle too. That it is bent can be seen. What pixels
and their noise do to an edge bends the circle as well, but moves its middle no further than that,
but for small stones, whose waves pixels are too coarse to show. And what draws the edge of a cap
by hue and that by lightness apart has moved at least one of them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.detection.detection import Detection

Array = NDArray[np.float64]

WHOLE = 0.8
"""Share of the circle that must be seen."""

PIXELS = 0.09
"""What pixels do to each wave around a circle, once around or several times, px, at most: rendered
stones, which are round, show .04 to .10, sprites of filmed ones .08 to .20. What pixels are held
for is not held for the stone's own: with .10 films lay outside of what is stated."""

SHARE = 4.5
"""How far the middle may be off, per axis, in root mean squares of the harmonics that bend the
circle more than pixels do: what goes once around is larger than what goes around several times."""

SMALL = 3.2
"""How far pixels move the middle of a small circle, px, times the square of its radius, px: of caps
4.2 to 6.2 px large, 36 rendered ones lay 1.7 to 4.4 mm off."""

APART, MOST_APART = 0.3, 0.0012
"""What the edges by hue and by lightness lie apart counts so much, up to this, m: beyond, the one
by lightness is none of the cap's. These numbers are likely by 500 drawn stones of 66 clips of four
renderers; filmed ones, whose truth is good to some mm, would have more."""

USUAL, USUAL_STONES = 0.0005, 1 / 3
"""What bends a stone's circle as a rule, m, and as how many stones that counts: some are round to
a tenth of it, others bent by twice as much, so that it says little once stones are seen."""


def edge_errors(stones: Sequence[Sequence[Detection]], radius: float) -> Array:
    """Give the standard errors, x and y, of places by the edges of cap and granite, m.

    Parameters
    ----------
    stones : sequence of sequences of Detection
        The detections of each stone; all stones of a clip are made and lit alike, and so bent.
    radius : float
        Of the caps, or of discs without one, m.

    Returns
    -------
    ndarray, shape (stones, 2)
    """
    told, bends, pixels, apart = [], [], [], []
    for k, each in enumerate(stones):  # one after the other: they may be made as they are asked for
        whole = [(*s.light, s.pixel_size, *s.bends) for s in each if s.visible > WHOLE]
        if whole:
            told.append(k)
            light, pixel, bend = np.split(np.array(whole), [2, 3], axis=1)
            bends.append(np.median(bend, axis=0))
            pixels.append(np.median(pixel))
            apart.append(_apart(light))
    sizes = np.array(pixels)
    bent = (USUAL_STONES * USUAL**2 + np.square(bends).sum() / 6) / (USUAL_STONES + len(told))
    by_pixels = min(bent, PIXELS**2 * float((sizes**2).sum()) / max(len(told), 1))
    shape = by_pixels + SHARE**2 * (bent - by_pixels)
    found = np.full((len(stones), 2), shape)
    found[told] += (SMALL * sizes**3 / radius**2)[:, None] ** 2
    found[told] += np.reshape(apart, (-1, 2)) ** 2
    return np.asarray(np.sqrt(found))


def _apart(light: Array) -> Array:
    """Tell how far the middle may be off as edges by hue and by lightness are apart, (2,), m."""
    light = light[np.isfinite(light).all(1)]
    off = np.median(light, axis=0) if len(light) else np.zeros(2)
    return np.asarray(APART * np.minimum(np.abs(off), MOST_APART))
