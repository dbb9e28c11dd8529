"""Tables with one row per time and the stones side by side, Tracker's own among them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.columns import clock_column, refuse_disorder, times_of, values_of
from curlshot.data.delimited import TextTable
from curlshot.data.errors import InputError
from curlshot.data.headers import (
    ANGLE_NAMES,
    RATE,
    RATES,
    TIME_NAMES,
    bracketed,
    is_place,
    plain_name,
)
from curlshot.data.track_file import TrackFile
from curlshot.data.tracks import stone_name
from curlshot.data.units import ANGLE_UNITS, LENGTH_UNITS, abbreviated

Array = NDArray[np.float64]

ERRORS = ("sd_x", "sd_y", "sd_theta", "sd_place_x", "sd_place_y", "rise_a", "rise_b")
"""Errors that a table may tell."""

COMPANIONS = ("theta", *ERRORS, "frame")
"""What else a table may tell of a place."""

_CENTRE = {"c", "cm", "com", "centre", "center", "pos", "position"}
_DERIVED = {"v", "a", "p", "pixel", "px", *RATES, "sd"}
_QUANTITY = "|".join(_DERIVED)
_PLACED = re.compile(rf"[_ .]+(?:{'|'.join(_CENTRE)})$")


@dataclass(frozen=True)
class Place:
    """Columns of one stone in a wide table: of its place, and of what else is told of it."""

    stone: str
    x: int
    y: int
    others: Mapping[str, int] = field(default_factory=dict)

    @property
    def columns(self) -> dict[str, int]:
        """Give all of its columns by what they hold."""
        return {"x": self.x, "y": self.y, **self.others}


def pairs_of(written: Sequence[str]) -> dict[str, tuple[int, int]]:
    """Columns of x and y by what their names share: ``x1, y1`` or ``red_x, red_y``."""
    names = [plain_name(name) for name in written]
    # An angle of a stone named x, or the error of a place, is no place.
    places = {
        k: name for k, name in enumerate(names) if name.split("_")[0] not in {*ANGLE_NAMES, "sd"}
    }
    named = _halves((name[:1], name[1:], k) for k, name in places.items())
    used = {k for pair in named.values() for k in pair}
    others = _halves((name[-1:], name[:-1], k) for k, name in places.items() if k not in used)
    only = [k for pair in (named | others).values() for k in pair]
    # By itself A_x is no acceleration, which Tracker calls ax.
    first = {"a"} if len(only) == 2 and all(written[k].startswith("A") for k in only) else set()
    return _stones(others, rf"[_ .]*({_QUANTITY})$", first) | _stones(
        named, rf"^({_QUANTITY})([_ .]+|$)", {"a"}
    )


def _stones(
    pairs: Mapping[str, tuple[int, int]], quantity: str, always: set[str]
) -> dict[str, tuple[int, int]]:
    """Leave out what is no place: ``vx, vy`` and ``ax, ay``, and of a stone ``red_vx, red_vy``.

    But ``xA, yA`` are of a stone A, and ``ax, ay`` of one beside ``bx, by`` or ``avx, avy``.
    ``red_pos_x`` is a place of red, beside ``red_vel_x``.
    """
    stones = {"", *pairs, *(_PLACED.sub("", stem) for stem in pairs)}
    lettered = any(len(stem) == 1 and stem not in _DERIVED for stem in pairs)
    whose = {stem: re.sub(quantity, "", stem) for stem in pairs}
    known = {"a", "p"} if lettered else always  # the first of sixteen and the last
    known = known | {whose[stem] for stem in pairs if whose[stem] not in {"", stem}}
    return {
        stem: pair
        for stem, pair in pairs.items()
        if not RATE.search(stem)
        and (stem in known or (stem and (whose[stem] == stem or whose[stem] not in stones)))
    }


def _halves(names: Iterable[tuple[str, str, int]]) -> dict[str, tuple[int, int]]:
    """Find axes that share a stem, from the axis, the stem and the column of each."""
    found: dict[str, dict[str, int]] = {}
    for axis, stem, column in names:
        if axis in ("x", "y"):
            found.setdefault(stem.strip("_ ."), {}).setdefault(axis, column)
    return {stem: (half["x"], half["y"]) for stem, half in found.items() if len(half) == 2}


def read_wide(table: TextTable, names: Sequence[str], fps: float | None) -> TrackFile:
    """Read one row per time, the stones side by side."""
    places = _blocks(table, names) or _named_pairs(table, names)
    if not places:
        if any(name in ("θ", "θr", "ω") for name in names):
            raise InputError(
                f"{table.path}: only angles about the origin, no x and y; export x and y too"
            )
        raise InputError(
            f"{table.path}: no columns x and y (there are {', '.join(names)[:80]}); needs t, x, y"
        )
    doubled = [name for name, n in Counter(p.stone for p in places).items() if n > 1]
    if doubled:
        raise InputError(
            f"{table.path}: two stones with one name, {doubled[0]}; rename one in the line of names"
        )
    clock = clock_column(table, names, fps)
    columns = {k for place in places for k in place.columns.values()}
    values = values_of(table, columns, clock)
    times, decimals, warnings = times_of(table, values, clock, fps)
    others = [k for k, name in enumerate(names) if name in TIME_NAMES and k != clock]
    if any(not np.array_equal(table.numbers([k], k)[:, 0], values[clock or 0]) for k in others):
        raise InputError(f"{table.path}: two columns of times that differ; one file per stone")
    _refuse_partly(table, places)
    pairs = pairs_of(table.names or names)
    unread = [stem for stem, (x, _) in pairs.items() if x not in columns]
    if unread:
        warnings.append(f"{table.path}: x and y of {', '.join(unread)} next to x and y; left out")
    used = columns.union(*pairs.values())
    lone = [name for k, name in enumerate(names) if k not in used and is_place(name)]
    if lone:
        warnings.append(f"{table.path}: {', '.join(lone)} without the other axis; left out")
    return side_by_side(table, values, places, times, decimals, warnings)


def _refuse_partly(table: TextTable, places: Sequence[Place]) -> None:
    """Refuse places of which some have a unit and others none, if that is not the usual one."""
    written = table.names or ()
    units = [{abbreviated(bracketed(written[k]) or "") for k in (p.x, p.y)} for p in places]
    told = [not pair.isdisjoint(LENGTH_UNITS) for pair in units]
    if any(told) and not all(told) and "m" not in set().union(*units):
        one, other = (written[places[told.index(so)].x] for so in (True, False))
        raise InputError(
            f"{table.path}: {one} has a length unit and {other} has none; write it behind all"
        )


def _blocks(table: TextTable, names: Sequence[str]) -> list[Place]:
    """Places in Tracker's layout: columns named x and y, one block after the other."""
    xs = [k for k, name in enumerate(names) if name == "x"]
    ys = [k for k, name in enumerate(names) if name == "y"]
    if len(xs) != len(ys):
        raise InputError(f"{table.path}: columns x: {len(xs)}, columns y: {len(ys)}; needs as many")
    stones = _titles(table, xs, len(names))
    others: list[dict[str, int]] = [{} for _ in xs]
    for kind in COMPANIONS:
        alike = ANGLE_NAMES if kind == "theta" else {kind}
        found = [k for k, name in enumerate(names) if name in alike]
        if len(found) == len(xs):
            for place, column in zip(others, found, strict=True):
                place[kind] = column
    return [Place(stones[k], xs[k], ys[k], others[k]) for k in range(len(xs))]


