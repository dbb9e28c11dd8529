"""Units of length that people on the ice use; everything else of a report is SI."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Unit:
    """A unit of length: its symbol, how many make a metre, and decimals of a place on the ice."""

    symbol: str
    per_metre: float
    decimals: int

    def length(self, metres: float) -> str:
        """Write a length."""
        return f"{metres * self.per_metre:.{self.decimals}f} {self.symbol}"


METRES = Unit("m", 1.0, 2)
FEET = Unit("ft", 1 / 0.3048, 1)
UNITS = {unit.symbol: unit for unit in (METRES, FEET)}
"""By what a person writes."""
