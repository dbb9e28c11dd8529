"""Tracks from text tables: exports of Tracker (Open Source Physics), spreadsheets, our own.

Tracker's layouts follow its source (versions 4 to 6.3): an optional line ``#multi:``, a
line with the names of the tracks, a header whose first column is t, one block of columns
per track. Its θ, ω and α belong to the place about the origin, not to the spin, and its
velocities can be stale: both are left out.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from data.delimited import TextTable, plain_decimals, read_text_table
from data.errors import InputError
from data.tracks import check_sightings, stone_name

Array = NDArray[np.float64]

LENGTH_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres in one of each."""

ANGLE_UNITS = {"rad": 1.0, "deg": np.pi / 180}
"""Radians in one of each."""

FASTEST = 20.0
"""m/s; a stone is thrown at 2 to 4."""

FARTHEST = 100.0
"""m from the origin; a sheet is 45 long."""

SMALLEST = 0.001
"""m; what moves less than this in the whole table does not move."""

FASTEST_SPIN = 20.0
"""rad/s; three turns a second. Faster angles without a unit are taken as degrees."""

_TIME = {"t", "time"}
_TIME_UNITS = {"s": 1.0, "sec": 1.0, "ms": 0.001}
_CENTRE = {"c", "cm", "com", "centre", "center", "pos", "position"}
_ANGLE = {"ang", "angle", "theta"}
_DERIVED = {"v", "a", "p", "pixel", "px", "vel", "velocity", "acc", "acceleration", "sd"}
_COMPANIONS = ("theta", "sd_x", "sd_y", "sd_theta", "frame")
_LATEST = 1e12


@dataclass(frozen=True)
class Imported:
    """Tracks that were read from files.

    Attributes
    ----------
    sightings : DataFrame
        `data.tracks.SIGHTING_COLUMNS`; m, s, rad; stones are named as in the files.
    warnings : tuple of str
        What was decided on evidence, or left out.
    fps : float or None
        Rate of the rows, 1/s; None where there is only one time.
    """

    sightings: pd.DataFrame
    warnings: tuple[str, ...]
    fps: float | None


@dataclass
class _File:
    """What one file holds, in the file's units."""

    tracks: pd.DataFrame
    decimals: int | None = None
    length_unit: str | None = None
    angle_unit: str | None = None
    warnings: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _Place:
    """Columns of one stone in a wide table."""

    stone: str
    x: int
    y: int
    theta: int | None = None
    frame: int | None = None


def read_tracker(
    paths: Sequence[Path], *, length_unit: str = "m", angle_unit: str | None = None
) -> Imported:
    """Read text exports and table copies of Tracker; as `read_table`."""
    return read_table(paths, length_unit=length_unit, angle_unit=angle_unit)


def read_table(
    paths: Sequence[Path],
    *,
    length_unit: str = "m",
    angle_unit: str | None = None,
    fps: float | None = None,
) -> Imported:
    """Read tracks from text tables of any layout and dialect.

    Parameters
    ----------
    paths : sequence of Path
        One file with all stones, or several, each with its own.
    length_unit : {"m", "cm", "mm", "in", "ft"}
        Unit of x and y, where the file does not say.
    angle_unit : {"rad", "deg"}, optional
        Unit of the stones' own angles. If not given, radians, or degrees where radians
        would make a stone spin absurdly fast (a warning says so).
    fps : float, optional
        Rate of the rows of tables without a time column, 1/s.

    Returns
    -------
    Imported
        Checked sightings.

    Raises
    ------
    InputError
        One line that says what makes no sense, where, and what to do.

    Notes
    -----
    Layouts: Tracker's; ``stone, t, x, y`` with one row per stone and time, in any order;
    wide tables with pairs such as ``x1, y1`` or ``red_x, red_y``; ``t x y`` or
    ``t x1 y1 x2 y2`` without header. Tracker prints times to the millisecond; where
    equal steps explain the printed times, the equal steps are used.
    """
    _check_units(length_unit, angle_unit, fps)
    if not paths:
        raise InputError("no table of tracks given")
    files = [_read(path, fps) for path in paths]
    warnings = [text for file in files for text in file.warnings]
    for path, file in zip(paths, files, strict=True):
        warnings += _to_si(path, file, length_unit, angle_unit)
    source = ", ".join(str(path) for path in paths)
    _refuse_shared_names(paths, files)
    table = pd.concat([file.tracks for file in files], ignore_index=True)
    table, rate = _with_clock(table, [file.decimals for file in files])
    table = check_sightings(table, source)
    warnings += _check_scale(table, source)
    return Imported(table, tuple(dict.fromkeys(warnings)), rate)