def _titles(table: TextTable, starts: Sequence[int], width: int) -> list[str]:
    """Names of the tracks: from the line above the header, else the file, else by order."""
    count = len(starts)
    title = table.title
    if count == 1:
        return [title_of(table)]
    if title and count and (width - 1) % count == 0:
        # A name is followed by as many delimiters as its track has columns.
        gap = table.delimiter * ((width - 1) // count)
        parts = title.removeprefix(table.delimiter).split(gap)
        named = [part.strip(table.delimiter + " \t") for part in parts[:count]]
        if len(named) == count and all(named):
            return named
    cells = [cell.strip() for cell in title.split(table.delimiter)]
    found = []
    for start in starts:
        before = [cell for cell in cells[: start + 1] if cell]
        found.append(before[-1] if before else "")
    return found if all(found) else [stone_name(k) for k in range(count)]


def title_of(table: TextTable) -> str:
    """Name of the only track: the line above, or the file's name."""
    return table.title.strip(table.delimiter + " \t\"'") or table.path.stem


def _named_pairs(table: TextTable, names: Sequence[str]) -> list[Place]:
    """Places whose columns carry the stone's name: ``x1, y1``; ``c_a_x, c_a_y, ang_a``."""
    places = []
    pairs = pairs_of(table.names or names)
    frame = names.index("frame") if "frame" in names else None
    for stem, (x, y) in pairs.items():
        twice = [names[k] for k in (x, y) if names.count(names[k]) > 1]
        if twice:
            raise InputError(f"{table.path}: two columns named {twice[0]}; rename one")
        words = re.split(r"[_ .]+", stem)
        stone = stem
        if words[0] in _CENTRE and len(words) > 1 and words[-1] not in _CENTRE - {"c"}:
            stone = stem[len(words[0]) + 1 :]
        elif words[-1] in _CENTRE and len(words) > 1:
            stone = _PLACED.sub("", stem)  # c_pos is that of a stone c
        elif words[0] in _CENTRE and len(pairs) == 1:
            stone = title_of(table)
        others = {} if frame is None else {"frame": frame}
        for k, name in enumerate(names):
            kind, _, whose = name.rpartition(f"_{stone}")
            if not whose and kind in ERRORS:
                others.setdefault(kind, k)
            elif _angle_of(name) in (stem, stone):
                others.setdefault("theta", k)
        written = table.names[x] if table.names is not None else ""
        places.append(Place(_as_written(stone, written), x, y, others))
    return places


def _as_written(stone: str, column: str) -> str:
    """Give a name the capitals that it has in the name of a column."""
    at = column.casefold().rfind(stone)
    return (
        column[at : at + len(stone)] if at >= 0 and len(column.casefold()) == len(column) else stone
    )


def _angle_of(name: str) -> str | None:
    """Find the stone that a column such as ``ang_a`` or ``theta1`` belongs to."""
    for word in sorted(ANGLE_NAMES, key=len, reverse=True):
        if name.startswith(word):
            return name.removeprefix(word).strip("_ .")
        if name.endswith(word):
            return name.removesuffix(word).strip("_ .")
    return None


def side_by_side(
    table: TextTable,
    values: dict[int, Array],
    places: Sequence[Place],
    times: Array,
    decimals: int | None,
    warnings: list[str],
) -> TrackFile:
    """Make a file of tracks out of the columns of its stones and their common times.

    Raises
    ------
    InputError
        Where a row has half a place at its end, the times are in disorder, or there is no place at
        all.
    """
    table.refuse_cut((place.x, place.y) for place in places)
    refuse_disorder(table, times)
    parts = []
    for place in places:
        present = {key: values[column] for key, column in place.columns.items()}
        part = pd.DataFrame({"stone": place.stone, "t": times, **present})
        part = part[part["x"].notna() & part["y"].notna()]
        if part.empty:
            warnings.append(f"{table.path}: {place.stone} has no place in any row; left out")
            continue
        if "theta" in part and _about_origin(part):
            warnings.append(
                f"{table.path}: the angle of {place.stone} is that of its place about the origin,"
                " not its spin; left out"
            )
            part = part.drop(columns="theta")
        parts.append(part)
    if not parts:
        raise InputError(f"{table.path}: no row with a place (x and y)")
    tracks = pd.concat(parts, ignore_index=True)
    return TrackFile(tracks, decimals, warnings=warnings)


def _about_origin(part: pd.DataFrame) -> bool:
    """Tell whether an angle is just the direction of the place, in degrees or radians."""
    place = np.arctan2(part["y"].to_numpy(), part["x"].to_numpy())
    theta = part["theta"].to_numpy()
    known = np.isfinite(theta) & np.isfinite(place)
    if not known.any() or np.ptp(place[known]) < 0.05:
        return False
    for unit in ANGLE_UNITS.values():
        away = np.exp(1j * (theta[known] * unit - place[known]))
        if float(np.abs(np.angle(away)).max()) < 0.02:
            return True
    return False
