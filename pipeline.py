"""The command ``curlshot`` and the order of the work, from Python as `run`, `track` and so on.

Everything heavy is imported where it is used, so that ``curlshot --help`` answers at once.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from command.again import again
from command.bars import Bars
from command.parser import command_line
from data.errors import CurlshotError, InputError, SceneError
from data.files import check_folder, relative_path, staged
from data.inputs import IMAGE_SUFFIXES, find_inputs
from data.progress import Progress, no_progress
from data.sheet import HOUSE, STONE, House, Stone

T = TypeVar("T")

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from data.results import Estimate, Results
    from physics.pool import Pooled
    from physics.start import Start
    from physics.what_if import Changes
    from vision.camera import Camera
    from vision.clip import Clip, Frame
    from vision.joint import HouseTrack
    from vision.placed import Placed

VERSION = "0.1.0"
WRITTEN = (
    "tracks.csv", "camera.csv", "results.json", "simulation.csv", "report.html", "overlay.mp4",
    "figures", "tables", "posterior.csv",
)  # fmt: skip
"""All that a run may write into its folder."""

WHAT_IF = ("outcomes.csv", "whatif.json", "spread.png")
"""All that samples of a simulation write beside it."""

SEASON = ("shots.csv", "hits.csv", "season.json", "season.png")
"""All that many shots together write."""

CHECK_DPI = 110

MOST_SAMPLES = 1_000_000
"""Of one simulated stone; more is a mistake in the rate."""

MEASURED_THROWS = 1000
"""Samples of a measured shot where the person says nothing."""

TABLES = frozenset({".csv", ".txt", ".tsv", ".dat", ".trk", ".trz", ".zip", ".parquet"})

SPREADSHEETS = frozenset({".ods", ".xls", ".xlsx"})


@dataclass(frozen=True)
class Settings:
    """What a person may say about the input.

    Attributes
    ----------
    fps : float, optional
        Rate of pictures, or of a table without times, 1/s.
    frames : (int, int or None), optional
        First and last frame of a clip to use, both included.
    stick : (x1, y1, x2, y2, metres), optional
        Calibration stick: two pixels and their distance, for a still camera and no house.
    house : (frame, xc, yc, x1, y1, x2, y2), optional
        The tee and two points on the outer edge of the 12-ft ring, px, in one frame (None: the
        first), for a house that is not found by itself.
    camera : Path, optional
        Table as ``camera.csv`` with a known camera: one row, or one per frame; or a Tracker
        project, whose coordinate system is the camera. With a radius
        other than a curling stone's, the discs are looked for as plain ones on no house.
    radius : float
        Radius of the discs, m.
    masses : mapping
        Masses by stone, in any unit, where they are not all equal.
    length_unit, angle_unit : str, optional
        Units of tables.
    clip : bool
        Whether what a Tracker project's clip shows is measured, not what is marked in it.
    tab : str, optional
        Which tab of a Tracker project with several.
    names : mapping
        Names of stones to names of tracks in tables; empty for all tracks by their own names.
    angles : mapping
        Tables of the angles of stones, by stone.
    overlay : bool
        Whether the annotated clip is written.
    restitution, friction : float, optional
        What predictions assume beforehand; values of the literature by default.
    samples : int
        Draws of restitution and frictions from what the shot tells.
    units : str
        Of what coaches read: m or ft. All else is SI.

    Raises
    ------
    InputError
        More than one of stick, house and camera.
    """

    fps: float | None = None
    frames: tuple[int, int | None] | None = None
    stick: tuple[float, float, float, float, float] | None = None
    house: tuple[int | None, float, float, float, float, float, float] | None = None
    camera: Path | None = None
    radius: float = STONE.radius
    masses: Mapping[str, float] = field(default_factory=dict)
    length_unit: str = "m"
    angle_unit: str | None = None
    clip: bool = False
    tab: str | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    angles: Mapping[str, Path] = field(default_factory=dict)
    overlay: bool = True
    restitution: float | None = None
    friction: float | None = None
    samples: int = 0
    units: str = "m"

    def __post_init__(self) -> None:
        ways = {"--stick": self.stick, "--house": self.house, "--camera": self.camera}
        given = [name for name, value in ways.items() if value is not None]
        if len(given) > 1:
            raise InputError(f"{' and '.join(given)} exclude each other; give one of them")


@dataclass(frozen=True)
class Measured:
    """Sightings of the stones and where they come from."""

    files: tuple[Path, ...]
    sightings: pd.DataFrame
    fps: float | None
    frames: int
    warnings: tuple[str, ...]
    clip: Clip | None = None
    cameras: tuple[Camera, ...] = ()
    house: House | None = None
    masses: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Filmed:
    """A clip with its cameras, and what is known of the scene."""

    clip: Clip
    cameras: tuple[Camera, ...]
    disc: Stone
    house: House | None = None
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Run:
    """The outcome of a run.

    Attributes
    ----------
    tracks : DataFrame
        As ``tracks.csv``.
    cameras : DataFrame or None
        As ``camera.csv``; None for imported tracks.
    results : data.results.Results
        Estimates with errors, as ``results.json``.
    simulations : DataFrame
        As ``simulation.csv``: one column ``model``, else as the tracks.
    out : Path or None
        Where the files are.
    house : House or None
        The rings; None where the scene has no house.
    posterior : DataFrame or None
        As ``posterior.csv``: draws of restitution and frictions, where they were asked for.
    """

    tracks: pd.DataFrame
    cameras: pd.DataFrame | None
    results: Results
    simulations: pd.DataFrame
    out: Path | None = None
    house: House | None = None
    posterior: pd.DataFrame | None = None


def sample_clip() -> Path:
    """Path of the bundled, rendered clip of the paper's shot."""
    return Path(__file__).resolve().parent / "data" / "sample.mp4"


