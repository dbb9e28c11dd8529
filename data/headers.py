"""Names of columns as people write them, and the units that stand behind them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from curlshot.data.units import ANGLE_UNITS, KNOWN_UNITS, LENGTH_UNITS, abbreviated

TIME_NAMES = {
    "t", "time", "zeit", "temps", "tiempo", "tempo", "tijd", "czas", "время", "час", "時間", "时间",
}  # fmt: skip
"""What a column of times is called; spreadsheets are written by hand, in any language.
``tid`` (in Scandinavia) is none of them: it is a usual name for the number of a track, too."""

ANGLE_NAMES = {"ang", "angle", "theta"}
"""What a column of angles is called."""

RATES = ("velocity", "vel", "acceleration", "acc")
"""What columns are called that tell of no place, though they have an x and a y."""

RATE = re.compile(rf"(?:^|[_ .])(?:{'|'.join(RATES)})(?:$|[_ .])")

_PLACE = re.compile(r"(?:.*[_ .])?[xy]|[xy](?:\d*|[a-z]|pos)(?:[_ .].*)?")
_ENDING = re.compile(r"(.{1,80}?)[_ ]+([^\W_]+)")
_NO_PLACE = re.compile(
    rf"(?:.*[_ .])?(?:{'|'.join(RATES)}|v|pixel|px|sd)(?:[_ .].*)?|a[_ .][xy]"  # x_a: of stone a
)
_ANGLE = re.compile(rf"(?:.*[_ .])?(?:{'|'.join(sorted(ANGLE_NAMES))})(?:[_ .].*)?")


def plain_name(name: str) -> str:
    """Name of a column without unit, TeX and case: ``v_{x} (m/s)`` becomes ``vx``."""
    bare = re.sub(r"\(.*?\)|\[.*?\]|°", "", name[:100])
    return bare.replace("_{", "").replace("}", "").strip(" \"'").rstrip("_ ").casefold()


def bracketed(name: str) -> str | None:
    """Give what stands in brackets in the name of a column, mostly its unit."""
    found = re.search(r"[(\[]\s*([^)\]]*?)\s*[)\]]", name[:100])
    return found[1] if found else None


def is_place(name: str) -> bool:
    """Whether the plain name of a column looks like that of an x or a y."""
    return bool(_PLACE.fullmatch(name) and not _NO_PLACE.fullmatch(name))


def in_brackets(name: str) -> str:
    """Put a unit behind a name as in ``x / m``, ``x in m`` or ``x, m`` into brackets."""
    found = re.fullmatch(r"(\S.{0,80}?)(?:\s*[/,]\s*| in )(\w+|°)", name)
    return f"{found[1]} ({found[2]})" if found and abbreviated(found[2]) in KNOWN_UNITS else name


def with_units(names: Sequence[str]) -> list[str]:
    """Put units that names end in into brackets: ``t_s``, ``x cm``, ``red_theta_deg``.

    What stands behind an x or a y that ends another word, as in ``red_x_cm``, can be nothing else.
    Behind others it can, if not all have one: ``x_m`` beside ``x_a`` is of a stone m, and so it is
    beside ``theta_m``. Times have one only if there are no others: ``t_ms`` beside ``t``.
    """
    written = [in_brackets(name.strip()) for name in names]
    plain = [plain_name(name) for name in written]
    ends = [_ENDING.fullmatch(name.casefold()) for name in written]

    def ending(units: Mapping[str, float], called: Callable[[str], object]) -> dict[int, str]:
        return {
            k: end[1]
            for k, end in enumerate(ends)
            if end and abbreviated(end[2]) in units and called(end[1])
        }

    axes = ending(LENGTH_UNITS, re.compile(r".+[xy]").fullmatch)
    stems = {*plain, *axes.values()}
    axes = {k: stem for k, stem in axes.items() if stem[:-1] + "xy"[stem[-1] == "x"] in stems}
    places = ending(LENGTH_UNITS, _PLACE.fullmatch)
    angles = ending(ANGLE_UNITS, _ANGLE.fullmatch)
    others = [name for k, name in enumerate(plain) if k not in places and k not in axes]
    if ending(LENGTH_UNITS, _ANGLE.fullmatch) or any(map(is_place, others)):
        places = {}
    if ending(ANGLE_UNITS, _PLACE.fullmatch):
        angles = {}
    times = ending({"s": 1.0, "ms": 0.001}, TIME_NAMES.__contains__)
    if TIME_NAMES.isdisjoint(plain):
        first = next(iter(times), 0)
        times = {k: stem for k, stem in times.items() if plain[k] == plain[first]}
    else:
        times = {}
    for k in {*axes, *places, *angles, *times}:
        found = re.fullmatch(r"(.+?)[_ ]+([^_ ]+)", written[k])
        written[k] = f"{found[1]} ({found[2]})" if found else written[k]
    return written
