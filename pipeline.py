"""The command ``curlshot`` and the order of the work, from Python as `run`, `check` and so on.

Everything heavy is imported where it is used, so that ``curlshot --help`` answers at once.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.cli.again import again
from curlshot.cli.arguments import out_folder, settings_of, what_if_folder
from curlshot.cli.bars import Bars
from curlshot.cli.garbage import collect_seldom
from curlshot.cli.guard import guarded, one_line, write_anywhere
from curlshot.cli.parser import command_line
from curlshot.cli.threads import use_one_thread
from curlshot.data.errors import CurlshotError, InputError
from curlshot.data.files import check_folder, staged
from curlshot.data.inputs import IMAGE_SUFFIXES, TABLE_SUFFIXES, find_inputs, named
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import House
from curlshot.work.analyse import Run, analyse
from curlshot.work.convert import convert, convert_each
from curlshot.work.film import film
from curlshot.work.measure import Measured, measure, refuse_clips
from curlshot.work.runs import apart, find_results, find_runs, read_runs
from curlshot.work.settings import Settings
from curlshot.work.simulate import measured_shot, read_start, sampled, shot_file, throw_often

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from curlshot.data.results import Results
    from curlshot.physics.statistics.pool import Pooled

__all__ = [
    "Measured", "Run", "Settings", "analyse", "check", "convert", "convert_each", "find_runs",
    "main", "measure", "run", "run_each", "sample_clip", "season",
]  # fmt: skip

VERSION = "0.1.0"
WRITTEN = (
    "tracks.csv", "camera.csv", "results.json", "simulation.csv", "report.html",
    "overlay.mp4", "figures", "tables", "posterior.csv", "ensemble.json",
)  # fmt: skip
"""All that a run may write into its folder."""

WHAT_IF = ("outcomes.csv", "whatif.json", "spread.png")
"""All that samples of a simulation write beside it."""

CHECK_DPI = 110

MEASURED_THROWS = 1000
"""Samples of a measured shot where the person says nothing."""


def sample_clip() -> Path:
    """Path of the bundled, rendered clip of the paper's shot."""
    return Path(__file__).resolve().parent / "data" / "sample.mp4"


def run(
    inputs: str | Path | Sequence[str | Path] = (),
    out: str | Path | None = None,
    settings: Settings = Settings(),
    progress: Progress = no_progress,
) -> Run:
    """Go the whole road: from a clip or tracks to e, μ, simulations and a report.

    Parameters
    ----------
    inputs : str or Path, or sequence of them
        A video, pictures (files, a folder or a glob), or tables of tracks; the bundled
        sample if none.
    out : str or Path, optional
        Folder for the files of the run; nothing is written without it.
    settings : Settings
        What to know about the input.
    progress : callable
        Called as the work goes on.

    Returns
    -------
    Run
        Tracks, cameras, estimates and simulations.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the input cannot be used; then nothing is written.
    """
    folder = None if out is None else check_folder(out)
    files = find_inputs(named(inputs) or sample_clip())
    if folder is not None:
        own = {folder.resolve() / name for name in WRITTEN}
        lost = [path for path in files if path.resolve() in own]
        if lost:
            raise InputError(f"{lost[0]}: would be written over; name another folder with -o")
    measured = measure(files, settings, progress)
    done = analyse(measured, settings, progress)
    if folder is None:
        return done
    with staged(folder, replaces=WRITTEN) as stage:
        _write_run(stage, measured, done, settings, progress)
    return replace(done, out=folder)


