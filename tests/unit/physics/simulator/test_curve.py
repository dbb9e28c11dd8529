from __future__ import annotations

import math

import numpy as np
import pytest

from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, Fit, IceLaw, Penner
from curlshot.physics.simulator.curve import curve
from curlshot.physics.simulator.motion import Motion, Path


@pytest.mark.parametrize("law", [Constant(), FCV1(), Penner(), Fit()])
@pytest.mark.parametrize("curl", [NoCurl(), FCV1Curl()])
def test_a_finer_curve_changes_nothing(law: IceLaw, curl: NoCurl | FCV1Curl) -> None:
    coarse, fine = curve(law, curl, 4.0), curve(law, curl, 4.0, 2 * 2048)
    for tau in np.linspace(0.1, 0.99 * coarse.tau[-1], 50):
        one, s = coarse.cell(float(tau))
        two, r = fine.cell(float(tau))
        for name, a, b in zip(one._fields[:-1], one[:-1], two[:-1], strict=True):
            at_s = a[0] + s * (a[1] + s * (a[2] + s * a[3]))
            at_r = b[0] + r * (b[1] + r * (b[2] + r * b[3]))
            # FCV1's loss of spin has a kink, which costs the spin the last digits.
            bound = 1e-5 if name in ("loss", "unwound") else 1e-9
            assert at_s == pytest.approx(at_r, abs=bound), name


def test_fast_stones_have_their_own_curve() -> None:
    path = Path(0.0, Motion(0.0, 0.0, 0.0, 0.0, 40.0, 1.0), FCV1(), FCV1Curl())
    assert math.hypot(path.at(0.0).vx, path.at(0.0).vy) == pytest.approx(40.0, rel=1e-12)
    assert path.at(1e6).vy == 0.0
