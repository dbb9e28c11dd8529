"""Storage on disk till the end of a clip: a temporary file without a name, the first things apart.

Whoever has a `Kept` has the thing by `Kept.get`, wherever it is. In memory at first, it goes to a
`Shelf` by `Kept.put_aside` and is read from there anew each time; what is left of it in memory is
where it lies. Things may hold others that are kept, as rows of detections hold pictures of caps.
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
        if isinstance(thing, np.ndarray):  # holds nothing that is kept; to ask takes as long again
            pickle.dump(thing, data, pickle.HIGHEST_PROTOCOL)
        else:
            _Packer(data, self).dump(thing)
        begin, size = self._file.seek(0, SEEK_END), data.tell()
        if self._file.write(data.getbuffer()) < size:
            raise OSError(ENOSPC, "no room to put something aside")
        return begin, size

    def read(self, place: Place) -> Any:
        """Read the thing that lies at a place."""
        assert self._file is not None
        begin, size = place
        self._file.seek(begin)
        return _Unpacker(BytesIO(self._file.read(size)), self).load()


class Kept(Generic[T]):
    """A thing in memory that can be put aside, and had all the same.

    Parameters
    ----------
    thing : object or Shelf
        Itself or, if a place is given, the shelf on which it lies there.
    place : (int, int), optional
    """

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


class _Packer(pickle.Pickler):
    """Writes things for a shelf: where those lie that are on it, all others as they are."""

    def __init__(self, file: IO[bytes], shelf: Shelf) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self._shelf = shelf

    def persistent_id(self, thing: Any) -> Place | None:
        return thing.place_on(self._shelf) if isinstance(thing, Kept) else None


class _Unpacker(pickle.Unpickler):
    """Reads what a `_Packer` wrote."""

    def __init__(self, file: IO[bytes], shelf: Shelf) -> None:
        super().__init__(file)
        self._shelf = shelf

    def persistent_load(self, place: Place) -> Kept[Any]:
        return Kept(self._shelf, place)
