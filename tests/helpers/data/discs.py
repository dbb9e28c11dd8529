"""What tests of discs share."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.tests.helpers.physics.watch import hit_motion, watch


def shot(size: float = 1.0) -> pd.DataFrame:
    """A hit whose lengths are taken for this many times what they are."""
    table = watch(hit_motion(), np.random.default_rng(0), sd=0.004, given=False)
    return table.assign(x=size * table["x"], y=size * table["y"])
