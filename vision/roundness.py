"""How far the middle of a stone's edges may be off the stone: by how round they are.

What displaces an edge (light from a side, a bevel, a highlight, a cap that is not mounted true)
moves the middle of the circle and bends the circle too. That it is bent can be seen. What pixels
and their noise do to an edge bends the circle as well, but moves its middle no further than that.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from vision.sighting import Sighting

WHOLE = 0.8
"""Share of the circle that must be seen."""

PIXELS = 0.08
"""What pixels do to each wave around a circle, once around or several times, px, at most: rendered
stones, which are round, show .02 to .09, sprites of filmed ones .08 to .20."""

SHARE = 4.5
"""How far the middle may be off, per axis, in root mean squares of the harmonics that bend the
circle more than pixels do: what goes once around is larger than what goes around several times.
This and `PIXELS` are the likeliest by 270 stones of 48 clips of three renderers and of films."""

USUAL, USUAL_STONES = 0.0005, 1 / 3
"""What bends a stone's circle as a rule, m, and as how many stones that counts: some are round to
a tenth of it, others bent by twice as much, so that it says little once stones are seen."""


def edge_error(stones: Iterable[Sequence[Sighting]]) -> float:
    """Give the standard error, per axis, of places by the edges of cap and granite, m.

    Parameters
    ----------
    stones : iterable of sequences of Sighting
        The sightings of each stone; all stones of a clip are made and lit alike.
    """
    seen = [whole for each in stones if (whole := [s for s in each if s.visible > WHOLE])]
    bends = np.array([np.median([s.bends for s in whole], axis=0) for whole in seen])
    sizes = np.array([np.median([s.pixel_size for s in whole]) for whole in seen])
    bent = (USUAL_STONES * USUAL**2 + (bends**2).sum() / 6) / (USUAL_STONES + len(seen))
    by_pixels = min(bent, PIXELS**2 * float((sizes**2).sum()) / max(len(seen), 1))
    return float(np.sqrt(by_pixels + SHARE**2 * (bent - by_pixels)))
