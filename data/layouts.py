"""Which column of a text table is what: the layouts in which people keep tracks.

One row per time with the stones side by side (Tracker's export, ``t, x1, y1, x2, y2``), one
row per stone and time (``stone, t, x, y``), or no header at all (``t x y``).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from data.columns import (
    ANGLE_UNITS,
    LENGTH_UNITS,
    TIME_NAMES,
    clock_column,
    plain_name,
    refuse_disorder,
    times_of,
    values_of,
    written_unit,
)
from data.delimited import TextTable, read_text_table
from data.errors import InputError
from data.tracks import stone_name

Array = NDArray[np.float64]

_CENTRE = {"c", "cm", "com", "centre", "center", "pos", "position"}
_ANGLE = {"ang", "angle", "theta"}
_DERIVED = {"v", "a", "p", "pixel", "px", "vel", "velocity", "acc", "acceleration", "sd"}
_COMPANIONS = ("theta", "sd_x", "sd_y", "sd_theta", "frame")


@dataclass
class TrackFile:
    """What one file holds, in the file's units.

    Attributes
    ----------
    tracks : DataFrame
        ``stone, t, x, y`` and, where the file has them, ``theta``, ``frame``, ``team`` and the sd
        columns; t in s, all with a place.
    decimals : int or None
        To how many decimals the times are printed; None where that does not matter.
    length_unit, angle_unit : str or None
        As the header says.
    continuous : bool
        Whether angles run on past a full turn by the layout's own rule.
    warnings : list of str
        What was decided on evidence, or left out.
    masses : dict of str to float
        Masses of the tracks by name, where the file has them.
    """

    tracks: pd.DataFrame
    decimals: int | None = None
    length_unit: str | None = None
    angle_unit: str | None = None
    continuous: bool = False
    warnings: list[str] = field(default_factory=list)
    masses: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class _Place:
    """Columns of one stone in a wide table: of its place, and of what else is told of it."""

    stone: str
    x: int
    y: int
    others: Mapping[str, int] = field(default_factory=dict)

    @property
    def columns(self) -> dict[str, int]:
        return {"x": self.x, "y": self.y, **self.others}


def read_layout(path: Path, fps: float | None) -> TrackFile:
    """Read the tracks in one file, in its own units.

    Parameters
    ----------
    path : Path
        The file.
    fps : float or None
        Rate of the rows where the file has no times, 1/s.

    Raises
    ------
    InputError
        One line that says what makes no sense and where.
    """
    table = read_text_table(path, _is_header)
    if not table.rows:
        raise InputError(f"{path}: a header without rows of data")
    if table.width < 2:
        raise InputError(f"{path}: only one column; needs t, x and y")
    names = None if table.names is None else [plain_name(name) for name in table.names]
    if names is None:
        file = _without_header(table, fps)
    elif "stone" in names:
        file = _tidy(table, names, fps)
    else:
        file = _wide(table, names, fps)
    file.warnings[:0] = table.warnings
    if table.names is not None and names is not None:
        file.length_unit = written_unit(table.names, names, ("x", "y"), LENGTH_UNITS)
        written = written_unit(table.names, names, tuple(_ANGLE), ANGLE_UNITS)
        file.angle_unit = written or file.angle_unit
    return file


def _is_header(cells: Sequence[str]) -> bool:
    names = [plain_name(cell) for cell in cells]
    return names[0] in TIME_NAMES or ("x" in names and "y" in names) or bool(_pairs(names))


def _pairs(names: Sequence[str]) -> dict[str, tuple[int, int]]:
    """Columns of x and y by what their names share: ``x1, y1`` or ``red_x, red_y``."""
    # An angle of a stone named x, or the error of a place, is no place.
    places = {k: name for k, name in enumerate(names) if name.split("_")[0] not in {*_ANGLE, "sd"}}
    pairs = _halves((name[:1], name[1:], k) for k, name in places.items())
    used = {k for pair in pairs.values() for k in pair}
    rest = ((name[-1:], name[:-1], k) for k, name in places.items() if k not in used)
    pairs = _halves(rest) | pairs
    pairs.pop("", None)
    # vx, vy, ax, ay and so on are no stones; but ax, ay beside bx, by are.
    dull = _DERIVED if set(pairs) <= _DERIVED else _DERIVED - {"a"}
    return {stem: pair for stem, pair in pairs.items() if stem not in dull}


def _halves(names: Iterable[tuple[str, str, int]]) -> dict[str, tuple[int, int]]:
    """Find axes that share a stem, from the axis, the stem and the column of each."""
    found: dict[str, dict[str, int]] = {}
    for axis, stem, column in names:
        if axis in ("x", "y"):
            found.setdefault(stem.strip("_ ."), {}).setdefault(axis, column)
    return {stem: (half["x"], half["y"]) for stem, half in found.items() if len(half) == 2}


def _wide(table: TextTable, names: Sequence[str], fps: float | None) -> TrackFile:
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
    columns = {clock} | {k for place in places for k in place.columns.values()}
    values = values_of(table, columns)
    times, decimals, warnings = times_of(table, values, clock, fps)
    others = [k for k, name in enumerate(names) if name in TIME_NAMES and k != clock]
    if any(not np.array_equal(table.numbers([k])[:, 0], values[clock or 0]) for k in others):
        raise InputError(f"{table.path}: two columns of times that differ; one file per stone")
    unread = [stem for stem, (x, _) in _pairs(names).items() if x not in columns]
    if unread:
        warnings.append(f"{table.path}: x and y of {', '.join(unread)} beside x and y; left out")
    return _side_by_side(table, values, places, times, decimals, warnings)


def _blocks(table: TextTable, names: Sequence[str]) -> list[_Place]:
    """Places in Tracker's layout: columns named x and y, one block after the other."""
    xs = [k for k, name in enumerate(names) if name == "x"]
    ys = [k for k, name in enumerate(names) if name == "y"]
    if len(xs) != len(ys):
        raise InputError(f"{table.path}: columns x: {len(xs)}, columns y: {len(ys)}; needs as many")
    stones = _titles(table, xs, len(names))
    others: list[dict[str, int]] = [{} for _ in xs]
    for kind in _COMPANIONS:
        alike = _ANGLE if kind == "theta" else {kind}
        found = [k for k, name in enumerate(names) if name in alike]
        if len(found) == len(xs):
            for place, column in zip(others, found, strict=True):
                place[kind] = column
    return [_Place(stones[k], xs[k], ys[k], others[k]) for k in range(len(xs))]