def run_each(
    clips: str | Path | Sequence[str | Path],
    out: str | Path,
    settings: Settings = Settings(),
    progress: Progress = no_progress,
    jobs: int = 1,
) -> tuple[dict[str, Run], dict[str, CurlshotError]]:
    """Run many clips, one folder of `out` for each; one that fails does not stop the others.

    Parameters
    ----------
    clips : str or Path, or sequence of them
        Videos.
    out : str or Path
        Folder for their folders.
    settings : Settings
        What to know about all of them.
    progress : callable
        Called as the work goes on; of more than one job when one more clip is done.
    jobs : int
        Clips at once. Of more than one each has a process of its own, so a script that asks for
        it must not do so where it is imported (``if __name__ == "__main__":``).

    Returns
    -------
    done : dict of str to Run
        By the names of their folders.
    failed : dict of str to CurlshotError
        Why the others could not be used.
    """
    folder = check_folder(out)
    once = {path.resolve(): path for path in map(Path, named(clips))}
    tasks = {name: (clip, folder / name) for name, clip in apart([*once.values()]).items()}
    if min(jobs, len(tasks)) > 1:
        from curlshot.cli.parallel import in_processes

        outcomes = in_processes(partial(_attempt, settings), tasks, jobs, "clips", progress)
    else:
        outcomes = {
            name: _attempt(settings, task, _numbered(progress, f"{number}/{len(tasks)} "))
            for number, (name, task) in enumerate(tasks.items(), 1)
        }
    done = {name: one for name, one in outcomes.items() if isinstance(one, Run)}
    failed = {name: one for name, one in outcomes.items() if isinstance(one, CurlshotError)}
    return done, failed


def _attempt(
    settings: Settings, task: tuple[Path, Path], progress: Progress = no_progress
) -> Run | CurlshotError:
    """Run a clip into a folder, or tell why it could not be used."""
    clip, folder = task
    try:
        return run([clip], folder, settings, progress)
    except CurlshotError as error:
        return error


def _numbered(progress: Progress, number: str) -> Progress:
    """Say of which of many clips it is that the work goes on."""

    def numbered(what: str, at: int, total: int | None) -> None:
        progress(number + what, at, total)

    return numbered


def _write_run(
    stage: Path, measured: Measured, done: Run, settings: Settings, progress: Progress
) -> None:
    from curlshot.data.coach_units import UNITS
    from curlshot.data.tracks import write_table, write_tracks
    from curlshot.report.page import write_report
    from curlshot.report.provenance import Provenance, sources
    from curlshot.report.tables import residual_table

    write_tracks(done.tracks, stage / "tracks.csv", measured.table)
    write_table(done.simulations, stage / "simulation.csv")
    _write_estimates(stage, done)
    if done.cameras is not None:
        write_table(done.cameras, stage / "camera.csv")
    house = done.house
    overlay: Path | None = None
    clip_start = 0.0
    if measured.clip is not None and settings.overlay:
        from curlshot.report.overlay import write_overlay

        overlay = stage / "overlay.mp4"
        clip_start = write_overlay(
            measured.clip,
            measured.cameras,
            done.tracks,
            done.results.collisions,
            overlay,
            rings=None if house is None else _painted(house),
            radius=settings.radius,
            progress=progress,
        )
    progress("report", 0, 1)
    write_report(
        stage,
        results=done.results,
        tracks=done.tracks,
        simulations={str(m): table for m, table in done.simulations.groupby("model")},
        cameras=done.cameras,
        clip_name=measured.files[0].name,
        overlay=overlay,
        clip_start=clip_start,
        house=house,
        residuals=residual_table(
            measured.sightings, done.tracks, done.results.collisions, done.results.radius
        ),
        posterior=done.posterior,
        ensemble=done.ensemble,
        unit=UNITS[settings.units],
        provenance=Provenance(
            VERSION,
            again(measured.files, vars(settings), vars(Settings())),
            sources(measured.files),
        ),
    )
    progress("report", 1, 1)


def _write_estimates(stage: Path, done: Run) -> None:
    """Write what is told of a shot, and what it may have been."""
    from curlshot.data.results_file import write_results
    from curlshot.data.tracks import write_table
    from curlshot.physics.prediction.ensemble import write_ensemble

    write_results(done.results, stage / "results.json")
    if done.posterior is not None:
        write_table(done.posterior, stage / "posterior.csv")
    if done.ensemble is not None:
        write_ensemble(done.ensemble, stage / "ensemble.json")


