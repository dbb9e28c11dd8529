"""The main path: from a clip, or tables of tracks, to restitution, friction and simulations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from curlshot.config import Config, measures_clip, refuse_clip_settings, with_settings
from curlshot.data.arguments import checked_path, checked_paths
from curlshot.data.convert import check_conversion, write_converted
from curlshot.data.errors import SceneError
from curlshot.data.importers import are_tables, import_tracks
from curlshot.data.inputs import find_inputs, sample_clip
from curlshot.data.measurement import Measurement
from curlshot.data.progress import Progress, no_progress
from curlshot.outcome import Run, check_target

Inputs = str | Path | Sequence[str | Path]
"""A video, pictures (files, a folder or a glob), or tables of tracks."""


def run(
    inputs: Inputs = (),
    out: str | Path | None = None,
    config: Config = Config(),
    progress: Progress = no_progress,
    **settings: Any,
) -> Run:
    """Measure a shot: from a clip or tracks to e, μ, simulations and a report.

    Parameters
    ----------
    inputs : str or Path, or sequence of them
        A video, pictures (files, a folder or a glob), or tables of tracks; the bundled
        sample if none.
    out : str or Path, optional
        Folder for the files of the run; nothing is written without it.
    config : Config
        What is known of the input.
    progress : callable
        Called as the work goes on.
    **settings
        Single settings in place of those of `config`, as for `Config.replace`.

    Returns
    -------
    Run
        Tracks, cameras, estimates and simulations.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the input cannot be used; then nothing is written.

    Examples
    --------
    >>> import curlshot
    >>> shot = curlshot.Shot((curlshot.StoneStart("A", 0.5, 1.0),))
    >>> curlshot.simulate(shot).sample([0.0, 0.1, 0.2]).to_csv("still.csv")
    >>> print(curlshot.run("still.csv").restitution)
    — (no stone moves: restitution and friction are not identifiable)
    """
    config = with_settings(config, settings)
    files = find_inputs(checked_paths("inputs", inputs) or sample_clip())
    if out is not None:
        check_target(out, files)  # before the work, not after
    measured = measure(files, config, progress)
    done = analyse(measured, config, progress)
    return done if out is None else done.report(out, progress)


def convert(
    inputs: Inputs,
    out: str | Path,
    config: Config = Config(),
    over: str | Path | None = None,
    **settings: Any,
) -> Measurement:
    """Write tracks in another form, by the ending of `out`: .txt, .csv, .parquet, .trk or .trz.

    Parameters
    ----------
    inputs : str or Path, or sequence of them
        Tables of tracks and projects. Of a run's ``tracks.csv`` a project also takes the
        ``simulation.csv`` and, with `over`, the ``camera.csv`` beside it.
    out : str or Path
        File to write.
    config, **settings
        As for `run`: units, names and so on of the tables.
    over : str or Path, optional
        The clip that a project shows the tracks over; a .trz holds it.

    Returns
    -------
    Measurement
        What was written, with warnings.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the input cannot be used, or there is no such form; then nothing is written.

    Examples
    --------
    >>> import curlshot
    >>> with open("tracks.csv", "w") as file:
    ...     print("stone t x y", "A 0.0 0.5 1.0", "A 0.1 0.5 0.9", sep=chr(10), file=file)
    >>> curlshot.convert("tracks.csv", "tracks.txt").frames
    2
    """
    config = with_settings(config, settings)
    files, path = find_inputs(checked_paths("inputs", inputs)), checked_path("out", out)
    check_conversion(files, path, over is not None)
    measured = _import(files, config, check_discs=False)
    if over is None:
        return write_converted(measured, path)
    from curlshot.vision.optics.tracker_view import projected

    return write_converted(
        measured, path, projected(measured, find_inputs([checked_path("over", over)]), path)
    )


def measure(
    inputs: Inputs,
    config: Config = Config(),
    progress: Progress = no_progress,
) -> Measurement:
    """Measure every stone in every frame of a clip, or read tables of tracks.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the input cannot be used; one line says why.
    """
    files = find_inputs(inputs)
    if are_tables(files) and not measures_clip(files, config):
        refuse_clip_settings(files[0], config)
        return _import(files, config)
    from curlshot.vision.measure import measure_clip

    return measure_clip(files, config, progress)


def _import(files: tuple[Path, ...], config: Config, check_discs: bool = True) -> Measurement:
    """Read tables of tracks as the configuration says."""
    tables, video, radius = config.tables, config.video, config.stones.radius
    return import_tracks(
        files, radius=radius, fps=video.fps, tab=video.tab, check_discs=check_discs, **vars(tables)
    )


def analyse(
    measured: Measurement, config: Config = Config(), progress: Progress = no_progress
) -> Run:
    """Estimate, smooth, replay and predict a measured shot; writes nothing.

    Raises
    ------
    curlshot.data.errors.SceneError
        Where no stone was found.
    curlshot.data.errors.InputError
        Masses of stones that are not there, or of some only.
    """
    import numpy as np
    import pandas as pd

    from curlshot.data.tracks import simulation_table, teams, with_measured
    from curlshot.physics import steps
    from curlshot.physics.cautions import cautions
    from curlshot.physics.estimate import estimate
    from curlshot.physics.kalman import smooth
    from curlshot.physics.local_fit.hit_detection import detect_hits
    from curlshot.physics.posterior import NO_SAMPLES, sample_posterior
    from curlshot.physics.prediction.forecast import predict
    from curlshot.physics.prediction.replay import simulate_measured
    from curlshot.physics.prediction.throws import along_sheet, first_hit

    detections, radius = measured.detections, config.stones.radius
    if detections.empty:
        raise SceneError(f"{measured.files[0]}: no stone was found; {_way_out(config)}")
    progress("physics", 0, 1)
    stones = list(detections["stone"].unique())
    masses = steps.check_masses(config.stones.masses, stones) or measured.masses or None

    contacts = detect_hits(detections, radius)
    fit = estimate(detections, contacts, radius=radius, masses=masses)
    hits = steps.times_of_hits(contacts, fit.collisions)
    tracks = smooth(detections, hits, radius=radius, masses=masses, duplicates=measured.duplicates)
    replay = simulate_measured(tracks, fit, radius=radius, masses=masses)
    laws = steps.laws_to_assume(radius, config.physics.restitution, config.physics.friction)
    predictions = predict(detections, tracks, fit, radius=radius, masses=masses, laws=laws)
    samples = sample_posterior(fit, config.physics.samples, np.random.default_rng(0))

    # A clip shows the house; tables may have their origin anywhere.
    placed = measured.clip is None and measured.house is not None
    sheet = not placed or along_sheet(tracks, first_hit(fit.collisions), radius)
    house = measured.house if sheet else None
    team_of = teams(tracks)
    warnings = (
        *measured.warnings,
        *fit.warnings,
        *replay.warnings,
        *((NO_SAMPLES,) if config.physics.samples and samples is None else ()),
        *cautions(measured, tracks, fit.friction, sheet),
    )
    results = steps.gather_results(
        measured,
        fit,
        warnings=tuple(dict.fromkeys(warnings)),
        radius=radius,
        simulations=replay.scores,
        predictions=predictions,
        posterior=samples,
        teams={stone: team for stone, team in team_of.items() if team},
        masses=masses or {},
        origin_at_tee=house is not None,
    )
    simulations = [
        simulation_table(table, model, team_of) for model, table in replay.samples.items()
    ]
    cameras = None
    if measured.cameras:
        from curlshot.vision.optics.camera import camera_table

        cameras = camera_table(measured.cameras)
    progress("physics", 1, 1)
    return Run(
        with_measured(tracks, measured.table),
        cameras,
        results,
        pd.concat(simulations, ignore_index=True) if simulations else simulation_table(None, ""),
        house=house,
        posterior=samples,
        ensemble=replay.ensemble,
        measurement=measured,
        config=config,
    )


def _way_out(config: Config) -> str:
    """Return what to do where no stone was found, by how the camera was known."""
    for name in ("stick", "camera"):
        if getattr(config.camera, name) is not None:
            return f"`check` shows the frames; verify `radius` and `{name}`"
    return "`check` shows the house that was found; `house` corrects it"
