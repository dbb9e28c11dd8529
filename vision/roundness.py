"""How far the middle of a stone's edges may be off the stone: by how round they are.

What displaces an edge (light from a side, a bevel, a highlight, a cap that is not mounted true)
moves the middle of the circle and bends the circle too. That it is bent can be seen.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from vision.sighting import Sighting

WHOLE = 0.8
"""Share of the circle that must be seen."""

SHARE = 3.0
"""How far the middle may be off, per axis, in root mean squares of the harmonics that bend the
circle: what goes once around is larger than what goes around several times."""

USUAL = 0.0005
"""What bends a stone's circle as a rule, m: it counts as one stone more."""


def edge_error(stones: Iterable[Sequence[Sighting]]) -> float:
    """Give the standard error, per axis, of places by the edges of cap and granite, m.

    Parameters
    ----------
    stones : iterable of sequences of Sighting
        The sightings of each stone; all stones of a clip are made and lit alike.
    """
    lasting = [
        np.median([s.bends for s in whole], axis=0)
        for sightings in stones
        if (whole := [s for s in sightings if s.visible > WHOLE])
    ]
    squares = [USUAL**2, *(float(np.mean(bends**2)) for bends in lasting)]
    return SHARE * float(np.sqrt(np.mean(squares)))
