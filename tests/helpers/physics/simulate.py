"""What tests of simulate share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from curlshot.data.results import StoneState
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, IceLaw, Penner
from curlshot.physics.impact import Frictional, Impact
from curlshot.physics.simulator.simulation import HitEvent, Shot, Simulation, StoneStart

R = 0.145
LAWS: list[IceLaw] = [Constant(), FCV1(), Penner()]


def shot(
    *stones: StoneStart,
    impact: Impact | None = None,
    ice: IceLaw | None = None,
    curl: NoCurl | FCV1Curl | None = None,
    radius: float = R,
) -> Shot:
    return Shot(stones, impact or Frictional(0.8, 0.2), ice or FCV1(), curl or FCV1Curl(), radius)


def momentum(hit: HitEvent, states: dict[str, StoneState], masses: dict[str, float]) -> np.ndarray:
    one, two = (masses[n] * np.array([states[n].vx, states[n].vy]) for n in hit.stones)
    return one + two


def energies(sim: Simulation, times: Sequence[float]) -> np.ndarray:
    table = sim.sample(times)
    each = table.vx**2 + table.vy**2 + 0.5 * R**2 * table.omega**2
    return each.groupby(table.frame).sum().to_numpy()
