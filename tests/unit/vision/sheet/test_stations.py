from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import HOUSE
from curlshot.vision.optics.paint import CIRCLES, TEE_LINE
from curlshot.vision.sheet.stations import BLOCK, CLOSER, ON_ALL, ON_CIRCLES, THIN, Stations

EVERY = pytest.mark.parametrize("on", [ON_ALL, ON_CIRCLES], ids=["all", "circles"])


@EVERY
def test_neighbours_are_one_spacing_apart_and_circles_close(on: Stations) -> None:
    for kind, start, count, spacing in zip(on.kind, on.start, on.count, on.spacing, strict=True):
        here = np.arange(start, start + count)
        assert (on.line[here] == kind).all()
        if kind < CIRCLES:
            np.testing.assert_array_equal(on.behind[on.ahead[here]], here)
            apart = np.angle(np.exp(1j * (on.along[on.ahead[here]] - on.along[here])))
            np.testing.assert_allclose(apart, spacing)
        else:
            np.testing.assert_array_equal(on.ahead[here], np.minimum(here + 1, here[-1]))
            np.testing.assert_array_equal(on.behind[here], np.maximum(here - 1, here[0]))


@EVERY
def test_groups_are_whole_blocks_of_thin_lines_and_single_stations_of_others(on: Stations) -> None:
    np.testing.assert_array_equal(
        np.repeat(np.arange(len(on.group_size)), on.group_size),
        np.searchsorted(on.group_start, np.arange(len(on.line)), side="right") - 1,
    )
    for kind, group, first, groups in zip(
        on.kind, on.group, on.first_group, on.groups, strict=True
    ):
        assert group == (BLOCK if kind in THIN else 1)
        its = slice(first, first + groups)
        assert (on.group_size[its] == group).all()
        assert (on.line[on.group_start[its]] == kind).all()
    assert on.group_size.sum() == len(on.line)


def test_blocks_count_as_more_beyond_the_house_alone() -> None:
    middle = np.abs(ON_ALL.along[ON_ALL.group_start + ON_ALL.group_size // 2])
    thin = ON_ALL.group_size == BLOCK
    np.testing.assert_array_equal(ON_ALL.share == CLOSER, thin & (middle > HOUSE.twelve_foot))


def test_stations_lie_where_they_are_asked_for() -> None:
    along = np.linspace(-1.0, 1.0, 2 * BLOCK)
    on = Stations.on([(0, np.linspace(-np.pi, np.pi, 8, endpoint=False)), (TEE_LINE, along)])
    np.testing.assert_allclose(np.hypot(*on.way[:, :8]), 1.0)
    np.testing.assert_allclose(on.foot[0, 8:], along)
    np.testing.assert_allclose(on.foot[1, 8:], 0.0)
