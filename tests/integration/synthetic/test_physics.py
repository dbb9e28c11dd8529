"""The independent physics against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from curlshot.synthetic.physics import GRAVITY, Ice, Start, simulate


@pytest.mark.parametrize(("speed", "mu"), [(0.4, 0.0109), (2.0, 0.007), (3.0, 0.015)])
def test_glide_ends_where_the_closed_form_says(speed: float, mu: float) -> None:
    stop = speed / (mu * GRAVITY)
    motion = simulate([Start(0, 0, vx=0.6 * speed, vy=0.8 * speed)], stop + 0.1, ice=Ice(b=mu))
    x, y = motion.at(stop + 0.05)[0, :2]
    way = speed**2 / (2 * mu * GRAVITY)
    assert np.allclose([x, y], [0.6 * way, 0.8 * way], atol=1e-6)
    half = motion.at(stop / 2)[0]
    assert np.hypot(half[3], half[4]) == pytest.approx(speed / 2, abs=1e-5)
