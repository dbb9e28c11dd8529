"""Sightings of the stones, from a clip, pictures or tables of tracks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.data.errors import InputError
from curlshot.data.inputs import (
    IMAGE_SUFFIXES,
    SPREADSHEET,
    SPREADSHEETS,
    TABLE_SUFFIXES,
    find_inputs,
)
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import HOUSE, House, curling_size
from curlshot.work.film import check_size, disc_of, film
from curlshot.work.settings import Settings, refuse_clip_options

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.data.tracker import Imported
    from curlshot.data.tracks import Table
    from curlshot.vision.film.clip import Clip, Frame
    from curlshot.vision.optics.camera import Camera


@dataclass(frozen=True)
class Measured:
    """Sightings of the stones and where they come from.

    `repeats` has the times, s, of frames that were left out, for they repeat one before.
    """

    files: tuple[Path, ...]
    table: Table
    fps: float | None
    frames: int
    warnings: tuple[str, ...]
    clip: Clip | None = None
    cameras: tuple[Camera, ...] = ()
    house: House | None = None
    masses: Mapping[str, float] = field(default_factory=dict)
    repeats: Mapping[int, float] = field(default_factory=dict)

    @cached_property
    def sightings(self) -> pd.DataFrame:
        """The table as a DataFrame."""
        import pandas as pd

        return pd.DataFrame(self.table)


def measure(
    inputs: str | Path | Sequence[str | Path],
    settings: Settings = Settings(),
    progress: Progress = no_progress,
) -> Measured:
    """Sightings of every stone, from a clip, pictures or a table of tracks.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the input cannot be used; one line says why.
    """
    files = find_inputs(inputs)
    tables = [path.suffix.lower() in TABLE_SUFFIXES for path in files]
    if any(tables) and not settings.clip:
        if not all(tables):
            odd = files[tables.index(False)]
            raise InputError(f"{odd}: tables of tracks and pictures do not mix; give one kind")
        from curlshot.data.discs import refuse_no_discs

        refuse_clip_options(files[0], settings)
        table = _read(files, settings)
        source = ", ".join(map(str, files))
        refuse_no_discs(table.sightings, settings.radius, source, table.advice)
        return _imported(files, table, settings)
    return _look_at_clip(files, settings, progress)


def refuse_clips(files: Sequence[Path], command: str) -> None:
    """Refuse what is no table of tracks, and say which command takes it."""
    odd = [path for path in files if path.suffix.lower() not in TABLE_SUFFIXES]
    if odd:
        what = f"not a table of tracks; try curlshot {command}"
        what = SPREADSHEET if odd[0].suffix.lower() in SPREADSHEETS else what
        raise InputError(f"{odd[0]}: {what}")


def import_tables(files: tuple[Path, ...], settings: Settings) -> Measured:
    """Read tables of tracks."""
    return _imported(files, _read(files, settings), settings)


def _read(files: tuple[Path, ...], settings: Settings) -> Imported:
    from curlshot.data.tracker import read_table

    return read_table(
        files,
        length_unit=settings.length_unit,
        angle_unit=settings.angle_unit,
        fps=settings.fps,
        tab=settings.tab,
        names=settings.names,
        angles=settings.angles,
    )


def _imported(files: tuple[Path, ...], table: Imported, settings: Settings) -> Measured:
    return Measured(
        files,
        table.sightings,
        table.fps,
        table.sightings["t"].nunique(),
        table.warnings,
        house=HOUSE if curling_size(settings.radius) and not settings.no_house else None,
        masses=table.masses,
    )


def _look_at_clip(files: tuple[Path, ...], settings: Settings, progress: Progress) -> Measured:
    from curlshot.vision.association.watch import Watch
    from curlshot.vision.detection.stones import FOLLOWING, SEARCH
    from curlshot.vision.optics.camera import carried
    from curlshot.vision.optics.letterbox import in_whole
    from curlshot.vision.track import tracks_of

    alone = len(files) == 1 and files[0].suffix.lower() in IMAGE_SUFFIXES
    # A picture by itself has one chance.
    watch = Watch(disc_of(settings), SEARCH if alone else FOLLOWING)

    def look(frame: Frame, camera: Camera) -> None:
        if not watch.begun:
            check_size(settings.radius, camera)
        watch.look(frame, camera)

    seen = film(files, settings, progress, look)
    stones = tracks_of(watch, seen.cameras)
    clip, cameras = in_whole(seen.clip, seen.cameras)
    repeated = clip.repeated
    return Measured(
        files,
        stones.table,
        clip.fps,
        clip.passed,
        (*clip.warnings, *seen.warnings, *stones.warnings),
        clip,
        carried(cameras, repeated),
        seen.house,
        repeats={frame: t for frame, (t, _) in repeated.items()},
    )
