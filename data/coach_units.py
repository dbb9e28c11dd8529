"""Units of length that people on the ice use; everything else of a report is SI."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Unit:
    """A unit of length with a small one beside it, and one for what is less than one of these.

    Attributes
    ----------
    symbol, small, fine : str
        What is written after a number.
    per_metre, small_per_metre, fine_per_metre : float
        How many make a metre.
    decimals, fine_decimals : int
        Of a place on the ice, and of what is little.
    """

    symbol: str
    per_metre: float
    decimals: int
    small: str
    small_per_metre: float
    fine: str
    fine_per_metre: float
    fine_decimals: int

    def length(self, metres: float) -> str:
        """Write a length."""
        return f"{metres * self.per_metre:.{self.decimals}f} {self.symbol}"

    def little(self, metres: float, beside: float = 0.0) -> str:
        """Write a length of which the small unit has a few, or the fine one; as one beside it."""
        if (
            round(max(metres, beside) * self.fine_per_metre, 1)
            < self.fine_per_metre / self.small_per_metre
        ):
            return f"{metres * self.fine_per_metre:.{self.fine_decimals}f} {self.fine}"
        return f"{metres * self.small_per_metre:.1f} {self.small}"

    def converted(self, text: str) -> str:
        """Write a text's lengths in m and speeds in m/s in this unit, to as many decimals."""

        def other(found: re.Match[str]) -> str:
            decimals = len(found[1].partition(".")[2])
            return f"{float(found[1]) * self.per_metre:.{decimals}f} {self.symbol}"

        return re.sub(r"(\d+(?:\.\d+)?) m\b", other, text)


METRES = Unit("m", 1.0, 2, "cm", 100.0, "mm", 1000.0, 1)
FEET = Unit("ft", 1 / 0.3048, 1, "in", 1 / 0.0254, "in", 1 / 0.0254, 2)
UNITS = {unit.symbol: unit for unit in (METRES, FEET)}
"""By what a person writes."""
