from __future__ import annotations

import pytest

from curlshot.data.results import Hit


@pytest.mark.parametrize(("stderr", "earliest"), [(0.01, 1.97), (None, 2.0)])
def test_stones_have_not_met_three_errors_before_they_do(
    stderr: float | None, earliest: float
) -> None:
    hit = Hit(2.0, stderr, ("A", "B"), (0.0, 1.0), None, None, {}, {})
    assert hit.earliest == pytest.approx(earliest)
