from __future__ import annotations

import weakref

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.tests.helpers.vision.handles import RADII, SURE, spectrum
from curlshot.vision.spin.angles import angles_in_parts
from curlshot.vision.video.disk_cache import Cached

TIMES = np.arange(300) / 25
SPIN = 2.2


def told(
    pictures: list[NDArray[np.complex64] | None], most: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    kept = [None if picture is None else Cached(picture) for picture in pictures]
    angles = angles_in_parts(TIMES, kept, RADII, np.full(len(TIMES), SURE), most)
    return angles.theta, angles.sd


def test_parts_of_a_long_track_are_one() -> None:
    rng = np.random.default_rng(3)
    pictures = [spectrum(0.4 + SPIN * t, rng) for t in TIMES]
    whole, sd = told([*pictures], len(TIMES))
    parts, sd_of_parts = told([*pictures], 70)
    assert np.abs(parts - 0.4 - SPIN * TIMES).max() < 0.03
    assert np.abs(parts - whole).max() < 0.015
    assert np.median(sd_of_parts) == pytest.approx(np.median(sd), rel=0.2)


def test_a_part_in_which_nothing_is_seen_is_passed_over() -> None:
    rng = np.random.default_rng(4)
    alike = spectrum(0.0) * 0
    pictures = [alike if 100 <= k < 200 else spectrum(SPIN * t, rng) for k, t in enumerate(TIMES)]
    theta, sd = told([*pictures], 100)
    assert np.isnan(theta[100:200]).all() and np.isnan(sd[100:200]).all()
    aside = (theta[200:] - SPIN * TIMES[200:]) / (2 * np.pi)
    # How often it turned meanwhile cannot be told; how it faces can.
    assert np.abs(aside - np.round(aside)).max() < 0.01


def test_nothing_seen_tells_nothing() -> None:
    theta, sd = told([None] * len(TIMES), 70)
    assert np.isnan(theta).all() and np.isnan(sd).all()


class Counted(Cached[NDArray[np.complex64]]):
    """A picture of which copies are read, and how many copies are held."""

    held = most = 0

    def __init__(self, picture: NDArray[np.complex64]) -> None:
        self.get = lambda: self._read(picture)

    @classmethod
    def _read(cls, picture: NDArray[np.complex64]) -> NDArray[np.complex64]:
        copy = picture.copy()
        weakref.finalize(copy, cls._let_go)
        cls.held += 1
        cls.most = max(cls.most, cls.held)
        return copy

    @classmethod
    def _let_go(cls) -> None:
        cls.held -= 1


def test_no_more_pictures_are_held_than_a_part_has() -> None:
    rng = np.random.default_rng(5)
    kept = [Counted(spectrum(SPIN * t, rng)) for t in TIMES]
    angles_in_parts(TIMES, kept, RADII, np.full(len(TIMES), SURE), 75)
    assert Counted.most == 75
