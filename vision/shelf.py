"""Things put aside till the end of a clip: in a file without a name, not in memory."""

from __future__ import annotations

import pickle
import tempfile
import weakref
from collections.abc import Callable
from functools import partial
from os import SEEK_END
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class Shelf:
    """A file without a name; it goes when nothing that lies on it is held any more."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile()  # noqa: SIM115
        weakref.finalize(self, self._file.close)

    def put(self, thing: T) -> Callable[[], T]:
        """Write a thing to the file; what is given back reads it."""
        data = pickle.dumps(thing, pickle.HIGHEST_PROTOCOL)
        begin = self._file.seek(0, SEEK_END)
        self._file.write(data)
        return partial(self._read, begin, len(data))

    def _read(self, begin: int, size: int) -> Any:
        self._file.seek(begin)
        return pickle.loads(self._file.read(size))


class Kept(Generic[T]):
    """A thing in memory that can be put aside, and had all the same."""

    __slots__ = ("get",)

    def __init__(self, thing: T) -> None:
        self.get: Callable[[], T] = lambda: thing

    def put_aside(self, shelf: Shelf) -> None:
        """Keep it on a shelf from now on."""
        self.get = shelf.put(self.get())
