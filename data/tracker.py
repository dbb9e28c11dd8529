"""Tracks from files: projects and exports of Tracker (Open Source Physics), spreadsheets, our own.

Tracker's layouts follow its source (versions 4 to 6.3): an optional line ``#multi:``, a
line with the names of the tracks, a header whose first column is t, one block of columns
per track. Its θ, ω and α belong to the place about the origin, not to the spin, and its
velocities can be stale: both are left out. Projects are read by `curlshot.data.project`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from curlshot.data.angles import FASTEST_SPIN, attach, read_angles, spin_rate
from curlshot.data.clock import with_clock
from curlshot.data.columns import UNIT_NOT_SAID, UNIT_SAID
from curlshot.data.discs import moment, top_speed
from curlshot.data.errors import InputError
from curlshot.data.export import read_parquet
from curlshot.data.layouts import read_layout
from curlshot.data.project import is_project, read_project
from curlshot.data.read_back import as_measured
from curlshot.data.stone_names import chosen, named_by_file, refuse_shared_names
from curlshot.data.track_file import TrackFile
from curlshot.data.tracks import ANGLES, EARLIER_NAMES, LENGTHS, MEASURED_AS, check_detections
from curlshot.data.units import (
    ANGLE_UNITS,
    LENGTH_UNITS,
    abbreviated,
    check_units,
    unit_of_angles,
    unit_of_lengths,
)

FASTEST = 20.0
"""m/s; a stone is thrown at 2 to 4."""

FARTHEST = 100.0
"""m from the origin; a sheet is 45 long."""

SMALLEST = 0.001
"""m; what moves less than this in the whole table does not move."""

SLOWEST_RATE = 1.0
"""1/s; a glide of some seconds is not told by fewer rows."""

SMALLEST_STEP = 0.01
"""m; by less from row to row places marked by hand may scatter while a stone lies still."""

LONGEST_GLIDE = 60.0
"""s; a stone comes to rest within half of it. What takes longer is in milliseconds."""


@dataclass(frozen=True)
class Imported:
    """Tracks that were read from files.

    Attributes
    ----------
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`; m, s, rad; stones are named as in the files.
    warnings : tuple of str
        What was decided on evidence, or left out.
    fps : float or None
        Rate of the rows, 1/s; None where there is only one time.
    masses : mapping
        Masses by stone, as a project has them; empty where none, or not all, were set.
    advice : str
        What may be wrong with the lengths if they make no sense.
    """

    detections: pd.DataFrame
    warnings: tuple[str, ...]
    fps: float | None
    masses: Mapping[str, float] = field(default_factory=dict)
    advice: str = UNIT_NOT_SAID


def read_table(
    paths: Sequence[Path],
    *,
    length_unit: str | None = None,
    angle_unit: str | None = None,
    fps: float | None = None,
    tab: str | None = None,
    names: Mapping[str, str] | None = None,
    angles: Mapping[str, Path] | None = None,
) -> Imported:
    """Read tracks from text tables of any layout and dialect, and from Tracker's projects.

    Parameters
    ----------
    paths : sequence of Path
        One file with all stones, or several, each with its own.
    length_unit : {"m", "cm", "mm", "in", "ft", "yd"}, optional
        Unit of x and y, where the file does not say; m if not given.
    angle_unit : {"rad", "deg"}, optional
        Unit of the stones' own angles. If not given, radians, or degrees where radians
        would make a stone spin absurdly fast (a warning says so).
    fps : float, optional
        Rate of the rows of tables without a time column, 1/s.
    tab : str, optional
        Which tab of a project with several.
    names : mapping, optional
        Names of stones to names of tracks in the files; tracks that are not named are left
        out. If not given, every track is a stone of the same name.
    angles : mapping, optional
        Files with the angles of stones (see `curlshot.data.angles.read_angles`).

    Returns
    -------
    Imported
        Checked detections.

    Raises
    ------
    InputError
        One line that says what makes no sense, where, and what to do.

    Notes
    -----
    Layouts: Tracker's; ``stone, t, x, y`` with one row per stone and time, columns in any
    order; wide tables with pairs such as ``x1, y1`` or ``red_x, red_y``; ``t x y`` or
    ``t x1 y1 x2 y2`` without header. Tracker prints times to the millisecond; where
    equal steps explain the printed times, the equal steps are used.
    """
    check_units(length_unit, angle_unit, fps)
    if not paths:
        raise InputError("no table of tracks given")
    files = []
    for path in paths:
        if is_project(path):
            files.append(read_project(path, tab).file())
        elif path.suffix.lower() == ".parquet":
            files.append(_checked_parquet(path))
        else:
            files.append(read_layout(path, fps))
    if tab is not None and not any(map(is_project, paths)):
        raise InputError(f"{paths[0]}: no Tracker project, which alone has tabs (`tab`)")
    warnings = [text for file in files for text in file.warnings]
    files, notes = named_by_file(paths, files)
    warnings += notes
    if names:
        paths, files = chosen(paths, files, names)
    if length_unit is None:
        _refuse_partly(paths, files)
    for path, file in zip(paths, files, strict=True):
        warnings += _to_si(path, file, length_unit, angle_unit)
        file.tracks, notes = as_measured(file.tracks, str(path))
        warnings += notes
        if file.tracks.empty:
            raise InputError(f"{path}: no row with a place")
    source = ", ".join(str(path) for path in paths)
    refuse_shared_names(paths, files)
    table = pd.concat([file.tracks for file in files], ignore_index=True)
    table, rate = with_clock(table, [file.decimals for file in files])
    table = check_detections(table, source)
    said = all(abbreviated(file.length_unit or "") in LENGTH_UNITS for file in files)
    advice = UNIT_SAID if said else UNIT_NOT_SAID
    warnings += _check_scale(table, source, advice) + _check_rate(rate, table, source)
    for stone, path in (angles or {}).items():
        track = read_angles(path, angle_unit, fps)
        table, notes = attach(table, stone, track, str(path))
        warnings += [*track.warnings, *notes]
    masses = {stone: mass for file in files for stone, mass in file.masses.items()}
    masses, notes = _set_masses(masses, set(table["stone"]), source)
    return Imported(table, tuple(dict.fromkeys(warnings + notes)), rate, masses, advice)


def _checked_parquet(path: Path) -> TrackFile:
    table = read_parquet(path).rename(columns=EARLIER_NAMES)
    tracks = check_detections(table, str(path))
    told = [name for name in ("seen", *MEASURED_AS) if name in table]
    beside = table[told].apply(pd.to_numeric, errors="coerce")
    beside = beside.assign(stone=table["stone"].astype(str), t=pd.to_numeric(table["t"]))
    return TrackFile(tracks.merge(beside, how="left"), angle_unit="rad", continuous=True)


def _set_masses(
    masses: Mapping[str, float], stones: set[str], source: str
) -> tuple[dict[str, float], list[str]]:
    """Keep a project's masses only if someone set them all: Tracker gives 1 to each."""
    known = {stone: mass for stone, mass in masses.items() if stone in stones}
    if set(known) != stones or len(set(known.values())) == 1:
        return {}, []
    untouched = sorted(stone for stone, mass in known.items() if mass == 1)
    if untouched:
        return {}, [
            f"{source}: the mass of {', '.join(untouched)} is Tracker's default, 1; all masses"
            " are assumed equal (`masses` overrides this)"
        ]
    return known, []


def _refuse_partly(paths: Sequence[Path], files: Sequence[TrackFile]) -> None:
    """Refuse a length unit in some files and none in others, if that is not the usual one."""
    units = (abbreviated(file.length_unit or "") for file in files)
    told = dict(zip(paths, units, strict=True))
    said = next((path for path, unit in told.items() if unit and unit != "m"), None)
    silent = next((path for path, unit in told.items() if not unit), None)
    if said is not None and silent is not None:
        raise InputError(
            f"{silent}: has no length unit, but {said} is in {told[said]}; write it in the header"
        )


def _to_si(
    path: Path, file: TrackFile, length_unit: str | None, angle_unit: str | None
) -> list[str]:
    """Convert a file's tracks to metres and continuous radians."""
    warnings: list[str] = []
    project = is_project(path)
    teller = "project" if project else "header"
    unit = unit_of_lengths(file.length_unit, length_unit, str(path), teller)
    if unit != (length_unit or "m") and not project:
        warnings.append(f"{path}: length unit {unit}, as the header says")
    tracks = file.tracks
    with np.errstate(over="ignore"):
        for name in LENGTHS:
            if name in tracks:
                tracks[name] = tracks[name] * LENGTH_UNITS[unit]
    if "theta" in tracks:
        chosen = unit_of_angles(file.angle_unit, angle_unit, str(path))
        if chosen is None:
            chosen = "deg" if _spins_too_fast(tracks, file.continuous) else "rad"
            if chosen == "deg":
                warnings.append(
                    f"{path}: angles read in degrees, since they change too fast for radians"
                    " (`angle_unit` overrides this)"
                )
        for name in ANGLES:
            if name in tracks:
                tracks[name] = tracks[name] * ANGLE_UNITS[chosen]
        if not file.continuous:
            tracks["theta"] = tracks.groupby("stone")["theta"].transform(_unwrapped)
    return warnings


def _unwrapped(theta: pd.Series[float]) -> pd.Series[float]:
    """Make angles continuous that stay within one turn, and so may have been wrapped."""
    known = theta[np.isfinite(theta)]
    with np.errstate(over="ignore"):
        if known.empty or np.ptp(known) > 2 * np.pi + 1e-6:
            return theta
    return pd.Series(np.unwrap(known), known.index).reindex(theta.index)


def _spins_too_fast(tracks: pd.DataFrame, continuous: bool) -> bool:
    """Tell whether angles, read as radians, begin or change as only degrees would.

    Those that are continuous may begin anywhere.
    """
    for _, rows in tracks.groupby("stone", sort=False):
        theta, t = rows["theta"].to_numpy(float), rows["t"].to_numpy(float)
        known = np.isfinite(theta)
        theta, t = theta[known], t[known]
        with np.errstate(all="ignore"):
            if not continuous and len(theta) and abs(theta[0]) > 2 * np.pi + 0.01:
                return True
        if spin_rate(t, theta) > FASTEST_SPIN:
            return True
    return False


def _check_scale(table: pd.DataFrame, source: str, advice: str) -> list[str]:
    """Refuse or warn about places and speeds that no stone has."""
    xy = table[["x", "y"]].to_numpy(float)
    far = float(np.abs(xy).max())
    if far > FARTHEST:
        raise InputError(f"{source}: places up to {far:.3g} m from the origin: probably {advice}")
    for stone, rows in table.groupby("stone", sort=False):
        speed, t = top_speed(rows["t"].to_numpy(float), rows[["x", "y"]].to_numpy(float))
        if speed > FASTEST:
            raise InputError(
                f"{source}: {stone} moves at {speed:.0f} m/s at t = {moment(t)}: probably"
                f" {advice}, a slipped mark, or two names exchanged"
            )
    extent = float(np.ptp(xy, axis=0).max())
    if len(xy) > 1 and extent < SMALLEST:
        return [
            f"{source}: all places lie within {1000 * extent:.2g} mm: nothing moves, or the wrong"
            " length unit"
        ]
    return []


def _check_rate(rate: float | None, table: pd.DataFrame, source: str) -> list[str]:
    """Refuse, or warn of, rows so far apart in time that no motion shows.

    Raises
    ------
    InputError
        Where a stone is on its way from each row to the next for longer than any stone glides.
    """
    if rate is None or rate >= SLOWEST_RATE:
        return []
    for stone, rows in table.groupby("stone", sort=False):
        t, way = rows["t"].to_numpy(float), np.diff(rows[["x", "y"]].to_numpy(float), axis=0)
        rests = np.flatnonzero(np.hypot(*way.T) < SMALLEST_STEP)
        longest = float((t[np.append(rests, -1)] - t[np.insert(rests + 1, 0, 0)]).max())
        if longest > LONGEST_GLIDE:
            raise InputError(
                f"{source}: rows are {1 / rate:.3g} s apart, and {stone} moves for {longest:.0f} s"
                " without a rest: for milliseconds name the column t (ms)"
            )
    return [f"{source}: rows are {1 / rate:.3g} s apart; for milliseconds name the column t (ms)"]