def _check_units(length_unit: str, angle_unit: str | None, fps: float | None) -> None:
    if length_unit not in LENGTH_UNITS:
        raise InputError(f"length unit {length_unit!r}: one of {', '.join(LENGTH_UNITS)}, please")
    if angle_unit is not None and angle_unit not in ANGLE_UNITS:
        raise InputError(f"angle unit {angle_unit!r}: one of {', '.join(ANGLE_UNITS)}, please")
    if fps is not None and not (np.isfinite(fps) and fps > 0):
        raise InputError(f"frame rate {fps}: must be a positive number")


def _read(path: Path, fps: float | None) -> _File:
    """Read one file, in its own units."""
    table = read_text_table(path, _is_header)
    if not table.rows:
        raise InputError(f"{path}: a header without rows of data")
    if table.width < 2:
        raise InputError(f"{path}: only one column; needs t, x and y")
    names = None if table.names is None else [_plain(name) for name in table.names]
    if names is None:
        file = _without_header(table, fps)
    elif "stone" in names:
        file = _tidy(table, names, fps)
    else:
        file = _wide(table, names, fps)
    file.warnings[:0] = table.warnings
    if table.names is not None and names is not None:
        file.length_unit = _unit(table.names, names, ("x", "y"), LENGTH_UNITS)
        file.angle_unit = _unit(table.names, names, tuple(_ANGLE), ANGLE_UNITS)
    return file


def _plain(name: str) -> str:
    """Name of a column without unit, TeX and case: ``v_{x} (m/s)`` becomes ``vx``."""
    bare = re.sub(r"\(.*?\)|\[.*?\]|°", "", name)
    return bare.replace("_{", "").replace("}", "").strip(" \"'").casefold()


def _unit(
    written: Sequence[str], plain: Sequence[str], wanted: Sequence[str], units: dict[str, float]
) -> str | None:
    """Find the unit in brackets behind one of the wanted columns."""
    for full, name in zip(written, plain, strict=True):
        bracket = re.search(r"[(\[]\s*([^)\]]*?)\s*[)\]]", full)
        words = set(re.split(r"[_ .\d]+", name))
        if bracket and not words.isdisjoint(wanted) and bracket.group(1) in units:
            return bracket.group(1)
    return None


def _is_header(cells: Sequence[str]) -> bool:
    names = [_plain(cell) for cell in cells]
    return names[0] in _TIME or ("x" in names and "y" in names) or bool(_pairs(names))


def _pairs(names: Sequence[str]) -> dict[str, tuple[int, int]]:
    """Columns of x and y by what their names share: ``red_x, red_y`` or ``x1, y1``."""
    halves: dict[str, dict[str, int]] = {}
    for column, name in enumerate(names):
        for axis in "xy":
            if name[:1] == axis:
                halves.setdefault(name[1:].strip("_ ."), {}).setdefault(axis, column)
            elif name[-1:] == axis:
                halves.setdefault(name[:-1].strip("_ ."), {}).setdefault(axis, column)
    pairs = {stem: (half["x"], half["y"]) for stem, half in halves.items() if len(half) == 2}
    pairs.pop("", None)
    # vx, vy, ax, ay and so on are no stones; but ax, ay beside bx, by are.
    dull = _DERIVED if set(pairs) <= _DERIVED else _DERIVED - {"a"}
    return {stem: pair for stem, pair in pairs.items() if stem not in dull}


def _wide(table: TextTable, names: Sequence[str], fps: float | None) -> _File:
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
    clock = _clock_column(table, names, fps)
    columns = {clock} | {k for p in places for k in (p.x, p.y, p.theta, p.frame)}
    values = _values(table, columns)
    times, decimals, warnings = _times(table, values, clock, fps)
    return _side_by_side(table, values, places, times, decimals, warnings)


