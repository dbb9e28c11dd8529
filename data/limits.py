"""What numbers that a person gives may be, on the command line and from Python."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from numbers import Integral, Real

from curlshot.data.errors import InputError

MOST_THROWS = 100_000
"""Samples of a shot at most."""


@dataclass(frozen=True)
class Limits:
    """From `low` to `high`; `what` says in words what is expected, `kind` of numbers is it."""

    low: float
    high: float
    what: str
    kind: type[Real] | type[Integral] = Real

    def allow(self, value: float) -> bool:
        """Tell whether a number lies within; NaN does not."""
        return self.low <= value <= self.high

    def check(self, name: str, value: object) -> None:
        """Raise `InputError` where a value is no such number, or lies outside."""
        number = isinstance(value, self.kind) and not isinstance(value, bool)
        if not (number and self.allow(float(value))):  # type: ignore[arg-type]
            raise InputError(f"{name}: {value!r} is not {self.what}")


POSITIVE = Limits(math.ulp(0.0), sys.float_info.max, "a positive number")
FRACTION = Limits(0.0, 1.0, "a number from 0 to 1")
FRICTION = Limits(1e-3, 0.1, "a friction of ice, 0.001 to 0.1")
HEIGHT = Limits(1.0, 100.0, "a height in metres, 1 to 100")
RADIUS = Limits(1e-3, 1.0, "a radius in metres, 0.001 to 1")
SAMPLES = Limits(0, MOST_THROWS, f"a number of samples, 0 to {MOST_THROWS}", Integral)
THROWS = Limits(1, MOST_THROWS, f"a number of throws, 1 to {MOST_THROWS}", Integral)
SD_SPEED = Limits(0.0, 1.0, "a standard deviation in m/s, 0 to 1")
SD_ANGLE = Limits(0.0, 1.0, "a standard deviation in rad, 0 to 1")
JOBS = Limits(1, 1000, "a number of clips at once, 1 to 1000", Integral)
FRAME = Limits(0, sys.maxsize, "a number of a frame", Integral)
OFFSET = Limits(-5.0, 5.0, "a distance in metres, -5 to 5")
SPEED = Limits(1e-6, 10.0, "a speed above 0, at most 10 m/s")
SPIN = Limits(-20.0, 20.0, "a number, -20 to 20")
ANY = Limits(-sys.float_info.max, sys.float_info.max, "a number")


def has_length(stick: tuple[float, float, float, float, float]) -> bool:
    """Tell whether a calibration stick, x1, y1, x2, y2, metres, has two ends and a length."""
    x1, y1, x2, y2, metres = stick
    return (x1, y1) != (x2, y2) and POSITIVE.allow(metres)
