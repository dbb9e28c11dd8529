"""All files of a run: tables, estimates, the annotated clip, figures and the page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.config import CONFIG_FILE
from curlshot.data.files import write_text
from curlshot.data.messages import as_options
from curlshot.data.progress import Progress, no_progress
from curlshot.data.version import VERSION

if TYPE_CHECKING:
    from collections.abc import Sequence

    from curlshot.outcome import Run

WRITTEN = (
    "tracks.csv", "camera.csv", "results.json", "simulation.csv", "report.html", "overlay.mp4",
    "figures", "tables", "posterior.csv", "ensemble.json", CONFIG_FILE,
)  # fmt: skip
"""All that a run may write into its folder."""


def left_by_earlier_run(folder: Path, inputs: Sequence[Path]) -> tuple[str, ...]:
    """Return names of what an earlier run left in `folder`, without the inputs and their camera."""
    kept = {path.name for path in inputs if path.resolve().parent == folder.resolve()}
    if "tracks.csv" in kept:
        kept.add("camera.csv")
    return tuple(name for name in WRITTEN if name not in kept)


def write_run(stage: Path, run: Run, progress: Progress = no_progress) -> None:
    """Write every file of a run into a folder that is there.

    Parameters
    ----------
    stage : Path
        The folder.
    run : Run
        With its measurement.
    progress : callable
        Called as the work goes on.
    """
    from curlshot.data.tracks import write_table, write_tracks
    from curlshot.report.command_line import command_of
    from curlshot.report.page import write_report
    from curlshot.report.provenance import Provenance, sources

    measured, config = run.measurement, run.config
    results = replace(run.results, warnings=tuple(map(as_options, run.results.warnings)))
    assert measured is not None, "a loaded run has its files already"
    write_tracks(run.tracks, stage / "tracks.csv", measured.table)
    write_table(run.simulations, stage / "simulation.csv")
    write_estimates(stage, run)
    if run.cameras is not None:
        write_table(run.cameras, stage / "camera.csv")
    overlay: Path | None = None
    clip_start = 0.0
    if measured.clip is not None and config.report.overlay:
        from curlshot.report.overlay import write_overlay

        overlay = stage / "overlay.mp4"
        clip_start = write_overlay(
            measured.clip,
            measured.cameras,
            run.tracks,
            results.collisions,
            overlay,
            rings=None if run.house is None else run.house.painted,
            radius=config.stones.radius,
            progress=progress,
        )
    progress("report", 0, 1)
    write_report(
        stage,
        results=results,
        tracks=run.tracks,
        simulations=run.simulated,
        cameras=run.cameras,
        clip_name=measured.files[0].name,
        overlay=overlay,
        clip_start=clip_start,
        house=run.house,
        residuals=run.residuals,
        posterior=run.posterior,
        ensemble=run.ensemble,
        unit=run.unit,
        provenance=Provenance(VERSION, command_of(measured.files, config), sources(measured.files)),
    )
    progress("report", 1, 1)


def write_estimates(stage: Path, run: Run) -> None:
    """Write the estimates of a run, the shots that may have been it, and changed settings."""
    from curlshot.data.results_file import write_results
    from curlshot.data.tracks import write_table
    from curlshot.physics.prediction.ensemble import write_ensemble

    write_results(run.results, stage / "results.json")
    if run.posterior is not None:
        write_table(run.posterior, stage / "posterior.csv")
    if run.ensemble is not None:
        write_ensemble(run.ensemble, stage / "ensemble.json")
    if run.config.changed():
        # Paths in a file are relative to it, and those of the settings to the current folder.
        write_text(stage / CONFIG_FILE, run.config.absolute().to_toml())
