"""What tests of shared spin share."""

from __future__ import annotations

import numpy as np

from curlshot.data.tracks import Columns
from curlshot.physics.local_fit.hit_detection import HitCandidate

PUCK = 0.03
FIRST = HitCandidate(1.0, 0.001, ("A", "B"), (0.0, -1.0))
SECOND = HitCandidate(1.12, 0.001, ("B", "C"), (0.0, -1.0))


def rows(*pieces: tuple[float, float, float]) -> Columns:
    """Rows of a stone at 25 a second: from when on it has which spin, with which error."""
    t = np.arange(60) / 25 + 0.01
    start, spin, sd = np.array(pieces).T
    at = np.searchsorted(start, t, side="right") - 1
    still, vague = np.zeros(len(t)), np.full(len(t), 5.0)
    table = {"t": t, "omega": spin[at], "sd_omega": sd[at], "vx": still, "vy": still + 2.0}
    return table | dict.fromkeys(("sd_vx", "sd_vy", "sd_x", "sd_y"), vague)
