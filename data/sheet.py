"""Dimensions of the curling sheet and of the stone (SI units).

Sources: The Rules of Curling and Rules of Competition, World Curling, 2023 (sheet, house,
stone, rule C1); Nyberg et al., 2013, Wear 299 (running band); cap radius and height
measured on broadcast stills.
"""

from __future__ import annotations

from dataclasses import dataclass

GRAVITY = 9.81
"""Acceleration of free fall, m/s²."""


@dataclass(frozen=True)
class House:
    """Painted radii of the house, m, from its centre (the tee)."""

    twelve_foot: float = 1.829
    eight_foot: float = 1.219
    four_foot: float = 0.610
    button: float = 0.152

    @property
    def painted(self) -> tuple[float, float, float]:
        """Radii of the three circles that are measured, m, the largest first."""
        return self.twelve_foot, self.eight_foot, self.four_foot


@dataclass(frozen=True)
class Sheet:
    """Lines of the sheet, m, measured from the tee along y or across along x.

    Sheets are 4.42 to 5.00 m wide; ``half_width`` is that of one of 4.75 m, and borders were
    seen from ``half_width_min`` to ``half_width_max``.
    """

    back_line: float = 1.829
    hog_line: float = 6.401
    far_tee: float = 34.747
    half_width: float = 2.375
    half_width_min: float = 2.16
    half_width_max: float = 2.50


@dataclass(frozen=True)
class Stone:
    """The stone: outer radius, visible cap and its height above the ice, m; mass, kg.

    ``rim_height`` is where it is widest, m above the ice: there its outline is seen.
    ``inertia`` is k in I = k m R² about the vertical (0.5 for a cylinder).
    """

    radius: float = 0.1455
    cap_radius: float = 0.1045
    cap_height: float = 0.12
    rim_height: float = 0.06
    mass: float = 19.1
    inertia: float = 0.5


HOUSE = House()
SHEET = Sheet()
STONE = Stone()


def curling_size(radius: float) -> bool:
    """Whether discs of that radius, m, have the size of curling stones."""
    return abs(radius / STONE.radius - 1) < 0.1
