"""Tracks in another form: tables, and projects of Tracker."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from curlshot.data.errors import InputError
from curlshot.data.importers import refuse_clips
from curlshot.data.measurement import Measurement

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.data.trk_write import View


@dataclass(frozen=True)
class Projected:
    """Tracks as a project shows them over a clip.

    Attributes
    ----------
    view : View
        The clip, with the camera as Tracker's coordinate system.
    marks : ndarray, shape (n, 2)
        Each place in the frame, Tracker's pixels.
    offset : float
        How far off Tracker shows places at the 12-ft ring, m, at worst.
    packed : mapping of str to Path
        Files that a .trz holds, by their names in it.
    """

    view: View
    marks: Any
    offset: float
    packed: Mapping[str, Path] = field(default_factory=dict)


def check_conversion(files: Sequence[Path], path: Path, over: bool) -> None:
    """Refuse a form that is none, an input that is no table, and a clip behind a table."""
    from curlshot.data.export import PROJECTS, check_target

    check_target(path, files)
    refuse_clips(files, "track")
    if over and path.suffix.lower() not in PROJECTS:
        raise InputError(f"{path}: only a .trk or .trz shows tracks over a clip (`over`)")


def write_converted(
    measured: Measurement, path: Path, projected: Projected | None = None
) -> Measurement:
    """Write tracks in the form that the ending of a path names.

    Parameters
    ----------
    measured : Measurement
        The tracks.
    path : Path
        Ends with .txt, .csv, .parquet, .trk or .trz.
    projected : Projected, optional
        The tracks over a clip, for a project.

    Returns
    -------
    Measurement
        What was written, with warnings.
    """
    from curlshot.data.export import PROJECTS, WRITERS

    ending = path.suffix.lower()
    if ending in PROJECTS:
        return _write_project(measured, path, projected)
    WRITERS[ending](measured.detections, path)
    if ending == ".txt" and measured.detections["team"].any():
        note = f"{path}: Tracker's text has no column for teams; they are not in it"
        return replace(measured, warnings=(*measured.warnings, note))
    return measured


def targets_of(files: Sequence[Path], out: str | Path) -> list[Path]:
    """Return a file for each of many tables, of the same name with another ending.

    Parameters
    ----------
    files : sequence of Path
        The tables.
    out : str or Path
        An ending such as ``.csv``, for files beside the inputs, or ``FOLDER/.csv``.

    Raises
    ------
    InputError
        Two tables that would be written into one file.
    """
    target = Path(out)
    folder = None if target.parent == Path() else target.parent
    targets = [(folder or file.parent) / f"{file.stem}{target.name}" for file in files]
    doubled = [path for path in targets if targets.count(path) > 1]
    if doubled:
        raise InputError(f"{doubled[0]}: two of the inputs would be written into this one file")
    return targets


def _read_simulations(path: Path) -> dict[str, pd.DataFrame]:
    """Read a ``simulation.csv``, model by model."""
    import pandas as pd

    try:
        table = pd.read_csv(path)
        table = table.astype({"t": float, "x": float, "y": float, "stone": str})
        return {str(model): rows for model, rows in table.groupby("model")}
    except (ValueError, KeyError):
        raise InputError(f"{path}: not a simulation.csv of this program") from None


def _write_project(measured: Measurement, path: Path, projected: Projected | None) -> Measurement:
    """Write a project with what a run has left beside its tracks."""
    from curlshot.data.trk_write import plain_view, project_xml, write_trk, write_trz

    detections, beside = measured.detections, measured.files[0].parent
    simulated = beside / "simulation.csv"
    simulations = {}
    if measured.files[0].name == "tracks.csv" and simulated.is_file():
        simulations = _read_simulations(simulated)
    if projected is None:
        view = plain_view(detections)
        places = detections[["x", "y"]].to_numpy(float)
        projected = Projected(view, view.coordinates.pixels(detections["frame"], places), 0.0)
    else:
        note = (
            f"{path}: Tracker has no perspective; at the 12-ft ring its places are up to"
            f" {100 * projected.offset:.1f} cm wrong (the file also holds the exact ones, which"
            " are read back)"
        )
        measured = replace(measured, warnings=(*measured.warnings, note))
    project = project_xml(detections, projected.view, projected.marks, simulations)
    if path.suffix.lower() == ".trz":
        write_trz(project, path, projected.packed)
    else:
        write_trk(project, path)
    return measured
