"""Units in which people keep lengths and angles."""

from __future__ import annotations

import math

from data.errors import InputError

LENGTH_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres in one of each."""

SPELLED = {
    "meter": "m", "metre": "m", "centimeter": "cm", "centimetre": "cm", "millimeter": "mm",
    "millimetre": "mm", "inch": "in", "inche": "in", "foot": "ft", "feet": "ft",
}  # fmt: skip
"""Units written out, without an s at their end."""

ANGLE_UNITS = {"rad": 1.0, "deg": math.pi / 180}
"""Radians in one of each."""


def check_units(length_unit: str, angle_unit: str | None, fps: float | None) -> None:
    """Refuse units that are unknown, and rates of pictures or rows that are none."""
    if length_unit not in LENGTH_UNITS:
        raise InputError(f"length unit {length_unit!r}: one of {', '.join(LENGTH_UNITS)}, please")
    if angle_unit is not None and angle_unit not in ANGLE_UNITS:
        raise InputError(f"angle unit {angle_unit!r}: one of {', '.join(ANGLE_UNITS)}, please")
    if fps is not None and not 0 < fps < math.inf:
        raise InputError(f"frame rate {fps}: must be a positive number")


def unit_of_lengths(told: str | None, said: str, source: str, teller: str) -> str:
    """Choose the unit of a file's lengths.

    Parameters
    ----------
    told : str or None
        What the file tells; None or empty where it tells nothing.
    said : str
        What the person says, m where nothing.
    source, teller : str
        The file, and what of it tells.

    Raises
    ------
    InputError
        Where both tell and differ, or what the file tells is unknown and the person says nothing.
    """
    if not told:
        return said
    told = SPELLED.get(told.strip().lower().removesuffix("s"), told)
    if told not in LENGTH_UNITS:
        if said == "m":
            raise InputError(
                f"{source}: its length unit is “{told[:20]}”, which is unknown here; set one of"
                f" {', '.join(LENGTH_UNITS)} in Tracker, or name it (--length-unit)"
            )
        return said
    if said not in ("m", told):
        raise InputError(f"{source}: its length unit is {told}, as the {teller} says, not {said}")
    return told