def measure(
    inputs: Sequence[str | Path],
    settings: Settings = Settings(),
    progress: Progress = no_progress,
) -> Measured:
    """Sightings of every stone, from a clip, pictures or a table of tracks.

    Raises
    ------
    data.errors.CurlshotError
        Where the input cannot be used; one line says why.
    """
    files = find_inputs(inputs)
    tables = [path.suffix.lower() in TABLES for path in files]
    if any(tables) and not settings.clip:
        if not all(tables):
            odd = files[tables.index(False)]
            raise InputError(f"{odd}: tables of tracks and pictures do not mix; give one kind")
        from data.discs import refuse_no_discs

        _refuse_clip_options(files[0], settings)
        measured = _import_tables(files, settings)
        refuse_no_discs(measured.sightings, settings.radius, ", ".join(map(str, files)))
        return measured
    if not any(tables):
        _refuse_table_options(files[0], settings)
    return _look_at_clip(files, settings, progress)


def _refuse_clips(files: Sequence[Path], command: str) -> None:
    """Refuse what is no table of tracks, and say which command takes it."""
    odd = [path for path in files if path.suffix.lower() not in TABLES]
    if odd:
        raise InputError(f"{odd[0]}: not a table of tracks; try curlshot {command}")


def _refuse_table_options(path: Path, settings: Settings) -> None:
    """Refuse to pass over what a person says about tables where a clip is measured."""
    said = {"--names": settings.names, "--angles": settings.angles, "--tab": settings.tab}
    said["--angle-unit"] = settings.angle_unit
    given = [name for name, value in said.items() if value]
    if settings.length_unit != "m":
        given.append("--length-unit")
    if given:
        raise InputError(f"{path}: only tables take {', '.join(given)}; a clip is measured here")


def _refuse_clip_options(path: Path, settings: Settings) -> None:
    """Refuse to pass over what a person says about a clip where tracks are read."""
    from data.project import ENDINGS

    said = {"--stick": settings.stick, "--house": settings.house, "--camera": settings.camera}
    given = [name for name, value in {**said, "--frames": settings.frames}.items() if value]
    if given:
        clip = "; add --clip to measure its clip" if path.suffix.lower() in ENDINGS else ""
        raise InputError(f"{path}: only clips take {', '.join(given)}; tracks are read here{clip}")


def _import_tables(files: tuple[Path, ...], settings: Settings) -> Measured:
    from data.tracker import read_table

    table = read_table(
        files,
        length_unit=settings.length_unit,
        angle_unit=settings.angle_unit,
        fps=settings.fps,
        tab=settings.tab,
        names=settings.names,
        angles=settings.angles,
    )
    sightings = table.sightings
    house = HOUSE if settings.radius == STONE.radius else None
    return Measured(
        files,
        sightings,
        table.fps,
        sightings["t"].nunique(),
        table.warnings,
        house=house,
        masses=table.masses,
    )


def _look_at_clip(files: tuple[Path, ...], settings: Settings, progress: Progress) -> Measured:
    from vision.stones import FOLLOWING, SEARCH
    from vision.track import tracks_of
    from vision.watch import Watch

    alone = len(files) == 1 and files[0].suffix.lower() in IMAGE_SUFFIXES
    # A picture by itself has one chance.
    watch = Watch(_disc(settings), SEARCH if alone else FOLLOWING)

    def look(frame: Frame, camera: Camera) -> None:
        if not watch.begun:
            _check_size(settings.radius, camera)
        watch.look(frame, camera)

    seen = _film(files, settings, progress, look)
    stones = tracks_of(watch, seen.cameras)
    return Measured(
        files,
        stones.sightings,
        seen.clip.fps,
        seen.clip.read,
        (*seen.clip.warnings, *seen.warnings, *stones.warnings),
        seen.clip,
        seen.cameras,
        seen.house,
    )


