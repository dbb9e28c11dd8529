from __future__ import annotations

import pytest

from curlshot.data.estimates import Estimate, NotedEstimate


@pytest.mark.parametrize(
    ("estimate", "spec", "text"),
    [
        (Estimate(0.83373, 0.00098), "", "0.83373 ± 0.00098"),
        (Estimate(0.83373, 0.00098), ".3f", "0.834 ± 0.001"),
        (Estimate(-0.5, 0.25), ".1f", "−0.5 ± 0.2"),
        (Estimate(0.83), ".1f", "0.8"),
        (Estimate(0.83), "", "0.830"),
        (Estimate(0.5, 0.1), ">14", "   0.50 ± 0.10"),
        (Estimate(), ".3f", "—"),
        (Estimate(), ">3", "  —"),
        (NotedEstimate(None, None, "no hit"), "", "— (no hit)"),
        (NotedEstimate(0.5, 0.1, "weak"), "", "0.50 ± 0.10"),
    ],
)
def test_an_estimate_prints_as_its_error_allows(estimate: Estimate, spec: str, text: str) -> None:
    assert format(estimate, spec) == text
    if not spec:
        assert str(estimate) == text
