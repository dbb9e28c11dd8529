from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.spin.align import ORDERS
from curlshot.vision.spin.cover import uncovered


def pictures(of: int = 20) -> np.ndarray:
    rng = np.random.default_rng(1)
    shape = of, len(ORDERS), 6, 3
    noise = rng.normal(0, 0.2, (*shape, 2)).view(complex)[..., 0]
    return np.asarray(np.exp(1j * rng.uniform(0, 2 * np.pi, shape)) + noise, np.complex64)


@pytest.mark.parametrize("often", [1, 10, 14])
def test_rings_that_show_far_more_than_usual_are_blanked(often: int) -> None:
    seen = pictures()
    seen[:often, :, 4:] *= 4
    told = uncovered(seen)
    assert not told[:often, :, 4:].any()
    assert np.array_equal(told[:, :, :4], seen[:, :, :4])
    assert np.array_equal(told[often:], seen[often:])


def test_rings_that_show_somewhat_more_than_usual_stay() -> None:
    seen = pictures()
    seen[:10] *= 1.7  # as where a clip becomes sharper
    assert np.array_equal(uncovered(seen), seen)


def test_what_is_usual_is_told_where_a_ring_is_seen() -> None:
    seen = pictures()
    seen[:12, :, 3] = 0  # out of the picture at first
    seen[:, :, 5] = 0
    seen[15, :, 3] *= 4
    told = uncovered(seen)
    assert not told[15, :, 3].any()
    told[15, :, 3] = seen[15, :, 3]
    assert np.array_equal(told, seen)
