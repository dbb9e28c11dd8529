from __future__ import annotations

import gc
import tracemalloc

import numpy as np

from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.association.rows import AT_ONCE, Rows
from curlshot.vision.detection.detection import Detection
from curlshot.vision.video.disk_cache import Cached, DiskCache


def shown(rank: int) -> Detection:
    """One in which no two numbers are alike."""
    x, y, *rest = (rank + np.arange(1, 23) / 100).tolist()
    return detection((x, y), np.array(rest[:3]), rest[3])._replace(
        sd_x=rest[4], sd_y=rest[5], sd_place=(rest[6], rest[7]), visible=rest[8],
        bends=tuple(rest[9:15]), pixel=(rest[15], rest[16]), pixel_size=rest[17],
        light=(rest[18], rest[19]), measured=rank % 2 == 0, swept=rank % 3 == 0,
        spectrum=Cached(np.ones(3, np.complex64)) if rank == 1 else None,
    )  # fmt: skip


def test_what_was_packed_is_as_it_was() -> None:
    seen = [shown(rank) for rank in range(4)]
    rows, more = Rows(seen[:1]), Rows(seen[2:])
    rows.append(seen[1])
    rows.extend(more)
    assert len(rows) == 4
    left_out = {"outline", "wall", "cap_samples", "granite_samples"}
    for one, other in zip([*rows, rows[-1]], [*seen, seen[-1]], strict=True):
        for name in set(Detection._fields) - left_out:
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name), name)
    assert [s.x for s in rows[1:3]] == [seen[1].x, seen[2].x]
    np.testing.assert_array_equal(
        rows.columns("y", "measured"), [[s.y for s in seen], [s.measured for s in seen]]
    )


def test_rows_take_a_few_hundred_bytes_each() -> None:
    gc.collect()
    tracemalloc.start()
    begin = tracemalloc.get_traced_memory()[0]
    rows = Rows(shown(2) for _ in range(3000))
    gc.collect()
    held = tracemalloc.get_traced_memory()[0] - begin
    tracemalloc.stop()
    assert held < 250 * len(rows)


def test_rows_that_are_put_aside_are_as_they_were_and_take_next_to_nothing() -> None:
    seen = [shown(rank) for rank in range(3)]
    cache, held = DiskCache(), [Rows(seen * 100) for _ in range(30)]
    for each in seen:
        if each.spectrum is not None:
            each.spectrum.put_aside(cache)
    gc.collect()
    tracemalloc.start()
    begin = tracemalloc.get_traced_memory()[0]
    more = [Cached(Rows(seen * 100)) for _ in range(30)]
    for rows in more:
        rows.put_aside(cache)
    gc.collect()
    taken = tracemalloc.get_traced_memory()[0] - begin
    tracemalloc.stop()
    assert taken < 30 * 300 * 20
    for one, other in zip(held, (rows.get() for rows in more), strict=True):
        assert [s.pixel for s in one] == [s.pixel for s in other]
        np.testing.assert_array_equal(one.columns("x", "score"), other.columns("x", "score"))
        for shown_once, again in zip(one.spectra[:3], other.spectra[:3], strict=True):
            assert (shown_once is None) == (again is None)
            if shown_once is not None and again is not None:
                np.testing.assert_array_equal(shown_once.get(), again.get())


def test_many_rows_are_unpacked_in_their_order() -> None:
    rows = Rows(shown(rank % 5) for rank in range(2 * AT_ONCE + 3))
    assert [s.x for s in rows] == [shown(rank % 5).x for rank in range(2 * AT_ONCE + 3)]
    assert [s.spectrum for s in rows] == [*rows.spectra]