def _disc(settings: Settings) -> Stone:
    """Say what is looked for: stones in a house or of their size, else plain discs."""
    from vision.stones import plain_disc

    sized_as_stones = settings.camera is None or settings.radius == STONE.radius
    if settings.stick is None and sized_as_stones:
        return replace(STONE, radius=settings.radius)
    return plain_disc(settings.radius)


def _film(
    files: tuple[Path, ...], settings: Settings, progress: Progress, placed: Placed
) -> Filmed:
    """Open a clip, read it and find its cameras; `placed` is told of each frame on the way."""
    clip, disc = _open_clip(files, settings), _disc(settings)
    if settings.stick is not None:
        from vision.stick import stick_cameras

        cameras = stick_cameras(clip, settings.stick, progress, placed)
        filmed = Filmed(clip, cameras, disc)
    elif settings.camera is not None:
        cameras, notes = _given_cameras(clip, settings.camera, settings, progress, placed)
        house = HOUSE if settings.radius == STONE.radius else None
        filmed = Filmed(clip, cameras, disc, house, notes)
    else:
        followed = _follow(clip, settings, progress, placed)
        house = House(*(float(radius) for radius in followed.radii))
        filmed = Filmed(clip, followed.cameras, disc, house, followed.warnings)
    _check_size(settings.radius, filmed.cameras[0])
    return filmed


def _open_clip(files: tuple[Path, ...], settings: Settings) -> Clip:
    """Open a video, pictures, or the clip of a Tracker project."""
    from data.project import ENDINGS
    from vision.clip import open_clip

    kinds = [path.suffix.lower() for path in files]
    if SPREADSHEETS.intersection(kinds):
        raise InputError(f"{files[0]}: a spreadsheet; save it as CSV")
    if not TABLES.intersection(kinds):
        return open_clip(files, settings.fps, settings.frames)
    if len(files) > 1 or kinds[0] not in ENDINGS:
        odd = files[0] if kinds[0] not in ENDINGS else files[1]
        raise InputError(f"{odd}: not a clip; name a video, pictures, or one Tracker project")
    from vision.project_clip import open_project_clip

    clip = open_project_clip(files[0], settings.tab, settings.frames)
    if settings.fps is not None:
        clip.warnings.append(f"{files[0]}: a project says how long frames last; --fps is ignored")
    return clip


def _given_cameras(
    clip: Clip, path: Path, settings: Settings, progress: Progress, placed: Placed
) -> tuple[tuple[Camera, ...], tuple[str, ...]]:
    """Read the cameras of a table, or of a Tracker project."""
    from data.project import ENDINGS

    if path.suffix.lower() not in ENDINGS:
        from vision.camera_file import given_cameras

        return given_cameras(clip, path, progress, placed)
    from data.project import read_project
    from vision.project_clip import project_cameras

    project = read_project(path, settings.tab)
    return project_cameras(clip, project, settings.length_unit, progress, placed)


def _follow(clip: Clip, settings: Settings, progress: Progress, placed: Placed) -> HouseTrack:
    """Follow the house, from where a person says that it is or from where it is found."""
    from vision.follow_house import follow_house
    from vision.given import GivenHouse, follow_given

    if settings.house is None:
        return follow_house(clip, progress, placed=placed)
    frame, *points = settings.house
    return follow_given(clip, GivenHouse.of(points, frame), progress, placed)


def _check_size(radius: float, camera: Camera) -> None:
    """Refuse discs that are no more than a dot, or more than the picture."""
    pixels = radius * camera.scale_at((0.0, 0.0))
    if not 1.5 < pixels < max(camera.size):
        raise InputError(
            f"discs of radius {radius:g} m would have {pixels:.2g} px in the picture; check"
            " --radius, and --stick or --camera if given"
        )


def check(
    inputs: Sequence[str | Path],
    settings: Settings = Settings(),
    progress: Progress = no_progress,
) -> tuple[Figure, list[str]]:
    """Follow the camera and look for stones in a few frames, for a person to judge.

    Returns
    -------
    Figure
        The contact sheet (see `report.check.check_figure`).
    list of str
        The same in a few lines.

    Raises
    ------
    data.errors.CurlshotError
        Where the input cannot be used; one line says why.
    """
    import numpy as np

    from report.check import Look, check_figure, check_lines, frames_to_show
    from vision.camera import camera_table
    from vision.glance import glance
    from vision.placed import nobody

    files = find_inputs(inputs)
    seen = _film(files, settings, progress, nobody)
    clip, cameras = seen.clip, seen.cameras
    radii = () if seen.house is None else _painted(seen.house)
    table = camera_table(cameras)
    rim = radii[0] if radii else 0.0
    around = rim * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    table["sd"] = [float(np.mean(camera.place_sd(around))) for camera in cameras]
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