def _blocks(table: TextTable, names: Sequence[str]) -> list[_Place]:
    """Places in Tracker's layout: columns named x and y, one block after the other."""
    xs = [k for k, name in enumerate(names) if name == "x"]
    ys = [k for k, name in enumerate(names) if name == "y"]
    if len(xs) != len(ys):
        raise InputError(f"{table.path}: columns x: {len(xs)}, columns y: {len(ys)}; needs as many")
    frames = [k for k, name in enumerate(names) if name == "frame"]
    angles = [k for k, name in enumerate(names) if name in _ANGLE]
    stones = _titles(table, xs, len(names))
    return [
        _Place(
            stones[k],
            xs[k],
            ys[k],
            angles[k] if len(angles) == len(xs) else None,
            frames[k] if len(frames) == len(xs) else None,
        )
        for k in range(len(xs))
    ]


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
    for stem, (x, y) in _pairs(names).items():
        words = re.split(r"[_ .]+", stem)
        stone = stem
        if words[0] in _CENTRE:
            stone = stem[len(words[0]) + 1 :] or _title(table)
        theta = next((k for k, name in enumerate(names) if _angle_of(name) in (stem, stone)), None)
        places.append(_Place(stone, x, y, theta))
    return places


def _angle_of(name: str) -> str | None:
    """Find the stone that a column such as ``ang_a`` or ``theta1`` belongs to."""
    for word in sorted(_ANGLE, key=len, reverse=True):
        if name.startswith(word):
            return name.removeprefix(word).strip("_ .")
        if name.endswith(word):
            return name.removesuffix(word).strip("_ .")
    return None


def _values(table: TextTable, columns: Iterable[int | None]) -> dict[int, Array]:
    """Numbers of some columns, by column; read at once, for one decimal sign."""
    wanted = sorted(column for column in columns if column is not None)
    return dict(zip(wanted, table.numbers(wanted).T, strict=True))


def _side_by_side(
    table: TextTable,
    values: dict[int, Array],
    places: Sequence[_Place],
    times: Array,
    decimals: int | None,
    warnings: list[str],
) -> _File:
    _refuse_disorder(table, times)
    parts = []
    for place in places:
        columns = {"x": place.x, "y": place.y, "theta": place.theta, "frame": place.frame}
        present = {key: values[column] for key, column in columns.items() if column is not None}
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
    return _File(tracks, decimals, warnings=warnings)


def _refuse_disorder(table: TextTable, times: Array) -> None:
    if not np.isfinite(times).all():
        row = int(np.flatnonzero(~np.isfinite(times))[0])
        raise InputError(f"{table.path}: line {table.line_numbers[row]}: no time")
    if np.abs(times).max() > _LATEST:
        raise InputError(f"{table.path}: times up to {np.abs(times).max():g} s make no sense")
    steps = np.diff(times)
    if (steps <= 0).any():
        row = int(np.flatnonzero(steps <= 0)[0])
        how = "goes back" if steps[row] < 0 else "stands still"
        raise InputError(
            f"{table.path}: line {table.line_numbers[row + 1]}: time {how} (from {times[row]:g} s"
            f" to {times[row + 1]:g} s); one row per time, please"
        )


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


def _clock_column(table: TextTable, names: Sequence[str], fps: float | None) -> int | None:
    """Find the column that tells the time, or the frame; None where the rows' number does."""
    for k, name in enumerate(names):
        if name in _TIME:
            return k
    if fps is None:
        raise InputError(
            f"{table.path}: no time column (t); give the frame rate of the rows (--fps)"
        )
    return names.index("frame") if "frame" in names else None


def _times(
    table: TextTable, values: dict[int, Array], column: int | None, fps: float | None
) -> tuple[Array, int | None, list[str]]:
    """Find the times of the rows, s, to how many decimals they are printed, and warnings."""
    if column is None:
        return np.arange(len(table.rows)) / (fps or 1.0), None, []
    times = values[column]
    written = "" if table.names is None else table.names[column]
    if fps is not None and _plain(written) == "frame":
        return times / fps, None, []
    bracket = re.search(r"[(\[]\s*(\w+)\s*[)\]]", written)
    unit = _TIME_UNITS.get(bracket.group(1), 1.0) if bracket else 1.0
    different = np.unique(times)
    whole = not bracket and len(different) > 2 and bool((different == np.floor(different)).all())
    if whole and fps is not None:
        return times / fps, None, [f"{table.path}: the times are whole numbers; taken as frames"]
    warnings: list[str] = []
    if whole:
        warnings.append(
            f"{table.path}: the times are whole numbers; taken as seconds (if they are frames,"
            " give --fps)"
        )
    elif fps is not None:
        warnings.append(f"{table.path}: has times of its own; the frame rate given is not used")
    return times * unit, _decimals(table, column) if unit == 1.0 else None, warnings


