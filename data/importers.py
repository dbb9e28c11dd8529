"""Tables of tracks and Tracker projects, read into one form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from curlshot.data.errors import InputError
from curlshot.data.inputs import SPREADSHEET, SPREADSHEETS, TABLE_SUFFIXES
from curlshot.data.measurement import Measurement
from curlshot.data.sheet import HOUSE, STONE, curling_size


def are_tables(files: Sequence[Path]) -> bool:
    """Return whether files are tables of tracks or projects.

    Raises
    ------
    InputError
        Where tables and pictures are mixed.
    """
    tables = [path.suffix.lower() in TABLE_SUFFIXES for path in files]
    if any(tables) and not all(tables):
        odd = files[tables.index(False)]
        raise InputError(f"{odd}: tables of tracks and pictures do not mix; give one kind")
    return any(tables)


def refuse_clips(files: Sequence[Path], command: str) -> None:
    """Refuse what is no table of tracks, and name the command that takes it."""
    odd = [path for path in files if path.suffix.lower() not in TABLE_SUFFIXES]
    if odd:
        what = f"not a table of tracks; try `{command}`"
        what = SPREADSHEET if odd[0].suffix.lower() in SPREADSHEETS else what
        raise InputError(f"{odd[0]}: {what}")


def import_tracks(
    files: Sequence[Path],
    *,
    radius: float = STONE.radius,
    fps: float | None = None,
    tab: str | None = None,
    length_unit: str | None = None,
    angle_unit: str | None = None,
    names: Mapping[str, str] | None = None,
    angles: Mapping[str, Path] | None = None,
    no_house: bool = False,
    check_discs: bool = True,
) -> Measurement:
    """Read tables of tracks.

    Parameters
    ----------
    files : sequence of Path
        Tables or Tracker projects of one shot.
    radius : float
        Radius of the discs, m.
    fps, tab, length_unit, angle_unit, names, angles, no_house
        As in `curlshot.config.VideoConfig` and `curlshot.config.TablesConfig`.
    check_discs : bool
        Whether tracks that cannot be of discs of this radius are refused.

    Raises
    ------
    InputError
        A file that cannot be read as a table of tracks; one line says why.
    """
    from curlshot.data.discs import refuse_no_discs
    from curlshot.data.tracker import read_table

    table = read_table(
        files,
        length_unit=length_unit,
        angle_unit=angle_unit,
        fps=fps,
        tab=tab,
        names=names or {},
        angles=angles or {},
    )
    if check_discs:
        source = ", ".join(map(str, files))
        refuse_no_discs(table.detections, radius, source, table.advice)
    return Measurement(
        tuple(files),
        table.detections,
        table.fps,
        table.detections["t"].nunique(),
        table.warnings,
        house=HOUSE if curling_size(radius) and not no_house else None,
        masses=table.masses,
    )