def analyse(measured: Measured, settings: Settings = Settings()) -> Run:
    """Tracks, estimates and simulations from sightings; writes nothing."""
    import numpy as np
    import pandas as pd

    from data.results import Input, Results
    from data.tracks import teams
    from physics.contacts import find_contacts
    from physics.estimate import estimate
    from physics.forecast import predict
    from physics.kalman import smooth
    from physics.posterior import sample_posterior, summarise
    from physics.predict import simulate_measured
    from physics.watched import LITERATURE
    from vision.camera import camera_table

    sightings, radius = measured.sightings, settings.radius
    if sightings.empty:
        raise SceneError(f"{measured.files[0]}: no stone in view; nothing to measure")
    masses = (
        _check_masses(settings.masses, list(sightings["stone"].unique())) or measured.masses or None
    )
    contacts = find_contacts(sightings, radius)
    tracks = smooth(sightings, contacts, radius=radius)
    estimates = estimate(sightings, contacts, radius=radius, masses=masses)
    sampled, scores, notes = simulate_measured(tracks, estimates, radius=radius, masses=masses)
    predictions = predict(
        sightings,
        tracks,
        estimates,
        radius=radius,
        masses=masses,
        restitution=_assumed(settings.restitution, LITERATURE.restitution),
        friction=_assumed(settings.friction, LITERATURE.friction),
    )
    of_team = teams(tracks)
    drawn = sample_posterior(estimates, settings.samples, np.random.default_rng(0))
    times = sightings["t"]
    results = Results(
        input=Input(
            files=tuple(path.name for path in measured.files),
            fps=measured.fps,
            frames=measured.frames,
            duration=float(times.max() - times.min()),
        ),
        restitution=estimates.restitution,
        friction=estimates.friction,
        collisions=estimates.collisions,
        glides=estimates.glides,
        simulations=scores,
        warnings=tuple(dict.fromkeys((*measured.warnings, *estimates.warnings, *notes))),
        radius=radius,
        predictions=predictions,
        laws=estimates.laws,
        methods=estimates.methods,
        law_choice=() if estimates.whole is None else estimates.whole.laws,
        curl=estimates.curl,
        stones=estimates.by_stone,
        posterior=None if drawn is None else summarise(drawn),
        teams={stone: team for stone, team in of_team.items() if team},
        masses=masses or {},
    )
    cameras = camera_table(measured.cameras) if measured.cameras else None
    simulations = [as_tracks(table, model, of_team) for model, table in sampled.items()]
    return Run(
        tracks,
        cameras,
        results,
        pd.concat(simulations, ignore_index=True) if simulations else as_tracks(None, ""),
        house=measured.house,
        posterior=drawn,
    )


def _assumed(given: float | None, default: Estimate) -> Estimate:
    """Return a law's number as given, then without doubt, or as the literature has it."""
    from data.results import Estimate

    return default if given is None else Estimate(given, 0.0)


def _check_masses(masses: Mapping[str, float], stones: Sequence[str]) -> Mapping[str, float]:
    """Refuse masses of some stones only, for the unit of the others would be open."""
    names = ", ".join(sorted(stones))
    unknown = sorted(set(masses) - set(stones))
    if unknown:
        raise InputError(f"mass of {', '.join(unknown)}: no such stone; there are {names}")
    missing = sorted(set(stones) - set(masses)) if masses else []
    if missing:
        raise InputError(f"no mass of {', '.join(missing)}; give one for each of {names}, or none")
    return masses


def as_tracks(
    simulated: pd.DataFrame | None, model: str, of_team: Mapping[str, str] | None = None
) -> pd.DataFrame:
    """Table of ``simulation.csv`` from a sampled simulation: nothing of it was seen."""
    from data.tracks import TRACK_COLUMNS, empty_tracks

    table = empty_tracks() if simulated is None else simulated.reindex(columns=list(TRACK_COLUMNS))
    table["seen"] = 0
    table["team"] = [(of_team or {}).get(str(name), "") for name in table["stone"]]
    table.insert(0, "model", model)
    return table


def run(
    inputs: Sequence[str | Path] = (),
    out: str | Path | None = None,
    settings: Settings = Settings(),
    progress: Progress = no_progress,
) -> Run:
    """Go the whole road: from a clip or tracks to e, μ, simulations and a report.

    Parameters
    ----------
    inputs : sequence of str or Path
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
    data.errors.CurlshotError
        Where the input cannot be used; then nothing is written.
    """
    folder = check_folder(out)
    files = find_inputs(inputs or (sample_clip(),))
    if folder is not None:
        own = {folder.resolve() / name for name in WRITTEN}
        lost = [path for path in files if path.resolve() in own]
        if lost:
            raise InputError(f"{lost[0]}: would be written over; name another folder with -o")
    measured = measure(files, settings, progress)
    done = analyse(measured, settings)
    if folder is None:
        return done
    with staged(folder, replaces=WRITTEN) as stage:
        _write_run(stage, measured, done, settings, progress)
    return replace(done, out=folder)


