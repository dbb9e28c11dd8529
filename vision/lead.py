"""What leads on to a stone in the next picture: where it was, how it moved, how it looked."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vision.align import Complex
from vision.handle import TURNING, angle_between
from vision.sighting import Sighting
from vision.still import Portrait

Array = NDArray[np.float64]

STEADY = 5
"""Sightings at one place that make a stone one at rest."""

TURNED = 0.06
"""A cap that has turned by more spins on the spot, rad."""


@dataclass(frozen=True)
class Lead:
    """Where a stone was at the time t, and how it moved.

    Attributes
    ----------
    place, velocity : ndarray, shape (2,)
        m and m/s.
    t : float
        s.
    missed : bool
        Whether it was missed since.
    anchor : ndarray, shape (2,)
        The place that it has not left lately, m.
    facing : ndarray, optional
        How its cap looked when it came there (`vision.handle.cap_spectrum`).
    steady : int
        For how many sightings it has neither left nor turned.
    portrait : Portrait, optional
        Its picture when it was last measured, if it rests.
    """

    place: Array
    velocity: Array
    t: float
    anchor: Array
    missed: bool = False
    facing: Complex | None = None
    steady: int = 0
    portrait: Portrait | None = None

    @classmethod
    def to(cls, sighting: Sighting, t: float) -> Lead:
        """Lead to a stone of which nothing is known but one sighting."""
        place = np.array([sighting.x, sighting.y])
        return cls(place, np.zeros(2), t, place, facing=sighting.spectrum)

    @property
    def rests(self) -> bool:
        """Whether the stone has been at one place for a while."""
        return self.steady >= STEADY

    def at(self, t: float) -> Array:
        """Where the stone is expected, m."""
        return np.asarray(self.place + self.velocity * (t - self.t))

    def on(self, sighting: Sighting, t: float, near: float, still: float) -> Lead:
        """Go on from a sighting; it corrects what was expected, unless the course has changed.

        Parameters
        ----------
        near : float
            How far from where it was expected a stone may be on the same course, m.
        still : float
            How far from its anchor it may be and rest, m.
        """
        seen, expected, step = np.array([sighting.x, sighting.y]), self.at(t), t - self.t
        stays = float(np.hypot(*(seen - self.anchor))) < still and not self._turned(sighting)
        after = replace(
            self,
            t=t,
            missed=False,
            anchor=self.anchor if stays else seen,
            facing=sighting.spectrum if not stays or self.facing is None else self.facing,
            steady=self.steady + 1 if stays else 0,
            portrait=None if sighting.measured or not stays else self.portrait,
        )
        away = seen - expected
        if float(np.hypot(*away)) > near:
            return replace(after, place=seen, velocity=(seen - self.place) / step)
        velocity = self.velocity + 0.3 * away / step
        return replace(after, place=expected + 0.6 * away, velocity=velocity)

    def _turned(self, sighting: Sighting) -> bool:
        """Whether the cap faces elsewhere than when it came to its place, as far as is seen."""
        if self.facing is None or sighting.spectrum is None:
            return False
        angle, likeness = angle_between(self.facing, sighting.spectrum, 0.0, TURNING.reach)
        return likeness > TURNING.least_likeness and abs(angle) > TURNED
