from __future__ import annotations

import pytest

from curlshot.data.results import Estimate, Hit


@pytest.mark.parametrize(("stderr", "earliest"), [(0.01, 1.97), (None, 2.0)])
def test_stones_have_not_met_three_errors_before_they_do(
    stderr: float | None, earliest: float
) -> None:
    hit = Hit(2.0, stderr, ("A", "B"), (0.0, 1.0), None, None, {}, {})
    assert hit.earliest == pytest.approx(earliest)


@pytest.mark.parametrize(
    ("value", "stderr", "spec", "text"),
    [
        (0.83364, 0.00093, "", "0.83364 ± 0.00093"),
        (0.83364, 0.00093, ".3f", "0.834 ± 0.001"),
        (0.83364, 0.00093, ".2f", "0.83 ± 0.0009"),  # no false zero
        (-0.5, 0.25, ".2f", "−0.50 ± 0.25"),
        (1.0, None, ".1f", "1.0"),
        (None, None, ".1f", "—"),
    ],
)
def test_an_estimate_prints_with_its_error(
    value: float | None, stderr: float | None, spec: str, text: str
) -> None:
    assert format(Estimate(value, stderr), spec) == text