def _decimals(table: TextTable, column: int) -> int | None:
    """How many decimals a column is printed to; None where an exponent leaves it open."""
    (cells,) = plain_decimals(table.cells([column]), str(table.path))
    if any("E" in cell or "e" in cell for cell in cells):
        return None
    return max((len(cell.partition(".")[2]) for cell in cells), default=None)


def _tidy(table: TextTable, names: Sequence[str], fps: float | None) -> _File:
    """Read one row per stone and time, columns in any order."""
    missing = [name for name in ("x", "y") if name not in names]
    if missing:
        raise InputError(f"{table.path}: no column {', '.join(missing)}; needs stone, t, x, y")
    doubled = [name for name, n in Counter(names).items() if n > 1 and name]
    if doubled:
        raise InputError(f"{table.path}: two columns named {doubled[0]}")
    if _TIME.isdisjoint(names) and "frame" not in names:
        raise InputError(f"{table.path}: no column t; needs stone, t, x, y")
    clock = _clock_column(table, names, fps)
    wanted = {n: names.index(n) for n in ("x", "y", "seen", *_COMPANIONS) if n in names}
    values = _values(table, {clock, *wanted.values()})
    times, decimals, warnings = _times(table, values, clock, fps)
    stones = [stone.strip("\"'") for stone in table.cells([names.index("stone")])[0]]
    tracks = pd.DataFrame({"stone": stones, "t": times} | {n: values[k] for n, k in wanted.items()})
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
    return _File(tracks, decimals, angle_unit="rad", warnings=warnings)


def _without_header(table: TextTable, fps: float | None) -> _File:
    """Read ``t x y`` or ``t x1 y1 x2 y2``; with a frame rate also without the t."""
    width = table.width
    timeless = width % 2 == 0
    if timeless and fps is None:
        raise InputError(
            f"{table.path}: {width} columns without a header; needs t, x, y (and x, y of each"
            " further stone), or the frame rate (--fps) where there is no t"
        )
    values = _values(table, range(width))
    times, decimals, warnings = _times(table, values, None if timeless else 0, fps)
    _refuse_disorder(table, times)
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


def _to_si(path: Path, file: _File, length_unit: str, angle_unit: str | None) -> list[str]:
    """Convert a file's tracks to metres and continuous radians."""
    warnings: list[str] = []
    unit = length_unit
    if file.length_unit is not None and file.length_unit != length_unit:
        if length_unit != "m":
            raise InputError(
                f"{path}: x and y are in {file.length_unit} as the header says, not in"
                f" {length_unit}"
            )
        unit = file.length_unit
        warnings.append(f"{path}: x and y taken in {unit} as the header says")
    tracks = file.tracks
    with np.errstate(over="ignore"):
        for name in ("x", "y", "sd_x", "sd_y"):
            if name in tracks:
                tracks[name] = tracks[name] * LENGTH_UNITS[unit]
    if "theta" in tracks:
        chosen = angle_unit or file.angle_unit
        if chosen is None:
            chosen = "deg" if _spins_too_fast(tracks) else "rad"
            if chosen == "deg":
                warnings.append(
                    f"{path}: angles taken in degrees, they change too fast for radians"
                    " (--angle-unit to say otherwise)"
                )
        with np.errstate(over="ignore", invalid="ignore"):
            for name in ("theta", "sd_theta"):
                if name in tracks:
                    tracks[name] = tracks[name] * ANGLE_UNITS[chosen]
            for _, rows in tracks.groupby("stone", sort=False).groups.items():
                theta = tracks.loc[rows, "theta"].to_numpy(float, copy=True)
                known = np.isfinite(theta)
                theta[known] = np.unwrap(theta[known])
                tracks.loc[rows, "theta"] = theta
    return warnings


def _spins_too_fast(tracks: pd.DataFrame) -> bool:
    """Tell whether angles, read as radians, begin or change as only degrees would."""
    for _, rows in tracks.groupby("stone", sort=False):
        theta, t = rows["theta"].to_numpy(float), rows["t"].to_numpy(float)
        known = np.isfinite(theta)
        theta, t = theta[known], t[known]
        with np.errstate(all="ignore"):
            if len(theta) and abs(theta[0]) > 2 * np.pi + 0.01:
                return True
            # The median lets the jumps of a wrapped angle pass.
            if len(theta) > 2 and np.median(np.abs(np.diff(theta) / np.diff(t))) > FASTEST_SPIN:
                return True
    return False


