"""Things put aside in a file without a name."""

from __future__ import annotations

import io
import tempfile
import tracemalloc
from collections.abc import Callable
from typing import IO, NoReturn

import numpy as np
import pytest

from curlshot.vision.video.disk_cache import Cached, DiskCache


def test_what_was_put_aside_is_had_again_in_any_order() -> None:
    cache, rng = DiskCache(), np.random.default_rng(1)
    arrays = [rng.normal(size=size) for size in (3, 50_000, 1, 700)]
    kept = [Cached(array) for array in arrays]
    for each in kept[:3]:
        each.put_aside(cache)
    np.testing.assert_array_equal(kept[1].get(), arrays[1])
    kept[3].put_aside(cache)  # written behind all, though another was read last
    for each, array in [*zip(kept, arrays, strict=True)][::-1]:
        np.testing.assert_array_equal(each.get(), array)


def test_memory_holds_no_more_than_where_things_lie() -> None:
    cache = DiskCache()
    tracemalloc.start()
    begin = tracemalloc.get_traced_memory()[0]
    kept = []
    for number in range(200):
        kept.append(Cached(np.full(10_000, float(number))))
        kept[-1].put_aside(cache)
    held = tracemalloc.get_traced_memory()[0] - begin
    tracemalloc.stop()
    assert held < 200 * 1_000
    assert all(each.get()[0] == number for number, each in enumerate(kept))


def test_the_first_things_stay_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "TemporaryFile", no_file)
    cache, things = DiskCache(room=2), [np.full(3, float(number)) for number in range(3)]
    held = [Cached(thing) for thing in things[:2]]
    for one in held:
        one.put_aside(cache)
    assert all(one.get() is thing for one, thing in zip(held, things, strict=False))
    with pytest.raises(OSError, match="nowhere to write"):
        cache.put(things[2])


class Full(io.BytesIO):
    """A file of a few bytes."""

    def write(self, data: bytes) -> int:  # type: ignore[override]
        return super().write(data[:7])


def no_file(**_: int) -> NoReturn:
    raise OSError("nowhere to write")


@pytest.mark.parametrize("opened", [no_file, lambda **_: Full()])
def test_what_finds_no_room_stays_in_memory(
    monkeypatch: pytest.MonkeyPatch, opened: Callable[..., IO[bytes]]
) -> None:
    monkeypatch.setattr(tempfile, "TemporaryFile", opened)
    kept, cache = [Cached(np.full(3, float(number))) for number in range(3)], DiskCache()
    for each in kept:
        each.put_aside(cache)
    assert [each.get()[0] for each in kept] == [0, 1, 2]


def test_of_things_on_a_shelf_what_lies_there_too_is_not_written_again() -> None:
    cache, other, large = DiskCache(), DiskCache(), np.arange(10_000.0)
    kept, elsewhere = Cached(large), Cached(np.ones(2))
    kept.put_aside(cache)
    elsewhere.put_aside(other)
    place = cache.put([kept, elsewhere, Cached("in memory")])
    assert place is not None and place[1] < 1_000
    again = [one.get() for one in cache.read(place)]
    np.testing.assert_array_equal(again[0], large)
    np.testing.assert_array_equal(again[1], 1.0)
    assert again[2] == "in memory"


def test_what_lies_on_a_shelf_stays_where_it_lies() -> None:
    kept, cache = Cached("as it was"), DiskCache()
    kept.put_aside(cache)
    first = kept.place_on(cache)
    kept.put_aside(DiskCache())
    assert kept.place_on(cache) == first
