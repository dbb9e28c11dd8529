"""The command ``curlshot``: what each of its commands does and prints."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.cli.arguments import config_of, out_folder, what_if_folder
from curlshot.cli.bars import Bars
from curlshot.cli.guard import guarded, one_line, write_anywhere
from curlshot.cli.parser import command_line
from curlshot.cli.threads import use_one_thread
from curlshot.data.convert import targets_of
from curlshot.data.errors import CurlshotError, InputError
from curlshot.data.files import staged
from curlshot.data.garbage import collect_seldom
from curlshot.data.importers import refuse_clips
from curlshot.data.inputs import IMAGE_SUFFIXES, TABLE_SUFFIXES, find_inputs, sample_clip
from curlshot.data.messages import as_options
from curlshot.data.run_folders import season_folder
from curlshot.data.version import VERSION
from curlshot.pipeline import analyse, convert, measure, run

if TYPE_CHECKING:
    from curlshot.data.measurement import Measurement
    from curlshot.outcome import Run

CHECK_DPI = 110

MEASURED_THROWS = 1000
"""Samples of a measured shot where the person gives no number."""

WHAT_IF = ("outcomes.csv", "whatif.json", "spread.png")
"""All that samples of a simulation write beside it."""


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of the command; returns its exit code (0 well, 2 a person's mistake)."""
    use_one_thread()
    collect_seldom()
    write_anywhere()
    arguments = command_line(VERSION).parse_args(argv)
    bars = Bars(quiet=arguments.quiet)
    return guarded(lambda: WORK[arguments.command](arguments, bars), bars)


def _do_run(arguments: argparse.Namespace, bars: Bars) -> str:
    inputs = arguments.inputs or [sample_clip()]
    files = find_inputs(inputs)
    if len(files) > 1 and not any(
        f.suffix.lower() in TABLE_SUFFIXES | IMAGE_SUFFIXES for f in files
    ):
        return _run_season(arguments, files, bars)
    folder = out_folder(arguments, inputs[0])
    done = run(inputs, folder, config_of(arguments), bars)
    return done.summary()


def _run_season(arguments: argparse.Namespace, clips: Sequence[Path], bars: Bars) -> str:
    from curlshot.season.batch import run_each
    from curlshot.season.parallel import processors

    folder = season_folder(arguments.out or "season")
    jobs = arguments.jobs or processors()
    done, failed = run_each(clips, folder, config_of(arguments), bars, jobs)
    if not done:
        name, error = next(iter(failed.items()))
        raise InputError(f"none of {len(clips)} clips could be used; {name}: {error}")
    unused = {name: f"not used: {one_line(as_options(str(why)))}" for name, why in failed.items()}
    return _season_summary(done, folder, unused)


def _do_season(arguments: argparse.Namespace, _: Bars) -> str:
    return _season_summary(arguments.runs, Path(arguments.out or "season"), {})


def _season_summary(
    runs: Sequence[str] | Mapping[str, Run], folder: Path, unused: Mapping[str, str]
) -> str:
    """Say what many shots show, which do not count, and where the page is."""
    from curlshot.season.together import combine

    together = combine(runs, folder, unused)
    return f"{together.summary()}\nwritten     {folder / 'season.html'}"


def _do_track(arguments: argparse.Namespace, bars: Bars) -> str:
    from curlshot.data.tracks import write_table, write_tracks
    from curlshot.physics.kalman import smoothed
    from curlshot.physics.local_fit.hit_detection import detect_hits
    from curlshot.report.numbers import count, warned
    from curlshot.report.write import left_by_earlier_run
    from curlshot.vision.optics.camera import camera_columns

    config, folder = config_of(arguments), out_folder(arguments, arguments.inputs[0])
    radius = config.stones.radius
    measured = measure(arguments.inputs, config.replace(clip=True), bars)
    tracks = smoothed(measured.table, detect_hits(measured.table, radius), radius=radius)
    with staged(folder, replaces=left_by_earlier_run(folder, _read(measured, arguments))) as stage:
        write_tracks(tracks, stage / "tracks.csv", measured.table)
        write_table(camera_columns(measured.cameras), stage / "camera.csv")
    stones = set(tracks["stone"].tolist())
    lines = [
        f"{count(len(stones), 'stone')} in {count(measured.frames, 'frame')}: "
        f"{folder / 'tracks.csv'}, {folder / 'camera.csv'}"
    ]
    return "\n".join([*lines, *warned(measured.warnings)])