def _titles(table: TextTable, starts: Sequence[int], width: int) -> list[str]:
    """Names of the tracks: from the line above the header, else the file, else by order."""
    count = len(starts)
    title = table.title
    if count == 1:
        return [_title(table)]
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


def _title(table: TextTable) -> str:
    """Name of the only track: the line above, or the file's name."""
    return table.title.strip(table.delimiter + " \t\"'") or table.path.stem


def _named_pairs(table: TextTable, names: Sequence[str]) -> list[_Place]:
    """Places whose columns carry the stone's name: ``x1, y1``; ``c_a_x, c_a_y, ang_a``."""
    places = []
    pairs = _pairs(names)
    frame = names.index("frame") if "frame" in names else None
    for stem, (x, y) in pairs.items():
        words = re.split(r"[_ .]+", stem)
        stone = stem
        if words[0] in _CENTRE and len(words) > 1:
            stone = stem[len(words[0]) + 1 :]
        elif words[0] in _CENTRE and len(pairs) == 1:
            stone = _title(table)
        others = {} if frame is None else {"frame": frame}
        for k, name in enumerate(names):
            kind, _, whose = name.rpartition(f"_{stone}")
            if not whose and kind in ("sd_x", "sd_y", "sd_theta"):
                others.setdefault(kind, k)
            elif _angle_of(name) in (stem, stone):
                others.setdefault("theta", k)
        written = table.names[x] if table.names is not None else ""
        places.append(_Place(_as_written(stone, written), x, y, others))
    return places


def _as_written(stone: str, column: str) -> str:
    """Give a name the capitals that it has in the name of a column."""
    at = column.casefold().rfind(stone)
    return (
        column[at : at + len(stone)] if at >= 0 and len(column.casefold()) == len(column) else stone
    )


def _angle_of(name: str) -> str | None:
    """Find the stone that a column such as ``ang_a`` or ``theta1`` belongs to."""
    for word in sorted(_ANGLE, key=len, reverse=True):
        if name.startswith(word):
            return name.removeprefix(word).strip("_ .")
        if name.endswith(word):
            return name.removesuffix(word).strip("_ .")
    return None