def run_each(
    clips: Sequence[Path],
    out: str | Path,
    settings: Settings = Settings(),
    progress: Progress = no_progress,
) -> tuple[dict[str, Run], dict[str, CurlshotError]]:
    """Run many clips, one folder of `out` for each; one that fails does not stop the others.

    Returns
    -------
    done : dict of str to Run
        By the names of their folders.
    failed : dict of str to CurlshotError
        Why the others could not be used.
    """
    folder = check_folder(out)
    assert folder is not None
    done: dict[str, Run] = {}
    failed: dict[str, CurlshotError] = {}
    for name, clip in _apart(clips).items():
        number = f"{len(done) + len(failed) + 1}/{len(clips)} "

        def numbered(what: str, at: int, total: int | None, number: str = number) -> None:
            progress(number + what, at, total)

        try:
            done[name] = run([clip], folder / name, settings, numbered)
        except CurlshotError as error:
            failed[name] = error
    return done, failed


def _apart(clips: Sequence[Path]) -> dict[str, Path]:
    """Name clips by their stems, by those of their folders too where stems are shared."""
    named: dict[str, Path] = {}
    stems = [clip.stem for clip in clips]
    for number, clip in enumerate(clips):
        name = clip.stem
        if stems.count(name) > 1:
            name = f"{clip.resolve().parent.name}-{name}"
        named[name if name not in named else f"{name}-{number + 1}"] = clip
    return named


def season(
    runs: Mapping[str, Results], out: str | Path | None = None
) -> tuple[pd.DataFrame, dict[str, Pooled]]:
    """Put many shots side by side, and say what all of them say of e and μ.

    Parameters
    ----------
    runs : mapping of str to Results
        The shots by name.
    out : str or Path, optional
        Folder for the tables and the picture; nothing is written without it.

    Returns
    -------
    shots : DataFrame
        See `physics.season.shots_table`.
    pooled : dict
        ``restitution`` and ``friction``; see `physics.pool.Pooled`.
    """
    from dataclasses import asdict

    from physics.season import hits_table, pooled, shots_table

    folder = check_folder(out)
    shots, hits = shots_table(runs), hits_table(runs)
    means = pooled(shots)
    if folder is None:
        return shots, means
    from data.files import whole_file, write_text
    from data.tracks import write_table
    from report.season import season_figure
    from report.style import PNG_DPI

    content = {"schema": 1, "shots": list(runs), **{k: asdict(v) for k, v in means.items()}}
    with staged(folder) as stage:
        write_table(shots, stage / "shots.csv")
        write_table(hits, stage / "hits.csv")
        write_text(stage / "season.json", json.dumps(content, indent=1, ensure_ascii=False) + "\n")
        with whole_file(stage / "season.png") as part:
            season_figure(shots, hits, means).savefig(part, format="png", dpi=PNG_DPI)
    return shots, means


def find_runs(names: Sequence[str | Path]) -> dict[str, Results]:
    """Read the results of runs: of their folders, of folders of such folders, or files.

    Raises
    ------
    InputError
        Where there are none, or one is no results.json.
    """
    from data.results import Results

    found: list[Path] = []
    for path in map(Path, names):
        here = path / "results.json" if path.is_dir() else path
        below = sorted(path.glob("*/results.json")) if path.is_dir() else []
        if not here.exists() and not below:
            raise InputError(f"{here}: no such file; name the folders of runs")
        found += [here] if here.exists() else below
    unique = dict.fromkeys(path.resolve() for path in found)
    folders = _apart([path.parent.with_name(f"{path.parent.name}.run") for path in unique])
    return {name: Results.read(path) for name, path in zip(folders, unique, strict=True)}


def _write_run(
    stage: Path, measured: Measured, done: Run, settings: Settings, progress: Progress
) -> None:
    from data.tracks import write_table, write_tracks
    from report.page import write_report
    from report.provenance import Provenance, sources
    from report.tables import residual_table
    from report.units import UNITS

    write_tracks(done.tracks, stage / "tracks.csv")
    write_table(done.simulations, stage / "simulation.csv")
    done.results.write(stage / "results.json")
    if done.cameras is not None:
        write_table(done.cameras, stage / "camera.csv")
    if done.posterior is not None:
        write_table(done.posterior, stage / "posterior.csv")
    house = measured.house
    overlay: Path | None = None
    clip_start = 0.0
    if measured.clip is not None and settings.overlay:
        from report.overlay import write_overlay

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
        residuals=residual_table(measured.sightings, done.tracks),
        posterior=done.posterior,
        unit=UNITS[settings.units],
        provenance=Provenance(
            VERSION,
            again(measured.files, vars(settings), vars(Settings())),
            sources(measured.files),
        ),
    )
    progress("report", 1, 1)


