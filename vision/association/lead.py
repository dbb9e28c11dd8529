"""What leads on to a stone in the next picture: where it was, how it moved, how it looked."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from math import hypot

import numpy as np
from numpy.typing import NDArray

from curlshot.data.geometry import origin_to_segment
from curlshot.vision.association.still import Portrait
from curlshot.vision.detection.detection import Detection
from curlshot.vision.spin.align import Complex
from curlshot.vision.spin.facing import angle_between
from curlshot.vision.spin.handle import TURNING
from curlshot.vision.video.disk_cache import Cached

Array = NDArray[np.float64]

STEADY = 5
"""Detections at one place that make a stone one at rest."""

DECELERATION = 0.1
"""Of a stone on ice, about, m/s²."""

MEMORY = 8
"""Detections on one course that say together where a stone is and how fast: a course is not quite
straight, and a touch may change it by little."""

SCORE_GAIN = 0.2
"""Share of the last detection in the evidence that is usual for a stone: one that drifts off bit by
bit, along the edge of paint as light as its granite, still falls below that."""

DOUBTFUL = 0.85
"""A stone that shows less than this share of its usual evidence is looked for beside where it is
expected, and is there if it shows less than this share of what is found there. Pushed 25 mm aside
on paint of its cap's colour, one still shows 0.6 to 0.75 of its evidence where it was; drawn aside
by as much along paint as light as granite, 0.6 to 0.8."""

COLOUR_GAIN = 0.1
"""Weight of the last detection, seen in whole, in the colour of a cap."""

AHEAD = 1.5
"""How far ahead it is looked whether a stone comes near a place, s: for a handful of blocks."""

TURNED = 0.06
"""A cap that has turned by more spins on the spot, rad."""


def coloured(known: Array | None, detection: Detection) -> Array:
    """Return the colour of a cap, L*a*b*, shape (3,), after a detection."""
    if known is None:
        return detection.colour
    return np.asarray(known + COLOUR_GAIN * detection.visible * (detection.colour - known))


@dataclass(frozen=True)
class Lead:
    """Where a stone was at the time t, and how it moved: the state of an alpha-beta filter.

    Attributes
    ----------
    place, velocity : tuple of float
        m and m/s.
    t : float
        s.
    score : float
        Evidence that it is a stone, as was usual for it of late.
    missed : bool
        Whether it was missed since.
    anchor : tuple of float
        The place that it has not left lately, m.
    facing : Cached of ndarray, optional
        How its cap looked when it came there (`curlshot.vision.spin.handle.cap_spectrum`).
    steady : int
        For how many clear detections it has neither left nor turned.
    portrait : Portrait, optional
        Its picture when it was last measured, if it rests.
    along : int
        How many detections on its course it is known by, up to `MEMORY`.
    colour : ndarray, shape (3,), optional
        Running mean of its cap's colour, L*a*b*.
    """

    place: tuple[float, float]
    velocity: tuple[float, float]
    t: float
    anchor: tuple[float, float]
    score: float
    missed: bool = False
    facing: Cached[Complex] | None = None
    steady: int = 0
    portrait: Portrait | None = None
    along: int = 1
    colour: Array | None = field(default=None, compare=False)

    @classmethod
    def to(cls, detection: Detection, t: float) -> Lead:
        """Lead to a stone of which nothing is known but one detection."""
        place = detection.x, detection.y
        return cls(
            place, (0.0, 0.0), t, place, detection.score,
            facing=detection.spectrum, colour=detection.colour,
        )  # fmt: skip

    def if_rested(self, others: Iterable[Lead]) -> Lead:
        """Lead to a stone at rest if one of others, which began at its place, says that it is."""
        rested = any(lead.rests and lead.anchor == self.anchor for lead in others)
        return replace(self, steady=STEADY) if rested else self

    @property
    def rests(self) -> bool:
        """Whether the stone has been at one place for a while."""
        return self.steady >= STEADY

    def at(self, t: float) -> tuple[float, float]:
        """Where the stone is expected, m: the prediction."""
        slower, step = self._slowed(t)
        (x, y), (vx, vy), mean = self.place, self.velocity, 0.5 * (1 + slower)
        return x + mean * vx * step, y + mean * vy * step

    def drift(self, step: float) -> tuple[float, float]:
        """How far the stone moves in so long, s, m."""
        return self.velocity[0] * step, self.velocity[1] * step

    def nears(self, place: tuple[float, float], t: float, within: float) -> bool:
        """Whether the stone is expected to come so near to a place, m, `AHEAD` from then, s."""
        (x, y), (end_x, end_y) = self.at(t), self.at(t + AHEAD)
        start, end = (x - place[0], y - place[1]), (end_x - place[0], end_y - place[1])
        return origin_to_segment(*start, *end) < within

    def _slowed(self, t: float) -> tuple[float, float]:
        """Tell what share of its velocity is left by then, and how long it moves till then, s."""
        lasts = hypot(*self.velocity) / DECELERATION
        if not lasts:
            return 1.0, 0.0
        step = min(max(t - self.t, -lasts), lasts)
        return 1 - step / lasts, step

    def on(self, detection: Detection, t: float, near: float, still: float) -> Lead:
        """Go on from a detection: it updates the state.

        Parameters
        ----------
        near : float
            How far from where it was expected a stone may be on the same course, m.
        still : float
            How far from its anchor it may be and rest, m.
        """
        x, y = detection.x, detection.y
        place, velocity, along = self._updated(x, y, t, near)
        left = hypot(x - self.anchor[0], y - self.anchor[1])
        score = self.score + SCORE_GAIN * (detection.score - self.score)
        # What covers a stone by half draws it aside, or shows it turned.
        clear = detection.score >= DOUBTFUL * self.score
        if clear and (left >= still or self._turned(detection)):
            return Lead(
                place, velocity, t, (x, y), score,
                facing=detection.spectrum, along=along, colour=coloured(self.colour, detection),
            )  # fmt: skip
        return Lead(
            place,
            velocity,
            t,
            self.anchor,
            score,
            facing=detection.spectrum if self.facing is None else self.facing,
            steady=self.steady + clear,
            portrait=None if detection.measured else self.portrait,
            along=along,
            colour=coloured(self.colour, detection),
        )

    def _updated(
        self, x: float, y: float, t: float, near: float
    ) -> tuple[tuple[float, float], tuple[float, float], int]:
        """Place, velocity and `along` after a detection at x, y, m.

        As a straight line fitted to so many detections would have them: the expanding-memory
        alpha-beta (g-h) filter (Brookner, 1998, Tracking and Kalman filtering made easy). On
        another course, `near` or farther from the prediction, it begins anew.
        """
        (predicted_x, predicted_y), step, (slower, _) = self.at(t), t - self.t, self._slowed(t)
        innovation_x, innovation_y = x - predicted_x, y - predicted_y
        if hypot(innovation_x, innovation_y) > near:
            return (x, y), ((x - self.place[0]) / step, (y - self.place[1]) / step), 2
        along = min(self.along + 1, MEMORY)
        beta = 6 / (along * (along + 1))
        alpha = (2 * along - 1) * beta / 3
        place = predicted_x + alpha * innovation_x, predicted_y + alpha * innovation_y
        vx, vy = slower * self.velocity[0], slower * self.velocity[1]
        return place, (vx + beta * innovation_x / step, vy + beta * innovation_y / step), along

    def pushed(self, place: Array, velocity: Array, t: float) -> Lead:
        """Lead to where a hit that nobody saw would have the stone at a time, and how it moves."""
        (x, y), (vx, vy) = place.tolist(), velocity.tolist()
        return Lead((x, y), (vx, vy), t, (x, y), self.score, colour=self.colour)

    def _turned(self, detection: Detection) -> bool:
        """Whether the cap faces elsewhere than when it came to its place, as far as is seen."""
        if self.facing is None or detection.spectrum is None:
            return False
        angle, likeness = angle_between(
            self.facing.get(), detection.spectrum.get(), 0.0, TURNING.reach
        )
        return likeness > TURNING.least_likeness and abs(angle) > TURNED
