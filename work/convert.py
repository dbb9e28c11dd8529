"""Tracks in another form: tables, and projects of Tracker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.data.errors import CurlshotError, InputError
from curlshot.data.files import relative_path
from curlshot.data.inputs import find_inputs
from curlshot.work.measure import Measured, import_tables, refuse_clips
from curlshot.work.settings import Settings

if TYPE_CHECKING:
    import pandas as pd


def convert(
    inputs: str | Path | Sequence[str | Path],
    out: str | Path,
    settings: Settings = Settings(),
    over: str | Path | None = None,
) -> Measured:
    """Write tracks in another form, by the ending of `out`: .txt, .csv, .parquet, .trk or .trz.

    Parameters
    ----------
    inputs : str or Path, or sequence of them
        Tables of tracks and projects. Of a run's ``tracks.csv`` a project also takes the
        ``simulation.csv`` and, with `over`, the ``camera.csv`` beside it.
    out : str or Path
        File to write.
    settings : Settings
        Units, names and so on of the tables.
    over : str or Path, optional
        The clip that a project shows the tracks over; a .trz holds it.

    Returns
    -------
    Measured
        What was written, with warnings.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the input cannot be used, or there is no such form; then nothing is written.
    """
    from curlshot.data.export import PROJECTS, WRITERS, check_target

    path = Path(out)
    files = find_inputs(inputs)
    check_target(path, files)
    refuse_clips(files, "track")
    ending = path.suffix.lower()
    if over is not None and ending not in PROJECTS:
        raise InputError(f"{path}: only a .trk or .trz shows tracks over a clip (--over)")
    measured = import_tables(files, settings)
    if ending in PROJECTS:
        return _write_project(measured, path, over)
    WRITERS[ending](measured.sightings, path)
    if ending == ".txt" and measured.sightings["team"].any():
        note = f"{path}: Tracker's text has no column for teams; they are not in it"
        return replace(measured, warnings=(*measured.warnings, note))
    return measured


def convert_each(
    inputs: str | Path | Sequence[str | Path], out: str | Path, settings: Settings = Settings()
) -> dict[Path, Measured | CurlshotError]:
    """Write each of many tables into a file of its own, of the same name with another ending.

    Parameters
    ----------
    inputs : str or Path, or sequence of them
        Tables of tracks and projects.
    out : str or Path
        An ending such as ``.csv``, for files beside the inputs, or ``FOLDER/.csv``.
    settings : Settings
        Units, names and so on of the tables.

    Returns
    -------
    dict
        By the file to be written: what was written, or why it could not be.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        No input, or two that would be written into one file; then nothing is written.
    """
    target = Path(out)
    files = find_inputs(inputs)
    folder = None if target.parent == Path() else target.parent
    targets = [(folder or file.parent) / f"{file.stem}{target.name}" for file in files]
    doubled = [path for path in targets if targets.count(path) > 1]
    if doubled:
        raise InputError(f"{doubled[0]}: two of the inputs would be written into this one file")
    done: dict[Path, Measured | CurlshotError] = {}
    for file, path in zip(files, targets, strict=True):
        try:
            done[path] = convert([file], path, settings)
        except CurlshotError as refusal:
            done[path] = refusal
    return done


def _read_simulations(path: Path) -> dict[str, pd.DataFrame]:
    """Read a ``simulation.csv``, model by model."""
    import pandas as pd

    try:
        table = pd.read_csv(path)
        table = table.astype({"t": float, "x": float, "y": float, "stone": str})
        return {str(model): rows for model, rows in table.groupby("model")}
    except (ValueError, KeyError):
        raise InputError(f"{path}: not a simulation.csv of this program") from None


def _write_project(measured: Measured, path: Path, over: str | Path | None) -> Measured:
    """Write a project with what a run has left beside its tracks."""
    from curlshot.data.trk_write import plain_view, project_xml, write_trk, write_trz

    sightings, beside = measured.sightings, measured.files[0].parent
    simulated = beside / "simulation.csv"
    simulations = {}
    if measured.files[0].name == "tracks.csv" and simulated.is_file():
        simulations = _read_simulations(simulated)
    packed = path.suffix.lower() == ".trz"
    inside: dict[str, Path] = {}
    if over is None:
        view = plain_view(sightings)
        marks = view.coordinates.pixels(sightings["frame"], sightings[["x", "y"]].to_numpy(float))
    else:
        from curlshot.vision.film.clip import open_clip
        from curlshot.vision.optics.tracker_view import view_over

        clip = open_clip(find_inputs([over]))
        if packed:
            inside = {f"videos/{file.name}": file for file in clip.files}
        video = tuple(inside) or tuple(relative_path(file, path.parent) for file in clip.files)
        view, marks, off = view_over(clip, beside / "camera.csv", sightings, video)
        note = (
            f"{path}: Tracker knows no perspective; at the 12-ft ring it shows places up to"
            f" {100 * off:.1f} cm off (exact ones are in the file, and read back from it)"
        )
        measured = replace(measured, warnings=(*measured.warnings, note))
    project = project_xml(sightings, view, marks, simulations)
    if packed:
        write_trz(project, path, inside)
    else:
        write_trk(project, path)
    return measured
