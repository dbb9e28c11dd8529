"""Units of length that people on the ice use; everything else of a report is SI."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Unit:
    """A unit of length with a small one beside it.

    Attributes
    ----------
    symbol, small : str
        What is written after a number.
    per_metre, small_per_metre : float
        How many make a metre.
    decimals : int
        Of a place on the ice.
    """

    symbol: str
    per_metre: float
    decimals: int
    small: str
    small_per_metre: float

    def length(self, metres: float) -> str:
        """Write a length."""
        return f"{metres * self.per_metre:.{self.decimals}f} {self.symbol}"

    def little(self, metres: float) -> str:
        """Write a length of which the small unit has a few."""
        return f"{metres * self.small_per_metre:.1f} {self.small}"


METRES = Unit("m", 1.0, 2, "cm", 100.0)
FEET = Unit("ft", 1 / 0.3048, 1, "in", 1 / 0.0254)
UNITS = {unit.symbol: unit for unit in (METRES, FEET)}
"""By what a person writes."""
