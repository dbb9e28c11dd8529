"""Things put aside till the end of a clip: in a file without a name, but for the first of them."""

from __future__ import annotations

import pickle
import tempfile
import weakref
from contextlib import suppress
from errno import ENOSPC
from functools import partial
from io import BytesIO
from os import SEEK_END
from typing import IO, Any, Generic, TypeVar

import numpy as np

T = TypeVar("T")

Place = tuple[int, int]
"""Where on a shelf a thing begins and how long it is, bytes."""


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

    def put(self, thing: Any) -> Place | None:
        """Write a thing to the file and say where it lies; None for the first, which stay.

        Of things in it that lie on this shelf themselves, only where they lie is written.

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
        packer = pickle.Pickler(data, pickle.HIGHEST_PROTOCOL)
        if not isinstance(thing, np.ndarray):  # in arrays nothing lies; to ask takes as long again
            packer.persistent_id = self._place_of  # type: ignore[method-assign]
        packer.dump(thing)
        begin, size = self._file.seek(0, SEEK_END), data.tell()
        if self._file.write(data.getbuffer()) < size:
            raise OSError(ENOSPC, "no room to put something aside")
        return begin, size

    def read(self, place: Place) -> Any:
        """Read the thing that lies at a place."""
        assert self._file is not None
        begin, size = place
        self._file.seek(begin)
        unpacker = pickle.Unpickler(BytesIO(self._file.read(size)))
        unpacker.persistent_load = partial(Kept, self)  # type: ignore[method-assign]
        return unpacker.load()

    def _place_of(self, thing: Any) -> Place | None:
        return thing.place_on(self) if isinstance(thing, Kept) else None


class Kept(Generic[T]):
    """A thing in memory that can be put aside, and had all the same."""

    __slots__ = ("_place", "_thing")

    def __init__(self, thing: T | Shelf, place: Place | None = None) -> None:
        self._thing, self._place = thing, place

    def get(self) -> T:
        """Give the thing; one that was put aside is read anew each time."""
        if self._place is None:
            return self._thing  # type: ignore[return-value]
        return self._thing.read(self._place)  # type: ignore[union-attr, no-any-return]

    def put_aside(self, shelf: Shelf) -> None:
        """Keep it on a shelf from now on; where there is no room for it, in memory as before."""
        if self._place is not None:
            return
        with suppress(OSError):
            place = shelf.put(self._thing)
            if place is not None:
                self._thing, self._place = shelf, place

    def place_on(self, shelf: Shelf) -> Place | None:
        """Where it lies on a shelf; None where it does not."""
        return self._place if self._thing is shelf else None

    def __reduce__(self) -> tuple[type[Kept[T]], tuple[T]]:
        return Kept, (self.get(),)