def _do_check(arguments: argparse.Namespace, bars: Bars) -> str:
    from curlshot.report.check_clip import check

    config, folder = config_of(arguments), out_folder(arguments, arguments.inputs[0])
    figure, lines = check(arguments.inputs, config, bars)
    with staged(folder) as stage:
        figure.savefig(stage / "check.png", dpi=CHECK_DPI)
    return "\n".join([*lines, f"written     {folder / 'check.png'}"])


def _do_estimate(arguments: argparse.Namespace, bars: Bars) -> str:
    from curlshot.report.write import left_by_earlier_run, write_estimates

    config, folder = config_of(arguments), out_folder(arguments, arguments.inputs[0])
    refuse_clips(find_inputs(arguments.inputs), "run")
    measured = measure(arguments.inputs, config, bars)
    done = analyse(measured, config, bars)
    with staged(folder, replaces=left_by_earlier_run(folder, _read(measured, arguments))) as stage:
        write_estimates(stage, done)
    return replace(done, out=folder).summary()


def _read(measured: Measurement, arguments: argparse.Namespace) -> tuple[Path, ...]:
    """Return the files that were read, with that of the settings."""
    return measured.files if arguments.config is None else (*measured.files, arguments.config)


def _do_convert(arguments: argparse.Namespace, _: Bars) -> str:
    from curlshot.report.numbers import count, warned

    if Path(arguments.out).suffix == "" and Path(arguments.out).name.startswith("."):
        return _convert_each(arguments)
    measured = convert(arguments.inputs, arguments.out, config_of(arguments), arguments.over)
    stones = measured.detections["stone"].nunique()
    lines = [f"{count(stones, 'stone')} in {count(measured.frames, 'frame')}: {arguments.out}"]
    return "\n".join([*lines, *warned(measured.warnings)])


def _convert_each(arguments: argparse.Namespace) -> str:
    from curlshot.report.numbers import count, warned

    if arguments.over is not None:
        raise InputError("`over`: one clip does not fit many projects; convert one at a time")
    config, files = config_of(arguments), find_inputs(arguments.inputs)
    targets = targets_of(files, arguments.out)
    refused, written = [], []
    for file, path in zip(files, targets, strict=True):
        try:
            written += [str(path), *warned(convert([file], path, config).warnings)]
        except CurlshotError as refusal:
            refused.append(str(refusal))
    done = len(files) - len(refused)
    if refused:
        rest = ", the others were" if done else ""
        reasons = "; ".join(refused)
        raise InputError(f"{len(refused)} of {len(files)} not converted{rest}: {reasons}")
    return "\n".join([f"{count(done, 'file')} written", *written])


def _do_simulate(arguments: argparse.Namespace, bars: Bars) -> str:
    import json

    from curlshot.physics.prediction.restart import measured_shot, shot_file
    from curlshot.report.numbers import warned
    from curlshot.report.summary import odds_text, simulation_json
    from curlshot.report.whatif import write_odds, write_simulated
    from curlshot.simulated import simulate

    shot = shot_file(arguments.shot)
    folder = what_if_folder(arguments, shot)
    done = simulate(
        shot,
        speed=arguments.speed,
        spin=arguments.spin,
        aim_offset=arguments.aim_offset,
        restitution=arguments.restitution,
        friction=arguments.friction,
    )
    table = done.table(arguments.fps)
    throws = arguments.samples
    if throws is None:
        throws = MEASURED_THROWS if measured_shot(shot) else 0
    outcome = simulation_json(done.simulation)
    lines = [done.summary([folder / name for name in ("simulation.csv", "plan.png")])]
    warnings = [*done.warnings]
    with staged(folder, replaces=WHAT_IF) as stage:
        write_simulated(stage, done.start, done.simulation, table)
        if throws:
            outcomes, odds = done.throw(throws, arguments.throw_sd, bars)
            write_odds(stage, done.start, outcomes, odds)
            outcome = {"nominal": outcome, **odds}
            lines += odds_text(odds, [folder / name for name in WHAT_IF])
            warnings = odds["warnings"]
    lines += warned(warnings)
    return json.dumps(outcome, indent=1) if arguments.json else "\n".join(lines)


def _do_config(arguments: argparse.Namespace, _: Bars) -> str:
    return config_of(arguments).to_toml().rstrip()


WORK = {
    "run": _do_run,
    "season": _do_season,
    "track": _do_track,
    "check": _do_check,
    "estimate": _do_estimate,
    "convert": _do_convert,
    "simulate": _do_simulate,
    "config": _do_config,
}
