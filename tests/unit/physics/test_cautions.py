from __future__ import annotations

import pytest

from curlshot.data.results import Estimate
from curlshot.physics.cautions import _pace_anywhere


@pytest.mark.parametrize(
    ("friction", "said"),
    [
        (Estimate(5e-5, 3e-6), True),
        (Estimate(1.5e-4, 1e-4), False),
        (Estimate(0.001, 1e-5), False),
        (Estimate(), False),
    ],
)
def test_a_friction_below_that_of_any_surface_is_told(friction: Estimate, said: bool) -> None:
    assert any("`fps`" in text for text in _pace_anywhere(friction)) == said
