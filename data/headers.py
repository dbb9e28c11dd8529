"""Names of columns as people write them, and the units that stand behind them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from data.units import ANGLE_UNITS, KNOWN_UNITS, LENGTH_UNITS, abbreviated

TIME_NAMES = {"t", "time", "zeit", "temps", "tiempo", "tempo", "tijd", "czas"}
"""What a column of times is called; spreadsheets are written by hand, in any language.
``tid`` (in Scandinavia) is none of them: it is a usual name for the number of a track, too."""

ANGLE_NAMES = {"ang", "angle", "theta"}
"""What a column of angles is called."""

RATES = ("velocity", "vel", "acceleration", "acc")
"""What columns are called that tell of no place, though they have an x and a y."""

RATE = re.compile(rf"(?:^|[_ .])(?:{'|'.join(RATES)})(?:$|[_ .])")

_PLACE = re.compile(r"(?:.*[_ .])?[xy]|[xy](?:\d*|[a-z]|pos)(?:[_ .].*)?")
_NO_PLACE = re.compile(
    rf"(?:.*[_ .])?(?:{'|'.join(RATES)}|v|pixel|px|sd)(?:[_ .].*)?|a[_ .][xy]"  # x_a: of stone a
)
_ANGLE = re.compile(rf"(?:.*[_ .])?(?:{'|'.join(sorted(ANGLE_NAMES))})(?:[_ .].*)?")


def plain_name(name: str) -> str:
    """Name of a column without unit, TeX and case: ``v_{x} (m/s)`` becomes ``vx``."""
    bare = re.sub(r"\(.*?\)|\[.*?\]|°", "", name[:100])
    return bare.replace("_{", "").replace("}", "").strip(" \"'").casefold()


def in_brackets(name: str) -> str:
    """Put a unit that stands behind a name as in ``x / m`` or ``x in m`` into brackets."""
    found = re.fullmatch(r"(\S.{0,80}?)(?:\s*/\s*| in )(\w+|°)", name)
    return f"{found[1]} ({found[2]})" if found and abbreviated(found[2]) in KNOWN_UNITS else name


def with_units(names: Sequence[str]) -> list[str]:
    """Put units that names end in into brackets: ``t_s``, ``x_cm``, ``red_theta_deg``.

    Those of places only if all of these have one: ``x_m`` beside ``x_a`` is of a stone m, and so it
    is beside ``theta_m``. Those of times only if there are no others: ``t_ms`` beside ``t``.
    """
    written = [in_brackets(name.strip()) for name in names]
    plain = [plain_name(name) for name in written]
    ends = [re.fullmatch(r"(.{1,80}?)_([a-z]+)", name.casefold()) for name in written]

    def ending(units: Mapping[str, float], called: re.Pattern[str]) -> list[int]:
        return [
            k
            for k, end in enumerate(ends)
            if end and abbreviated(end[2]) in units and called.fullmatch(end[1])
        ]

    places, angles = ending(LENGTH_UNITS, _PLACE), ending(ANGLE_UNITS, _ANGLE)
    others = [name for k, name in enumerate(plain) if k not in places]
    if ending(LENGTH_UNITS, _ANGLE) or any(
        _PLACE.fullmatch(name) and not _NO_PLACE.fullmatch(name) for name in others
    ):
        places = []
    if ending(ANGLE_UNITS, _PLACE):
        angles = []
    times = ending({"s": 1.0, "ms": 0.001}, re.compile("|".join(TIME_NAMES)))
    if TIME_NAMES.isdisjoint(plain):
        times = [k for k in times if plain[k] == plain[times[0]]]
    else:
        times = []
    for k in {*places, *angles, *times}:
        stem, _, unit = written[k].rpartition("_")
        written[k] = f"{stem} ({unit})"
    return written
