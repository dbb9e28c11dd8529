from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.curl import FCV1Curl


def test_turning_and_loss_of_spin_as_published() -> None:
    curl = FCV1Curl()
    assert curl.turn_rate(1.0) == pytest.approx(0.0082)
    # Slower stones turn more: v^-0.8.
    assert curl.turn_rate(0.25) == pytest.approx(0.0082 * 4**0.8)
    assert curl.spin_loss(2.0) == pytest.approx(0.0125)


def test_the_loss_of_spin_stays_finite_at_rest() -> None:
    loss = FCV1Curl().spin_loss(np.array([0.0, 1e-4, 1e-3]))
    assert loss == pytest.approx(25.0)
