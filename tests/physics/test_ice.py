from __future__ import annotations

import pytest

from data.sheet import GRAVITY
from physics.ice import FCV1, Constant, IceLaw, Penner


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (Constant(0.0109), [0.0109, 0.0109, 0.0109, 0.0109]),
        (FCV1(), [0.01179, 0.00815, 0.00724, 0.00692]),
        (Penner(), [0.0146, 0.0080, 0.0057, 0.0046]),
    ],
)
def test_friction_as_published(law: IceLaw, expected: list[float]) -> None:
    friction = law.deceleration([0.3, 1.0, 2.0, 3.0]) / GRAVITY
    assert friction == pytest.approx(expected, abs=6e-5)