def _side_by_side(
    table: TextTable,
    values: dict[int, Array],
    places: Sequence[_Place],
    times: Array,
    decimals: int | None,
    warnings: list[str],
) -> TrackFile:
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


def _tidy(table: TextTable, names: Sequence[str], fps: float | None) -> TrackFile:
    """Read one row per stone and time, columns in any order."""
    missing = [name for name in ("x", "y") if name not in names]
    if missing:
        raise InputError(f"{table.path}: no column {', '.join(missing)}; needs stone, t, x, y")
    doubled = [name for name, n in Counter(names).items() if n > 1 and name]
    if doubled:
        raise InputError(f"{table.path}: two columns named {doubled[0]}")
    if TIME_NAMES.isdisjoint(names) and "frame" not in names:
        raise InputError(f"{table.path}: no column t; needs stone, t, x, y")
    clock = clock_column(table, names, fps)
    wanted = {n: names.index(n) for n in ("x", "y", "seen", *_COMPANIONS) if n in names}
    values = values_of(table, {clock, *wanted.values()})
    times, decimals, warnings = times_of(table, values, clock, fps)
    stones = [stone.strip("\"'") for stone in table.cells([names.index("stone")])[0]]
    tracks = pd.DataFrame({"stone": stones, "t": times} | {n: values[k] for n, k in wanted.items()})
    if "team" in names:
        tracks["team"] = [team.strip("\"'") for team in table.cells([names.index("team")])[0]]
    used = tracks["x"].notna() & tracks["y"].notna()
    if "seen" in tracks:
        # What a filter carried is no measurement.
        used &= tracks.pop("seen") != 0
    tracks = tracks[used]
    if "" in set(tracks["stone"]):
        row = int(np.flatnonzero(used.to_numpy() & (np.array(stones) == ""))[0])
        raise InputError(f"{table.path}: line {table.line_numbers[row]}: no name in column stone")
    if tracks.empty:
        raise InputError(f"{table.path}: no row with a place (x and y)")
    return TrackFile(tracks, decimals, angle_unit="rad", continuous=True, warnings=warnings)


def _without_header(table: TextTable, fps: float | None) -> TrackFile:
    """Read ``t x y`` or ``t x1 y1 x2 y2``; with a frame rate also without the t."""
    width = table.width
    timeless = width % 2 == 0
    if timeless and fps is None:
        raise InputError(
            f"{table.path}: {width} columns without a header; needs t, x, y (and x, y of each"
            " further stone), or the frame rate (--fps) where there is no t"
        )
    values = values_of(table, range(width))
    times, decimals, warnings = times_of(table, values, None if timeless else 0, fps)
    refuse_disorder(table, times)
    starts = range(0 if timeless else 1, width, 2)
    numbers = np.column_stack(list(values.values()))
    kept = [k for k in starts if k == starts[0] or not _is_velocity(times, numbers, k)]
    if len(kept) < len(starts):
        warnings.append(f"{table.path}: columns that are velocities of others are left out")
    stones = [_title(table)] if len(kept) == 1 else [stone_name(k) for k in range(len(kept))]
    layout = ", ".join(("t", "x", "y") if not timeless else ("x", "y"))
    warnings.append(
        f"{table.path}: no header; read as {layout} of {len(kept)} stone"
        f"{'' if len(kept) == 1 else 's, named by order'}"
    )
    places = [_Place(stone, k, k + 1) for stone, k in zip(stones, kept, strict=True)]
    return _side_by_side(table, values, places, times, decimals, warnings)


def _is_velocity(times: Array, numbers: Array, column: int) -> bool:
    """Tell whether a pair of columns is the rate of change of the pair before it."""
    if len(times) < 5:
        return False
    here, before = numbers[:, column : column + 2], numbers[:, column - 2 : column]
    with np.errstate(all="ignore"):
        rate = np.gradient(before, times, axis=0)
        known = np.isfinite(rate).all(axis=1) & np.isfinite(here).all(axis=1)
        off = np.sqrt(np.mean((here - rate)[known] ** 2)) if known.any() else np.inf
        size = np.sqrt(np.mean(rate[known] ** 2)) if known.any() else 0.0
    return bool(off < 0.05 * size)
