"""Units of the columns of tables, by their names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

_NAMES = {
    "s": ("t", "t0", "t1"),
    "m": ("x", "y", "x0", "y0", "x1", "y1", "path", "to_tee", "curl", "beyond", "place_x",
          "place_y", "dx", "dy"),
    "m/s": ("vx", "vy", "speed", "mean_speed", "top_speed", "closing_speed"),
    "rad": ("theta", "turned", "rise_a", "rise_b"),
    "rad/s": ("omega", "spin", "turn_rate"),
}  # fmt: skip
_UNITS = {name: unit for unit, names in _NAMES.items() for name in names}
_PREFIXES = ("meas_", "sd_", "stderr_")
"""What a column of measurements, or of standard errors, has before its name."""


def unit_of(column: str) -> str:
    """Return the unit of a column by its name; an empty text where it has none.

    Examples
    --------
    >>> unit_of("meas_sd_x"), unit_of("omega"), unit_of("stone")
    ('m', 'rad/s', '')
    """
    for prefix in _PREFIXES:
        column = column.removeprefix(prefix)
    return _UNITS.get(column, "")


def units_of(columns: Iterable[str]) -> dict[str, str]:
    """Return the unit of each column, for ``attrs["units"]`` of a table."""
    return {str(name): unit_of(str(name)) for name in columns}


def with_units(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table, the units of its columns in ``attrs["units"]``."""
    table.attrs["units"] = units_of(table.columns)
    return table