def convert(
    inputs: Sequence[str | Path],
    out: str | Path,
    settings: Settings = Settings(),
    over: str | Path | None = None,
) -> Measured:
    """Write tracks in another form, by the ending of `out`: .txt, .csv, .parquet, .trk or .trz.

    Parameters
    ----------
    inputs : sequence of str or Path
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
    data.errors.CurlshotError
        Where the input cannot be used, or there is no such form; then nothing is written.
    """
    from data.export import PROJECTS, WRITERS, check_target

    path = Path(out)
    files = find_inputs(inputs)
    check_target(path, files)
    _refuse_clips(files, "track")
    ending = path.suffix.lower()
    if over is not None and ending not in PROJECTS:
        raise InputError(f"{path}: only a .trk or .trz shows tracks over a clip (--over)")
    measured = _import_tables(files, settings)
    if ending in PROJECTS:
        return _write_project(measured, path, over)
    WRITERS[ending](measured.sightings, path)
    return measured


def convert_each(
    inputs: Sequence[str | Path], out: str | Path, settings: Settings = Settings()
) -> dict[Path, Measured | CurlshotError]:
    """Write each of many tables into a file of its own, of the same name with another ending.

    Parameters
    ----------
    inputs : sequence of str or Path
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
    data.errors.CurlshotError
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
    from data.trk_write import plain_view, project_xml, write_trk, write_trz

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
        from vision.clip import open_clip
        from vision.tracker_view import view_over

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


# ---------------------------------------------------------------------------------------
# The command line
# ---------------------------------------------------------------------------------------


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of the command; returns its exit code (0 well, 2 a person's mistake)."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without Greek letters gets "?"
    arguments = command_line(VERSION).parse_args(argv)
    bars = Bars(quiet=arguments.quiet)
    try:
        text = WORK[arguments.command](arguments, bars)
    except CurlshotError as error:
        bars.close()
        print(f"curlshot: {_one_line(str(error))}", file=sys.stderr)
        return 2
    except OSError as error:
        bars.close()
        where = f"{error.filename}: " if error.filename else ""
        print(f"curlshot: {where}{error.strerror or error}", file=sys.stderr)
        return 2
    except MemoryError:
        bars.close()
        print("curlshot: not enough memory; try fewer or smaller pictures", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        bars.close()
        print("curlshot: stopped; what was under way is not written", file=sys.stderr)
        return 130
    bars.close()
    try:
        print(text, flush=True)
    except BrokenPipeError:
        # The reader, such as head, has had enough; Python would complain again at its exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _by_stone(option: str, pairs: Sequence[tuple[str, T]]) -> dict[str, T]:
    stones = [stone for stone, _ in pairs]
    doubled = [stone for stone in stones if stones.count(stone) > 1]
    if doubled:
        raise InputError(f"{option}: {doubled[0]} is given twice")
    return dict(pairs)


def _settings(arguments: argparse.Namespace) -> Settings:
    known = vars(arguments)
    return Settings(
        fps=known.get("fps"),
        frames=known.get("frames"),
        stick=known.get("stick"),
        house=known.get("house"),
        camera=known.get("camera"),
        radius=known.get("radius", STONE.radius),
        masses=_by_stone("--mass", known.get("mass", ())),
        length_unit=known.get("length_unit", "m"),
        angle_unit=known.get("angle_unit"),
        clip=known.get("clip", False),
        tab=known.get("tab"),
        names=_by_stone("--names", known.get("names", [])),
        angles={s: Path(p) for s, p in _by_stone("--angles", known.get("angles", [])).items()},
        overlay=not known.get("no_overlay", False),
        restitution=known.get("restitution"),
        friction=known.get("friction"),
        samples=known.get("samples") or 0,
        units=known.get("units", "m"),
    )


def _out(arguments: argparse.Namespace, first: str | Path) -> Path:
    """Folder for the files: as given, else NAME-curlshot in the current folder."""
    if arguments.out is not None:
        return Path(arguments.out)
    path = Path(first)
    name = path.name if path.is_dir() else path.stem
    plain = re.sub(r"[*?\[\]]", "", name)  # a glob's signs do not belong in a name
    return Path(f"{plain or 'out'}-curlshot")


def _stale(folder: Path, inputs: Sequence[Path]) -> tuple[str, ...]:
    """Names of what an earlier run left in `folder`, without the inputs and their cameras."""
    kept = {path.name for path in inputs if path.resolve().parent == folder.resolve()}
    if "tracks.csv" in kept:
        kept.add("camera.csv")
    return tuple(name for name in WRITTEN if name not in kept)


def _do_run(arguments: argparse.Namespace, bars: Bars) -> str:
    from report.summary import summary
    from report.units import UNITS

    inputs = arguments.inputs or [sample_clip()]
    files = find_inputs(inputs)
    if len(files) > 1 and not any(f.suffix.lower() in TABLES | IMAGE_SUFFIXES for f in files):
        return _run_season(arguments, files, bars)
    folder = _out(arguments, inputs[0])
    done = run(inputs, folder, _settings(arguments), bars)
    return summary(done.results, done.tracks, folder, done.house, UNITS[arguments.units])


def _run_season(arguments: argparse.Namespace, clips: Sequence[Path], bars: Bars) -> str:
    from report.summary import season_text

    folder = Path(arguments.out or "season")
    done, failed = run_each(clips, folder, _settings(arguments), bars)
    if not done:
        name, error = next(iter(failed.items()))
        raise InputError(f"none of {len(clips)} clips could be used; {name}: {error}")
    shots, means = season({name: run.results for name, run in done.items()}, folder)
    failures = [f"{name:<24s} not used: {_one_line(str(why))}" for name, why in failed.items()]
    return "\n".join([*season_text(shots, means), *failures, f"written     {folder}"])


def _do_season(arguments: argparse.Namespace, _: Bars) -> str:
    from report.summary import season_text

    folder = Path(arguments.out or "season")
    shots, means = season(find_runs(arguments.runs), folder)
    written = ", ".join(str(folder / name) for name in SEASON)
    return "\n".join([*season_text(shots, means), f"written     {written}"])


def _do_track(arguments: argparse.Namespace, bars: Bars) -> str:
    from data.tracks import write_table, write_tracks
    from physics.contacts import find_contacts
    from physics.kalman import smooth
    from report.numbers import count
    from vision.camera import camera_table

    settings, folder = _settings(arguments), _out(arguments, arguments.inputs[0])
    check_folder(folder)
    measured = measure(arguments.inputs, replace(settings, clip=True), bars)
    contacts = find_contacts(measured.sightings, settings.radius)
    tracks = smooth(measured.sightings, contacts, radius=settings.radius)
    with staged(folder, replaces=_stale(folder, measured.files)) as stage:
        write_tracks(tracks, stage / "tracks.csv")
        write_table(camera_table(measured.cameras), stage / "camera.csv")
    lines = [
        f"{count(tracks['stone'].nunique(), 'stone')} in {count(measured.frames, 'frame')}: "
        f"{folder / 'tracks.csv'}, {folder / 'camera.csv'}"
    ]
    return "\n".join(lines + [f"warning: {text}" for text in measured.warnings])


def _do_check(arguments: argparse.Namespace, bars: Bars) -> str:
    from data.files import whole_file

    settings, folder = _settings(arguments), _out(arguments, arguments.inputs[0])
    check_folder(folder)
    figure, lines = check(arguments.inputs, settings, bars)
    with staged(folder) as stage, whole_file(stage / "check.png") as part:
        figure.savefig(part, format="png", dpi=CHECK_DPI)
    return "\n".join([*lines, f"written     {folder / 'check.png'}"])


def _do_estimate(arguments: argparse.Namespace, bars: Bars) -> str:
    from data.tracks import write_table
    from report.summary import summary
    from report.units import UNITS

    settings, folder = _settings(arguments), _out(arguments, arguments.inputs[0])
    check_folder(folder)
    _refuse_clips(find_inputs(arguments.inputs), "run")
    measured = measure(arguments.inputs, settings, bars)
    done = analyse(measured, settings)
    with staged(folder, replaces=_stale(folder, measured.files)) as stage:
        done.results.write(stage / "results.json")
        if done.posterior is not None:
            write_table(done.posterior, stage / "posterior.csv")
    return summary(done.results, done.tracks, folder, done.house, UNITS[arguments.units])


def _do_convert(arguments: argparse.Namespace, _: Bars) -> str:
    from report.numbers import count

    if Path(arguments.out).suffix == "" and Path(arguments.out).name.startswith("."):
        return _convert_each(arguments)
    measured = convert(arguments.inputs, arguments.out, _settings(arguments), arguments.over)
    stones = measured.sightings["stone"].nunique()
    lines = [f"{count(stones, 'stone')} in {count(measured.frames, 'frame')}: {arguments.out}"]
    return "\n".join(lines + [f"warning: {text}" for text in measured.warnings])


def _convert_each(arguments: argparse.Namespace) -> str:
    from report.numbers import count

    if arguments.over is not None:
        raise InputError("--over: one clip cannot be behind many projects; convert one at a time")
    done = convert_each(arguments.inputs, arguments.out, _settings(arguments))
    refused = [refusal for refusal in done.values() if isinstance(refusal, CurlshotError)]
    lines = [f"{count(len(done) - len(refused), 'file')} written"]
    for path, outcome in done.items():
        if not isinstance(outcome, CurlshotError):
            lines += [str(path), *(f"warning: {text}" for text in outcome.warnings)]
    if refused:
        reasons = "; ".join(str(refusal) for refusal in refused)
        rest = ", the others were" if len(refused) < len(done) else ""
        raise InputError(f"{len(refused)} of {len(done)} not converted{rest}: {reasons}")
    return "\n".join(lines)


def _do_simulate(arguments: argparse.Namespace, bars: Bars) -> str:
    import numpy as np

    from data.tracks import write_table
    from physics.simulate import simulate
    from physics.what_if import Changes, changed
    from report.summary import odds_text, simulation_json, simulation_text

    folder = _out(arguments, arguments.shot)
    check_folder(folder)
    start = _read_start(arguments.shot, folder)
    changes = Changes(
        arguments.restitution,
        arguments.friction,
        arguments.speed,
        arguments.spin,
        arguments.aim_offset,
    )
    start = changed(start, changes)
    simulation = simulate(start.shot)
    end = max((rest.t for rest in simulation.rest.values()), default=0.0)
    if end * arguments.fps > MOST_SAMPLES:
        raise InputError(
            f"--fps {arguments.fps:g}: {end:.0f} s would be {end * arguments.fps:.1g} samples a"
            f" stone; at most {MOST_SAMPLES:g}, please"
        )
    times = np.append(np.arange(0.0, end, 1 / arguments.fps), end)
    table = as_tracks(simulation.sample(times), start.shot.impact.name)
    throws = arguments.samples
    if throws is None:
        throws = MEASURED_THROWS if arguments.shot.suffix.lower() == ".json" else 0
    outcome = simulation_json(simulation)
    lines = [simulation_text(simulation, folder / "simulation.csv")]
    with staged(folder, replaces=WHAT_IF) as stage:
        write_table(table, stage / "simulation.csv")
        if throws:
            odds = _write_odds(stage, start, changes, throws, arguments)
            outcome = {"nominal": outcome, **odds}
            lines += odds_text(odds, [folder / name for name in WHAT_IF])
    lines += [f"warning: {text}" for text in start.assumed]
    return json.dumps(outcome, indent=1) if arguments.json else "\n".join(lines)


def _read_start(path: Path, folder: Path) -> Start:
    """Read the shot to simulate: written by hand, or measured."""
    from data.results import Results
    from data.tracks import read_tracks
    from physics.shot import read_shot
    from physics.start import measured_start, written_start

    if path.suffix.lower() != ".json":
        return written_start(read_shot(path))
    results = Results.read(path)
    tracks = path.parent / "tracks.csv"
    if not tracks.exists():
        raise InputError(f"{tracks}: no such file; it belongs beside {path.name}")
    if folder.resolve() == path.parent.resolve():
        raise InputError(f"{folder}: holds the run itself; name another folder with -o")
    return measured_start(read_tracks(tracks), results)


def _write_odds(
    stage: Path, start: Start, changes: Changes, count: int, arguments: argparse.Namespace
) -> dict[str, Any]:
    """Throw a shot many times; write where it ends, and give the content of whatif.json."""
    from dataclasses import asdict

    from data.files import whole_file, write_text
    from data.tracks import write_table
    from physics.what_if import THROW_SD, Changes, odds, sample
    from report.style import PNG_DPI
    from report.whatif import spread_figure

    throw_sd = arguments.throw_sd or THROW_SD
    outcomes = sample(start, count, throw_sd)
    stones = start.shot.stones
    thrown = stones[start.thrown].name
    content = {
        "schema": 1,
        "input": arguments.shot.name,
        "thrown": thrown,
        "changes": {
            key: value for key, value in asdict(changes).items() if value != getattr(Changes, key)
        },
        "samples": count,
        "throw_sd": {"speed": throw_sd[0], "direction": throw_sd[1]},
        "stones": {name: asdict(item) for name, item in odds(outcomes, start).items()},
        "warnings": list(start.assumed),
    }
    write_table(outcomes, stage / "outcomes.csv")
    write_text(stage / "whatif.json", json.dumps(content, indent=1, ensure_ascii=False) + "\n")
    figure = spread_figure(
        outcomes,
        {stone.name: (stone.x, stone.y) for stone in stones},
        thrown,
        f"{thrown} thrown {count} times",
        start.shot.radius,
    )
    with whole_file(stage / "spread.png") as part:
        figure.savefig(part, format="png", dpi=PNG_DPI)
    return content


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