def season(
    runs: Mapping[str, Results],
    out: str | Path | None = None,
    folders: Mapping[str, Path] | None = None,
    left_out: Mapping[str, str] | None = None,
) -> tuple[pd.DataFrame, dict[str, Pooled]]:
    """Put many shots side by side, and say what all of them say of e and μ.

    One that is there twice, as of a copied run, counts once
    (`curlshot.physics.statistics.season.repeated`).

    Parameters
    ----------
    runs : mapping of str to Results
        The shots by name.
    out : str or Path, optional
        Folder for the page, the tables and the picture; nothing is written without it.
    folders : mapping of str to Path, optional
        Where the shots' own reports are, for the page to lead to.
    left_out : mapping of str to str, optional
        Shots that are not among them, and why, for the page to say.

    Returns
    -------
    shots : DataFrame
        See `curlshot.physics.statistics.season.shots_table`.
    pooled : dict
        ``restitution`` and ``friction``; see `curlshot.physics.statistics.pool.Pooled`.
    """
    shots, means, _ = _put_together(runs, out, folders or {}, left_out or {})
    return shots, means


def _put_together(
    runs: Mapping[str, Results],
    out: str | Path | None,
    folders: Mapping[str, Path],
    left_out: Mapping[str, str],
) -> tuple[pd.DataFrame, dict[str, Pooled], dict[str, str]]:
    """As `season`, and which shots do not count and why, those that are there twice among them."""
    from curlshot.physics.statistics.season import hits_table, pooled, repeated, shots_table

    folder = None if out is None else check_folder(out)
    again = repeated(runs)
    unused = {name: f"the same shot as {one}: counted once" for name, one in again.items()}
    unused |= left_out
    runs = {name: run for name, run in runs.items() if name not in again}
    shots, hits = shots_table(runs), hits_table(runs)
    means = pooled(shots)
    if folder is None:
        return shots, means, unused
    from curlshot.report.season import write_season
    from curlshot.report.season_page import season_page
    from curlshot.report.template import link

    pages = {name: path / "report.html" for name, path in folders.items() if name in runs}
    page = season_page(
        folder.resolve().name,
        shots,
        hits,
        means,
        {name: link(path, folder) for name, path in pages.items() if path.exists()},
        unused,
        VERSION,
    )
    with staged(folder) as stage:
        write_season(stage, shots, hits, means, page)
    return shots, means, unused


def check(
    inputs: str | Path | Sequence[str | Path],
    settings: Settings = Settings(),
    progress: Progress = no_progress,
) -> tuple[Figure, list[str]]:
    """Follow the camera and look for stones in a few frames, for a person to judge.

    Returns
    -------
    Figure
        The contact sheet (see `curlshot.report.check.check_figure`).
    list of str
        The same in a few lines.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the input cannot be used; one line says why.
    """
    from curlshot.report.check import check_figure
    from curlshot.report.looks import Look, check_lines, check_table, frames_to_show
    from curlshot.vision.detection.glance import glance
    from curlshot.vision.optics.placed import nobody

    files = find_inputs(inputs)
    seen = film(files, settings, progress, nobody)
    clip, cameras = seen.clip, seen.cameras
    radii = () if seen.house is None else _painted(seen.house)
    table = check_table(cameras, radii[0] if radii else 0.0)
    by_frame = {camera.frame: camera for camera in cameras}
    chosen = frozenset(frames_to_show(table))
    frames = []
    for done, frame in enumerate(clip, 1):
        if frame.index in chosen:
            frames.append(frame)
        progress("frames to show", done, clip.expected)
    stones = glance([(frame.image, by_frame[frame.index]) for frame in frames], seen.disc)
    looks = [
        Look(frame, by_frame[frame.index], found.stones, found.refused)
        for frame, found in zip(frames, stones, strict=True)
    ]
    lines = check_lines(files[0].name, clip.read, table, looks, (*clip.warnings, *seen.warnings))
    title = f"{files[0].name}: {' '.join(lines[1].split())}"
    return check_figure(looks, table, radii, title=title, radius=settings.radius), lines


def _painted(house: House) -> tuple[float, ...]:
    return house.twelve_foot, house.eight_foot, house.four_foot


