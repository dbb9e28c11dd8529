from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.handles import RADII
from curlshot.tests.helpers.vision.steep_handles import (
    SLANTS,
    TIMES,
    TRUE,
    turning,
)
from curlshot.vision.spin.angles import angles_in_parts
from curlshot.vision.video.disk_cache import Cached


@pytest.mark.parametrize("turn", [0.0, 1.0, 2.5])
def test_what_is_left_is_by_the_same_axes_in_all_parts_of_a_long_track(turn: float) -> None:
    """One number says for all pictures of a stone how much steeper it is along its handle."""
    shown = [*map(Cached, turning(TRUE + turn, SLANTS, 0.35))]
    sd = np.full(len(TIMES), 0.0005)
    whole, parts = (angles_in_parts(TIMES, shown, RADII, sd, n, SLANTS).rise for n in (500, 35))
    for first, last in ((0, 34), (35, 69)):
        ways = [rise[last] - rise[first] for rise in (whole, parts)]
        assert ways[0] @ ways[1] > 0.98 * np.prod(np.linalg.norm(ways, axis=1))
