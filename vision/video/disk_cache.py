"""A disk cache that lasts as long as a clip is read: a temporary file without a name.

A `Cached` object gives its value by `Cached.get`, wherever it is. The value is in memory at first.
`Cached.put_aside` moves it to a `DiskCache`, and each `get` reads it again. Values may hold other
cached ones, as rows of detections hold spectra of caps. The first values stay in memory.
"""

from __future__ import annotations

import pickle
import tempfile
import weakref
from contextlib import suppress
from errno import ENOSPC
from io import BytesIO
from os import SEEK_END
from typing import IO, Any, Generic, TypeVar

import numpy as np

T = TypeVar("T")

Place = tuple[int, int]
"""Where in the file a value begins and how long it is, bytes."""


class DiskCache:
    """A temporary file without a name, deleted when no value in it is referenced any more.

    Parameters
    ----------
    room : int
        How many of the first values stay in memory: short clips need no file.
    """

    def __init__(self, room: int = 0) -> None:
        self._room = room
        self._file: IO[bytes] | None = None

    def put(self, thing: Any) -> Place | None:
        """Write a value to the file and return its place; None for the first, which stay in memory.

        Of values in it that lie in this cache themselves, only their place is written.

        Raises
        ------
        OSError
            There is no room for it.
        """
        if self._room > 0:
            self._room -= 1
            return None
        if self._file is None:
            self._file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115
            weakref.finalize(self, self._file.close)
        data = BytesIO()
        if isinstance(thing, np.ndarray):  # holds nothing that is kept; to ask takes as long again
            pickle.dump(thing, data, pickle.HIGHEST_PROTOCOL)
        else:
            _Packer(data, self).dump(thing)
        begin, size = self._file.seek(0, SEEK_END), data.tell()
        if self._file.write(data.getbuffer()) < size:
            raise OSError(ENOSPC, "no disk space for the cache")
        return begin, size

    def read(self, place: Place) -> Any:
        """Return the value that lies at a place."""
        assert self._file is not None
        begin, size = place
        self._file.seek(begin)
        return _Unpacker(BytesIO(self._file.read(size)), self).load()


class Cached(Generic[T]):
    """A value in memory that can be moved to a disk cache and read back.

    Parameters
    ----------
    thing : object or DiskCache
        The value or, if a place is given, the cache that holds it there.
    place : (int, int), optional
    """

    __slots__ = ("_place", "_thing")

    def __init__(self, thing: T | DiskCache, place: Place | None = None) -> None:
        self._thing, self._place = thing, place

    def get(self) -> T:
        """Return the value; one on disk is read again each time."""
        if self._place is None:
            return self._thing  # type: ignore[return-value]
        return self._thing.read(self._place)  # type: ignore[union-attr, no-any-return]

    def put_aside(self, cache: DiskCache) -> None:
        """Move the value to a cache; where the disk is full it stays in memory."""
        if self._place is not None:
            return
        with suppress(OSError):
            place = cache.put(self._thing)
            if place is not None:
                self._thing, self._place = cache, place

    def place_on(self, cache: DiskCache) -> Place | None:
        """Return its place in a cache; None where it is not in it."""
        return self._place if self._thing is cache else None

    def __reduce__(self) -> tuple[type[Cached[T]], tuple[T]]:
        return Cached, (self.get(),)


class _Packer(pickle.Pickler):
    """Writes values for a cache: those in it as places, all others as they are."""

    def __init__(self, file: IO[bytes], cache: DiskCache) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self._cache = cache

    def persistent_id(self, thing: Any) -> Place | None:
        return thing.place_on(self._cache) if isinstance(thing, Cached) else None


class _Unpacker(pickle.Unpickler):
    """Reads what a `_Packer` wrote."""

    def __init__(self, file: IO[bytes], cache: DiskCache) -> None:
        super().__init__(file)
        self._cache = cache

    def persistent_load(self, place: Place) -> Cached[Any]:
        return Cached(self._cache, place)
