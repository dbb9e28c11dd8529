"""Detections kept for as long as a clip lasts: rows of numbers, which take a seventh of the memory.

What only learning needs (samples, outline and wall) is left out.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Sequence
from math import nan
from typing import overload

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.detection.detection import Detection
from curlshot.vision.video.disk_cache import Cached

Array = NDArray[np.float64]

SINGLE = ("x", "y", "sd_x", "sd_y", "visible", "score", "pixel_size", "measured", "swept")
"""Numbers of a detection that begin its row; what has several follows."""

WIDTH = len(SINGLE) + 2 + 3 + 6 + 2 + 2

AT_ONCE = 256
"""Rows that are unpacked at once: as objects, their numbers take four times as much."""


class Rows(Sequence[Detection]):
    """Detections that were packed; they are made anew when they are asked for.

    Parameters
    ----------
    detections : iterable of Detection
        To begin with.
    """

    __slots__ = ("_numbers", "_spectra")

    def __init__(self, detections: Iterable[Detection] = ()) -> None:
        self._numbers = array("d")
        self._spectra: list[Cached[NDArray[np.complex64]] | None] = []
        for detection in detections:
            self.append(detection)

    def append(self, seen: Detection) -> None:
        """Add a detection."""
        self._numbers.extend(
            (
                seen.x, seen.y, seen.sd_x, seen.sd_y, seen.visible, seen.score, seen.pixel_size,
                seen.measured, seen.swept, *seen.sd_place, *seen.colour.tolist(), *seen.bends,
                *seen.pixel, *seen.light,
            )
        )  # fmt: skip
        self._spectra.append(seen.spectrum)

    def extend(self, other: Rows) -> None:
        """Add all of others."""
        self._numbers.extend(other._numbers)
        self._spectra.extend(other._spectra)

    @property
    def spectra(self) -> Sequence[Cached[NDArray[np.complex64]] | None]:
        """Of the detections, without making these anew."""
        return self._spectra

    def __len__(self) -> int:
        return len(self._spectra)

    @overload
    def __getitem__(self, index: int) -> Detection: ...

    @overload
    def __getitem__(self, index: slice) -> Rows: ...

    def __getitem__(self, index: int | slice) -> Detection | Rows:
        if isinstance(index, slice):
            return Rows(self[k] for k in range(*index.indices(len(self))))
        spectrum = self._spectra[index]
        begin = range(len(self))[index] * WIDTH
        return _unpacked(self._numbers[begin : begin + WIDTH].tolist(), spectrum)

    def __iter__(self) -> Iterator[Detection]:
        for begin in range(0, len(self), AT_ONCE):
            some = self._numbers[begin * WIDTH : (begin + AT_ONCE) * WIDTH]
            rows = np.array(some).reshape(-1, WIDTH).tolist()
            yield from map(_unpacked, rows, self._spectra[begin : begin + AT_ONCE])

    def columns(self, *names: str) -> Array:
        """Numbers of all of them by some of the names in `SINGLE`, shape (names, n)."""
        rows = np.array(self._numbers).reshape(-1, WIDTH)
        return rows[:, [SINGLE.index(name) for name in names]].T


def _unpacked(row: list[float], spectrum: Cached[NDArray[np.complex64]] | None) -> Detection:
    (
        x, y, sd_x, sd_y, visible, score, pixel_size, measured, swept, shared_x, shared_y,
        lightness, a, b, *bends, u, v, light_x, light_y,
    ) = row  # fmt: skip
    return Detection(
        x, y, sd_x, sd_y, (shared_x, shared_y), np.array((lightness, a, b)), visible, score, (),
        nan, tuple(bends), (u, v), pixel_size, (light_x, light_y), spectrum,
        measured=bool(measured), swept=bool(swept),
    )  # fmt: skip
