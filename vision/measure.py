"""Measure a clip: its cameras, by its house, a stick or as given, and the stones in it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.config import Config, refuse_table_settings
from curlshot.data.errors import InputError
from curlshot.data.inputs import (
    IMAGE_SUFFIXES,
    PROJECT_SUFFIXES,
    SPREADSHEET,
    SPREADSHEETS,
    TABLE_SUFFIXES,
)
from curlshot.data.measurement import Measurement
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import HOUSE, STONE, House, Stone, curling_size

if TYPE_CHECKING:
    from curlshot.vision.camera_path.joint import HouseTrack
    from curlshot.vision.film.clip import Clip, Frame
    from curlshot.vision.optics.camera import Camera
    from curlshot.vision.optics.placed import Placed

STONE_RADII = (0.12, 0.18)
"""m; below it a cap leaves hardly any granite to see, above it are diameters."""


@dataclass(frozen=True)
class Filmed:
    """A clip with its cameras, without black bars, and what is known of the scene."""

    clip: Clip
    cameras: tuple[Camera, ...]
    disc: Stone
    house: House | None = None
    warnings: tuple[str, ...] = ()


def film(files: tuple[Path, ...], config: Config, progress: Progress, placed: Placed) -> Filmed:
    """Open a clip, read it and find its cameras; `placed` is told of each frame on the way."""
    clip, disc = _open_clip(files, config), disc_of(config)
    refuse_table_settings(files[0], config)
    if config.camera.stick is not None:
        from curlshot.vision.optics.stick import stick_cameras

        cameras = stick_cameras(clip, config.camera.stick, progress, placed)
        filmed = Filmed(clip, cameras, disc)
    elif config.camera.camera is not None:
        cameras, notes = _given_cameras(clip, config.camera.camera, config, progress, placed)
        house = HOUSE if curling_size(config.stones.radius) else None
        filmed = Filmed(clip, cameras, disc, house, notes)
    else:
        if config.camera.house is None:
            from curlshot.vision.optics.letterbox import lit_clip

            clip = lit_clip(clip, progress)
        followed = _follow(clip, config, progress, placed)
        house = House(*(float(radius) for radius in followed.radii))
        filmed = Filmed(clip, followed.cameras, disc, house, followed.warnings)
    if clip.cadence is not None:
        from curlshot.vision.optics.camera import taken_at

        filmed = replace(filmed, cameras=taken_at(filmed.cameras, clip.cadence.times))
    if not filmed.cameras:
        raise InputError(f"{files[0]}: none of the selected frames can be read")
    check_size(config.stones.radius, filmed.cameras[0])
    return filmed


def _open_clip(files: tuple[Path, ...], config: Config) -> Clip:
    """Open a video, pictures, or the clip of a Tracker project."""
    from curlshot.vision.film.clip import open_clip

    kinds = [path.suffix.lower() for path in files]
    if SPREADSHEETS.intersection(kinds):
        raise InputError(f"{files[0]}: {SPREADSHEET}")
    if not TABLE_SUFFIXES.intersection(kinds):
        return open_clip(files, config.video.fps, config.video.frames)
    if len(files) > 1 or kinds[0] not in PROJECT_SUFFIXES:
        odd = files[0] if kinds[0] not in PROJECT_SUFFIXES else files[1]
        raise InputError(f"{odd}: not a clip; name a video, pictures, or one Tracker project")
    from curlshot.vision.optics.project_clip import open_project_clip

    clip = open_project_clip(files[0], config.video.tab, config.video.frames)
    if config.video.fps is not None:
        clip.warnings.append(
            f"{files[0]}: the project gives the duration of a frame; `fps` is ignored"
        )
    return clip


def _given_cameras(
    clip: Clip, path: Path, config: Config, progress: Progress, placed: Placed
) -> tuple[tuple[Camera, ...], tuple[str, ...]]:
    """Read the cameras of a table, or of a Tracker project."""
    if path.suffix.lower() not in PROJECT_SUFFIXES:
        from curlshot.vision.optics.camera_file import given_cameras

        return given_cameras(clip, path, progress, placed)
    from curlshot.data.project import read_project
    from curlshot.vision.optics.project_clip import project_cameras

    project = read_project(path, config.video.tab)
    return project_cameras(clip, project, config.tables.length_unit, progress, placed)


def _follow(clip: Clip, config: Config, progress: Progress, placed: Placed) -> HouseTrack:
    """Follow the house, from where a person says that it is or from where it is found."""
    if config.camera.house is None:
        from curlshot.vision.camera_path.follow_house import follow_house

        return follow_house(clip, progress, placed=placed, height=config.camera.camera_height)
    from curlshot.vision.camera_path.given import GivenHouse, follow_given

    frame, *points = config.camera.house
    given = GivenHouse.of(points, frame)
    return follow_given(clip, given, progress, placed, config.camera.camera_height)


def check_size(radius: float, camera: Camera) -> None:
    """Refuse discs that are no more than a dot, or more than the picture."""
    pixels = radius * float(camera.scale_at((0.0, 0.0)))
    if not 1.5 < pixels < max(camera.size):
        raise InputError(
            f"discs of radius {radius:g} m would have {pixels:.2g} px in the frame; verify"
            " `radius`, and `stick` or `camera` if given"
        )


def disc_of(config: Config) -> Stone:
    """Say what is looked for: stones in a house or of their size, else plain discs.

    Raises
    ------
    InputError
        Discs in a house of a size at which no granite is left about a cap, or whose diameter was
        given.
    """
    from curlshot.vision.detection.stones import plain_disc

    sized_as_stones = config.camera.camera is None or curling_size(config.stones.radius)
    if config.camera.stick is not None or not sized_as_stones:
        return plain_disc(config.stones.radius)
    least, most = STONE_RADII
    if not least <= config.stones.radius <= most:
        raise InputError(
            f"radius {config.stones.radius:g} m: in a house the discs must be stones,"
            f" {STONE.radius:g} m ({least:g} to {most:g} are accepted); for other discs give the"
            " scale with `stick` or `camera`"
        )
    return replace(STONE, radius=config.stones.radius)


def measure_clip(
    files: tuple[Path, ...], config: Config = Config(), progress: Progress = no_progress
) -> Measurement:
    """Measure the camera and every stone of a clip, in one pass over its frames.

    Parameters
    ----------
    files : tuple of Path
        A video, pictures, or a Tracker project with its clip.
    config : Config
        What is known of the clip.
    progress : callable
        Called as the work goes on.

    Returns
    -------
    Measurement
        Detections, by stone and time, and a camera per frame.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the clip cannot be used; one line says why.
    """
    from curlshot.vision.association.watch import Watch
    from curlshot.vision.detection.stones import Search
    from curlshot.vision.optics.camera import carried
    from curlshot.vision.optics.letterbox import in_whole
    from curlshot.vision.track import tracks_of

    alone = len(files) == 1 and files[0].suffix.lower() in IMAGE_SUFFIXES
    # A picture by itself has one chance.
    fine, rough = (Search.of(config.search, clip=clip) for clip in (False, True))
    watch = Watch(disc_of(config), fine if alone else rough, fine)

    def look(frame: Frame, camera: Camera) -> None:
        if not watch.begun:
            check_size(config.stones.radius, camera)
        watch.look(frame, camera)

    seen = film(files, config, progress, look)
    stones = tracks_of(watch, seen.cameras)
    clip, cameras = in_whole(seen.clip, seen.cameras)
    repeated = clip.repeated
    return Measurement(
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
