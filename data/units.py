"""Units in which people keep lengths and angles."""

from __future__ import annotations

import math
from numbers import Real

from curlshot.data.errors import InputError

LENGTH_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048, "yd": 0.9144}
"""Metres in one of each."""

SPELLED = {
    "meter": "m", "metre": "m", "centimeter": "cm", "centimetre": "cm", "millimeter": "mm",
    "millimetre": "mm", "inch": "in", "inche": "in", "foot": "ft", "feet": "ft", "yard": "yd",
    "second": "s", "sec": "s", "millisecond": "ms", "msec": "ms", "minute": "min", "hour": "h",
    "hr": "h", "sekunde": "s", "sekunden": "s", "sek": "s", "seconde": "s", "seconden": "s",
    "segundo": "s", "secondi": "s", "sekundy": "s", "с": "s", "мс": "ms", "秒": "s",
    "zentimeter": "cm", "mètre": "m", "centimètre": "cm", "millimètre": "mm", "metro": "m",
    "centímetro": "cm", "milímetro": "mm", "centimetro": "cm", "millimetro": "mm",
    "м": "m", "см": "cm", "мм": "mm",
    "radian": "rad", "degree": "deg", "°": "deg",
}  # fmt: skip
"""Units written out, without an s at their end, and in other letters; seconds in all languages
that times are known in (`curlshot.data.headers.TIME_NAMES`)."""

TIME_UNITS = {"s": 1.0, "ms": 0.001, "min": 60.0, "h": 3600.0}
"""Seconds in one of each."""

ANGLE_UNITS = {"rad": 1.0, "deg": math.pi / 180}
"""Radians in one of each."""

KNOWN_UNITS = {*LENGTH_UNITS, *TIME_UNITS, *ANGLE_UNITS}


def abbreviated(unit: str) -> str:
    """Give a unit as it is known here, whether written out or not; others as they are."""
    plain = unit.strip().lower().removesuffix(".")
    one = plain.removesuffix("s")
    return SPELLED.get(one, next((name for name in (plain, one) if name in KNOWN_UNITS), unit))


def check_units(length_unit: str | None, angle_unit: str | None, fps: float | None) -> None:
    """Refuse units that are unknown, and rates of pictures or rows that are none."""
    if length_unit is not None and length_unit not in tuple(LENGTH_UNITS):
        raise InputError(f"length unit {length_unit!r}: one of {', '.join(LENGTH_UNITS)}, please")
    if angle_unit is not None and angle_unit not in tuple(ANGLE_UNITS):
        raise InputError(f"angle unit {angle_unit!r}: one of {', '.join(ANGLE_UNITS)}, please")
    number = isinstance(fps, Real) and not isinstance(fps, bool)
    if fps is not None and not (number and 0 < fps < math.inf):
        raise InputError(f"frame rate {fps!r}: must be a positive number")


def unit_of_lengths(told: str | None, said: str | None, source: str, teller: str) -> str:
    """Choose the unit of a file's lengths.

    Parameters
    ----------
    told : str or None
        What the file tells; None or empty where it tells nothing.
    said : str or None
        What the person says.
    source, teller : str
        The file, and what of it tells.

    Raises
    ------
    InputError
        Where both tell and differ, or what the file tells is unknown and the person says nothing.
    """
    if not told:
        return said or "m"
    told = abbreviated(told)
    if told not in LENGTH_UNITS:
        if said is None:
            raise InputError(
                f"{source}: its length unit is “{told[:20]}”, which is unknown here; known are"
                f" {', '.join(LENGTH_UNITS)}: set one in the {teller}, or name it (`length_unit`)"
            )
        return said
    if said not in (None, told):
        raise InputError(f"{source}: its length unit is {told}, as the {teller} says, not {said}")
    return told


def unit_of_angles(told: str | None, said: str | None, source: str) -> str | None:
    """Choose the unit of angles: what the person says, else what the file tells, if it does.

    Raises
    ------
    InputError
        Where what the file tells is unknown and the person says nothing.
    """
    if said or not told or told in ANGLE_UNITS:
        return said or told or None
    raise InputError(
        f"{source}: its unit of angles is “{told[:20]}”, which is unknown here; known are"
        f" {', '.join(ANGLE_UNITS)}: set one in the header, or name it (`angle_unit`)"
    )
