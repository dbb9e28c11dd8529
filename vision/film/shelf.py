"""Things put aside till the end of a clip: in a file without a name, but for the first of them."""

from __future__ import annotations

import pickle
import tempfile
import weakref
from collections.abc import Callable
from contextlib import suppress
from errno import ENOSPC
from functools import partial
from os import SEEK_END
from typing import IO, Any, Generic, TypeVar

T = TypeVar("T")

ROOM = 1000
"""Things of a clip that may stay in memory: of a frame some 30 kB, of a cap 7 kB, of a sighting
.2 kB, which lie there picture by picture."""


class Shelf:
    """A file without a name; it goes when nothing that lies on it is held any more.

    Parameters
    ----------
    room : int
        How many things stay in memory all the same, the first ones: short clips need no file.
    """

    def __init__(self, room: int = 0) -> None:
        self._room = room
        self._file: IO[bytes] | None = None

    def put(self, thing: T) -> Callable[[], T]:
        """Write a thing to the file; what is given back reads it.

        Raises
        ------
        OSError
            There is no room for it.
        """
        if self._room > 0:
            self._room -= 1
            return lambda: thing
        if self._file is None:
            self._file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115
            weakref.finalize(self, self._file.close)
        data = pickle.dumps(thing, pickle.HIGHEST_PROTOCOL)
        begin = self._file.seek(0, SEEK_END)
        if self._file.write(data) < len(data):
            raise OSError(ENOSPC, "no room to put something aside")
        return partial(self._read, begin, len(data))

    def _read(self, begin: int, size: int) -> Any:
        assert self._file is not None
        self._file.seek(begin)
        return pickle.loads(self._file.read(size))


class Kept(Generic[T]):
    """A thing in memory that can be put aside, and had all the same."""

    __slots__ = ("get",)

    def __init__(self, thing: T) -> None:
        self.get: Callable[[], T] = lambda: thing

    def put_aside(self, shelf: Shelf) -> None:
        """Keep it on a shelf from now on; where there is no room for it, in memory as before."""
        with suppress(OSError):
            self.get = shelf.put(self.get())
