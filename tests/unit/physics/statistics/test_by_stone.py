from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.results import Glide, Hit, MeasuredState
from curlshot.physics.statistics.by_stone import results_by_stone


def hit(first: str, second: str, spins: tuple[float | None, ...]) -> Hit:
    a, b = (MeasuredState(0, 0, 1.0, 0, spin, sd_omega=0.1) for spin in spins)
    still = MeasuredState(0, 0, 0, 0, 0.0)
    return Hit(
        1.0, 0.01, (first, second), (1.0, 0.0), 0.8, 0.1,
        {first: a, second: still}, {first: a, second: b},
    )  # fmt: skip


def test_each_stone_by_itself() -> None:
    glides = [
        Glide("A", 0, 1, 0.010, 0.001, 0.02, 0.01, 1.5),
        Glide("A", 2, 3, 0.014, 0.002, None, None, 0.5),
        Glide("C", 0, 1, None, None),
    ]
    found = results_by_stone(glides, [hit("A", "B", (0.6, None))])
    assert list(found) == ["A", "B", "C"]
    # They differ by more than their errors, by as much as makes one of (0.004)² / variance.
    between = (0.004**2 - 0.001**2 - 0.002**2) / 2
    weights = 1 / (np.array([0.001**2, 0.002**2]) + between)
    a = found["A"]
    assert a.friction.value == pytest.approx(weights @ [0.010, 0.014] / weights.sum())
    assert a.friction.stderr == pytest.approx(weights.sum() ** -0.5)
    assert (a.turn_rate.value, a.speed) == (0.02, 1.0)
    assert (a.spin.value, a.spin.stderr) == (0.6, 0.1)
    assert found["B"].friction.value is None
    assert found["B"].spin.value is None
    assert found["C"].friction.value is None
