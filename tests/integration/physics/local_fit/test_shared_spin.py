from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.physics.local_fit.shared_spin import MAKES, share_spins
from curlshot.tests.helpers.physics.shared_spin import FIRST, PUCK, SECOND, rows


@pytest.mark.parametrize("told", [(0.03, 0.9, np.nan), (0.03, 0.9, 0.9), (0.3, 0.3, 0.3)])
def test_a_hit_tells_but_once(told: tuple[float, float, float]) -> None:
    """Errors of the spins of A and C after and of B between are those stated."""
    rng = np.random.default_rng(3)
    after, between, last = told
    off = []
    for _ in range(300):
        turns = rng.normal(0, 0.5, 2)
        # The other stone's changes: as far from the same as may be.
        like = turns * rng.normal(1, 0.2, 2) + rng.normal(0, 0.02, 2)
        seen = {
            "A": [(0.0, 1.5, 0.03), (1.0, 1.5 + turns[0], after)],
            "B": [(0.0, 0.0, 0.001), (1.0, like[0], between), (1.12, like[0] + turns[1], 0.03)],
            "C": [(0.0, 0.0, 0.001), (1.12, like[1], last)],
        }
        tables = {
            name: rows(
                *((t, spin + rng.normal(0, sd if sd > 0 else 0.0), sd) for t, spin, sd in of)
            )
            for name, of in seen.items()
        }
        for table in tables.values():
            for name in table:
                table[name] = table[name][:35]  # so that A's last stretch is short
        share_spins(tables, [FIRST, SECOND], PUCK)
        for name, k in (("A", 30), ("B", 26), ("C", 30)):
            error = tables[name]["omega"][k] - seen[name][1][1]
            off.append(error / tables[name]["sd_omega"][k])
    each = np.sqrt(np.mean(np.square(off).reshape(-1, 3), axis=0))
    assert all(0.85 < pull < 1.15 for pull in each[np.isfinite(each)])


def test_spins_are_as_sure_as_they_say_with_handles_of_any_make() -> None:
    """Two stones of one make, each with a steepness of its own, and spins off by that together."""
    rng = np.random.default_rng(7)
    sizes, own, off = {"A": (0.3, -0.1), "B": (0.0, 0.2)}, 0.03, []
    for make in np.tile(MAKES, 100):
        turn = rng.normal(0, 1)
        true = {"A": (1.5, 1.5 + turn), "B": (0.0, turn * rng.normal(1, 0.05))}
        tables, together = {}, {}
        for name, spins in true.items():
            size = np.array(sizes[name])
            sd = np.where(size == 0, 0.001, np.hypot(own, size))
            error = make * rng.normal() * size + rng.normal(0, np.where(size == 0, 0.001, own))
            told = np.array(spins) + error
            tables[name] = rows((0.0, told[0], sd[0]), (1.0, told[1], sd[1]))
            each = np.where(tables[name]["t"] > 1.0, size[1], size[0])
            together[name] = np.column_stack([each, 0 * each])
        share_spins(tables, [FIRST], STONE.radius, together=together)
        for name, k, side in (("A", 10, 0), ("A", 40, 1), ("B", 40, 1)):
            error = tables[name]["omega"][k] - true[name][side]
            off.append(error / tables[name]["sd_omega"][k])
    pulls = np.reshape(off, (-1, 3))
    assert np.sqrt(np.mean(pulls**2, axis=0)) == pytest.approx(np.ones(3), abs=0.15)
    assert np.mean(np.abs(pulls) < 2) == pytest.approx(0.95, abs=0.025)
