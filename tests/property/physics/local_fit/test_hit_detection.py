from __future__ import annotations

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.tests.helpers.physics.watch import (
    RADIUS,
    hit_motion,
    watch,
)

QUICK = (Phase.explicit, Phase.reuse, Phase.generate)  # shrinking repeats slow fits


@settings(max_examples=15, deadline=None, phases=QUICK)
@given(
    turn=st.floats(0, 2 * np.pi), x=st.floats(-20, 20), y=st.floats(-20, 20), mirror=st.booleans()
)
def test_hits_do_not_depend_on_the_axes(turn: float, x: float, y: float, mirror: bool) -> None:
    seen = watch(hit_motion(), np.random.default_rng(7))
    (hit,) = detect_hits(seen, RADIUS)
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.array([[c, -s], [s, c]]) @ np.diag([-1.0 if mirror else 1.0, 1.0])
    moved = seen.copy()
    moved[["x", "y"]] = seen[["x", "y"]].to_numpy() @ matrix.T + [x, y]
    (other,) = detect_hits(moved, RADIUS)
    assert other.t == pytest.approx(hit.t, abs=0.05 * hit.stderr_t)
    assert other.stones == hit.stones
    assert np.allclose(other.normal, matrix @ np.array(hit.normal), atol=1e-3)