# ---------------------------------------------------------------------------------------
# The command line
# ---------------------------------------------------------------------------------------


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of the command; returns its exit code (0 well, 2 a person's mistake)."""
    use_one_thread()
    collect_seldom()
    write_anywhere()
    arguments = command_line(VERSION).parse_args(argv)
    bars = Bars(quiet=arguments.quiet)
    return guarded(lambda: WORK[arguments.command](arguments, bars), bars)


def _stale(folder: Path, inputs: Sequence[Path]) -> tuple[str, ...]:
    """Names of what an earlier run left in `folder`, without the inputs and their cameras."""
    kept = {path.name for path in inputs if path.resolve().parent == folder.resolve()}
    if "tracks.csv" in kept:
        kept.add("camera.csv")
    return tuple(name for name in WRITTEN if name not in kept)


def _summary(done: Run, folder: Path, units: str) -> str:
    from curlshot.data.coach_units import UNITS
    from curlshot.report.summary import summary

    marked = done.cameras is None
    return summary(done.results, done.tracks, folder, done.house, UNITS[units], marked=marked)


def _do_run(arguments: argparse.Namespace, bars: Bars) -> str:
    inputs = arguments.inputs or [sample_clip()]
    files = find_inputs(inputs)
    if len(files) > 1 and not any(
        f.suffix.lower() in TABLE_SUFFIXES | IMAGE_SUFFIXES for f in files
    ):
        return _run_season(arguments, files, bars)
    folder = out_folder(arguments, inputs[0])
    done = run(inputs, folder, settings_of(arguments), bars)
    return _summary(done, folder, arguments.units)


def _run_season(arguments: argparse.Namespace, clips: Sequence[Path], bars: Bars) -> str:
    from curlshot.cli.parallel import processors

    folder = Path(arguments.out or "season")
    jobs = arguments.jobs or processors()
    done, failed = run_each(clips, folder, settings_of(arguments), bars, jobs)
    if not done:
        name, error = next(iter(failed.items()))
        raise InputError(f"none of {len(clips)} clips could be used; {name}: {error}")
    runs = {name: run.results for name, run in done.items()}
    unused = {name: f"not used: {one_line(str(why))}" for name, why in failed.items()}
    return _season_summary(runs, folder, {name: folder / name for name in runs}, unused)


def _do_season(arguments: argparse.Namespace, _: Bars) -> str:
    files = find_results(arguments.runs)
    folders = {name: file.parent for name, file in files.items()}
    return _season_summary(read_runs(files), Path(arguments.out or "season"), folders, {})


def _season_summary(
    runs: Mapping[str, Results],
    folder: Path,
    folders: Mapping[str, Path],
    unused: Mapping[str, str],
) -> str:
    """Say what many shots tell, which do not count, and where the page is."""
    from curlshot.report.summary import season_text

    shots, means, left_out = _put_together(runs, folder, folders, unused)
    lines = [*season_text(shots, means), *(f"{name}   {why}" for name, why in left_out.items())]
    return "\n".join([*lines, f"written     {folder / 'season.html'}"])


def _do_track(arguments: argparse.Namespace, bars: Bars) -> str:
    from curlshot.data.tracks import write_table, write_tracks
    from curlshot.physics.kalman import smoothed
    from curlshot.physics.local_fit.contacts import find_contacts
    from curlshot.report.numbers import count, warned
    from curlshot.vision.optics.camera import camera_columns

    settings, folder = settings_of(arguments), out_folder(arguments, arguments.inputs[0])
    measured = measure(arguments.inputs, replace(settings, clip=True), bars)
    contacts = find_contacts(measured.table, settings.radius)
    tracks = smoothed(measured.table, contacts, radius=settings.radius)
    with staged(folder, replaces=_stale(folder, measured.files)) as stage:
        write_tracks(tracks, stage / "tracks.csv", measured.table)
        write_table(camera_columns(measured.cameras), stage / "camera.csv")
    stones = set(tracks["stone"].tolist())
    lines = [
        f"{count(len(stones), 'stone')} in {count(measured.frames, 'frame')}: "
        f"{folder / 'tracks.csv'}, {folder / 'camera.csv'}"
    ]
    return "\n".join([*lines, *warned(measured.warnings)])


def _do_check(arguments: argparse.Namespace, bars: Bars) -> str:
    settings, folder = settings_of(arguments), out_folder(arguments, arguments.inputs[0])
    figure, lines = check(arguments.inputs, settings, bars)
    with staged(folder) as stage:
        figure.savefig(stage / "check.png", dpi=CHECK_DPI)
    return "\n".join([*lines, f"written     {folder / 'check.png'}"])


def _do_estimate(arguments: argparse.Namespace, bars: Bars) -> str:
    settings, folder = settings_of(arguments), out_folder(arguments, arguments.inputs[0])
    refuse_clips(find_inputs(arguments.inputs), "run")
    measured = measure(arguments.inputs, settings, bars)
    done = analyse(measured, settings, bars)
    with staged(folder, replaces=_stale(folder, measured.files)) as stage:
        _write_estimates(stage, done)
    return _summary(done, folder, arguments.units)


def _do_convert(arguments: argparse.Namespace, _: Bars) -> str:
    from curlshot.report.numbers import count, warned

    if Path(arguments.out).suffix == "" and Path(arguments.out).name.startswith("."):
        return _convert_each(arguments)
    measured = convert(arguments.inputs, arguments.out, settings_of(arguments), arguments.over)
    stones = measured.sightings["stone"].nunique()
    lines = [f"{count(stones, 'stone')} in {count(measured.frames, 'frame')}: {arguments.out}"]
    return "\n".join([*lines, *warned(measured.warnings)])


def _convert_each(arguments: argparse.Namespace) -> str:
    from curlshot.report.numbers import count, warned

    if arguments.over is not None:
        raise InputError("--over: one clip cannot be behind many projects; convert one at a time")
    done = convert_each(arguments.inputs, arguments.out, settings_of(arguments))
    refused = [refusal for refusal in done.values() if isinstance(refusal, CurlshotError)]
    lines = [f"{count(len(done) - len(refused), 'file')} written"]
    for path, outcome in done.items():
        if not isinstance(outcome, CurlshotError):
            lines += [str(path), *warned(outcome.warnings)]
    if refused:
        reasons = "; ".join(str(refusal) for refusal in refused)
        rest = ", the others were" if len(refused) < len(done) else ""
        raise InputError(f"{len(refused)} of {len(done)} not converted{rest}: {reasons}")
    return "\n".join(lines)


def _do_simulate(arguments: argparse.Namespace, bars: Bars) -> str:
    import json

    from curlshot.physics.prediction.what_if import Changes, changed
    from curlshot.physics.simulator.simulate import simulate
    from curlshot.report.numbers import warned
    from curlshot.report.summary import odds_text, simulation_json, simulation_text
    from curlshot.report.whatif import write_odds, write_simulated

    shot = shot_file(arguments.shot)
    folder = what_if_folder(arguments, shot)
    start = read_start(shot, folder)
    changes = Changes(
        arguments.restitution,
        arguments.friction,
        arguments.speed,
        arguments.spin,
        arguments.aim_offset,
    )
    start = changed(start, changes)
    simulation = simulate(start.shot)
    table = sampled(simulation, arguments.fps, start.shot.impact.name)
    throws = arguments.samples
    if throws is None:
        throws = MEASURED_THROWS if measured_shot(shot) else 0
    outcome = simulation_json(simulation)
    written = [folder / name for name in ("simulation.csv", "plan.png")]
    lines = [simulation_text(simulation, written)]
    warnings = [*start.assumed.values()]
    with staged(folder, replaces=WHAT_IF) as stage:
        write_simulated(stage, start, simulation, table)
        if throws:
            outcomes, odds = throw_often(
                start, changes, throws, arguments.throw_sd, shot.name, bars
            )
            write_odds(stage, start, outcomes, odds)
            outcome = {"nominal": outcome, **odds}
            lines += odds_text(odds, [folder / name for name in WHAT_IF])
            warnings = odds["warnings"]
    lines += warned(warnings)
    return json.dumps(outcome, indent=1) if arguments.json else "\n".join(lines)


WORK = {
    "run": _do_run,
    "season": _do_season,
    "track": _do_track,
    "check": _do_check,
    "estimate": _do_estimate,
    "convert": _do_convert,
    "simulate": _do_simulate,
}


if __name__ == "__main__":
    sys.exit(main())
