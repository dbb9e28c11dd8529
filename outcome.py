"""The outcome of a run: tables, estimates, pictures and files."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.config import Config
from curlshot.data.errors import InputError
from curlshot.data.files import check_folder, staged
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import House

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.data.measurement import Measurement
    from curlshot.data.results import Results
    from curlshot.physics.prediction.ensemble import Ensemble


@dataclass(frozen=True)
class Run:
    """The outcome of a run.

    Attributes
    ----------
    tracks : DataFrame
        As ``tracks.csv``.
    cameras : DataFrame or None
        As ``camera.csv``; None for imported tracks.
    results : curlshot.data.results.Results
        Estimates with errors, as ``results.json``.
    simulations : DataFrame
        As ``simulation.csv``: one column ``model``, else as the tracks.
    out : Path or None
        Where the files are.
    house : House or None
        The rings; None where the scene has no house.
    posterior : DataFrame or None
        As ``posterior.csv``: draws of restitution and frictions, where they were asked for.
    ensemble : Ensemble or None
        As ``ensemble.json``: shots that may have been this one; None where nothing moves.
    measurement : Measurement or None
        What was measured before any physics; None for a run that was loaded.
    config : Config
        The settings of the run.
    """

    tracks: pd.DataFrame
    cameras: pd.DataFrame | None
    results: Results
    simulations: pd.DataFrame
    out: Path | None = None
    house: House | None = None
    posterior: pd.DataFrame | None = None
    ensemble: Ensemble | None = None
    measurement: Measurement | None = field(default=None, repr=False, compare=False)
    config: Config = field(default_factory=Config)

    def write(self, folder: str | Path, progress: Progress = no_progress) -> Run:
        """Write all files of the run into a folder, whole or not at all.

        Returns
        -------
        Run
            The same, with `out`.

        Raises
        ------
        curlshot.data.errors.InputError
            A folder that cannot be written, or one that holds an input that would be lost.
        """
        from curlshot.report.write import WRITTEN, write_run

        path = check_folder(folder)
        if self.measurement is None:
            raise InputError(f"{path}: a loaded run is not written again; copy its folder")
        own = {path.resolve() / name for name in WRITTEN}
        lost = [file for file in self.measurement.files if file.resolve() in own]
        if lost:
            raise InputError(f"{lost[0]}: would be overwritten; name another folder")
        with staged(path, replaces=WRITTEN) as stage:
            write_run(stage, self, progress)
        return replace(self, out=path)