def _refuse_shared_names(paths: Sequence[Path], files: Sequence[_File]) -> None:
    owner: dict[str, Path] = {}
    for path, file in zip(paths, files, strict=True):
        for stone in file.tracks["stone"].unique():
            if stone in owner:
                raise InputError(
                    f"{path}: two stones with one name, {stone}, which is in {owner[stone]} too;"
                    " rename one (the line above the header, or the file)"
                )
            owner[stone] = path


def _with_clock(
    table: pd.DataFrame, decimals: Sequence[int | None]
) -> tuple[pd.DataFrame, float | None]:
    """Give the rows the equal time steps that their printed times were rounded from."""
    t = table["t"].to_numpy(float)
    if not np.isfinite(t).all() or np.abs(t).max() > _LATEST:
        return table, None  # to be refused with its reason
    times, rank = np.unique(t, return_inverse=True)
    if len(times) < 2:
        return table, None
    printed = max((d for d in decimals if d is not None), default=None)
    count, start, step = uniform_steps(times)
    even = start + step * count
    off = float(np.abs(even - times).max())
    rounding = 0.75 * 10.0**-printed if printed is not None else 0.0
    explained = off < rounding < 0.3 * step
    uniform = explained or off < 0.05 * step
    if explained and off > 1e-6 * step:
        # Equal steps explain the printed times: the rounding goes.
        table = table.assign(t=even[rank])
    frame = table["frame"] if "frame" in table else pd.Series(np.nan, index=table.index)
    if frame.isna().any() and uniform:
        table = table.assign(frame=count[rank])
    elif frame.isna().any() and "frame" in table:
        table = table.drop(columns="frame")
    typical = step if uniform else float(np.median(np.diff(times)))
    return table, float(f"{1 / typical:.9g}")


def uniform_steps(times: Array) -> tuple[Array, float, float]:
    """Fit equal steps to increasing times, of which some may be missing.

    Parameters
    ----------
    times : ndarray, shape (n,)
        At least two times, s.

    Returns
    -------
    count : ndarray, shape (n,)
        Number of steps since the first time.
    start, step : float
        So that ``start + step * count`` fits best, s.
    """
    steps = np.diff(times)
    short = float(np.median(steps[steps < 1.5 * steps.min()]))
    count = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(steps / short), 1))])
    centred = count - count.mean()
    step = float((centred * (times - times.mean())).sum() / (centred**2).sum())
    return count, float(times.mean() - step * count.mean()), step


def _check_scale(table: pd.DataFrame, source: str) -> list[str]:
    """Refuse or warn about places and speeds that no stone has."""
    xy = table[["x", "y"]].to_numpy(float)
    far = float(np.abs(xy).max())
    if far > FARTHEST:
        raise InputError(
            f"{source}: places up to {far:.3g} m from the origin: probably the wrong length unit"
            f" (--length-unit: {', '.join(LENGTH_UNITS)})"
        )
    for stone, rows in table.groupby("stone", sort=False):
        speed, t = _top_speed(rows[["t", "x", "y"]].to_numpy(float))
        if speed > FASTEST:
            raise InputError(
                f"{source}: {stone} moves at {speed:.0f} m/s at t = {t:.3g} s: probably the wrong"
                f" length unit (--length-unit: {', '.join(LENGTH_UNITS)}), or a slipped mark"
            )
    extent = float(np.ptp(xy, axis=0).max())
    if len(xy) > 1 and extent < SMALLEST:
        return [
            f"{source}: all places lie within {1000 * extent:.2g} mm: nothing moves, or the wrong"
            " length unit"
        ]
    return []


def _top_speed(txy: Array, window: float = 0.1) -> tuple[float, float]:
    """Find the greatest mean speed over a window, s, and its time: noise hardly counts."""
    t, x, y = txy.T
    if len(t) < 2:
        return 0.0, float(t[0])
    ends = np.searchsorted(t, t + window * (1 - 1e-9))
    first = np.flatnonzero(ends < len(t))
    if len(first) == 0:
        first, ends = np.array([0]), np.array([len(t) - 1])
    last = ends[first] if len(ends) == len(t) else ends
    speeds = np.hypot(x[last] - x[first], y[last] - y[first]) / (t[last] - t[first])
    top = int(np.argmax(speeds))
    return float(speeds[top]), float(t[first[top]])
