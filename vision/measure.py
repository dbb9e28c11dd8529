"""Measure a clip: its cameras, by its house, a stick or as given, and the stones in it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.config import Config, refuse_table_settings
from curlshot.data.errors import InputError
from curlshot.data.inputs import IMAGE_SUFFIXES, PROJECT_SUFFIXES
from curlshot.data.measurement import Measurement
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import HOUSE, STONE, House, Stone, curling_size

if TYPE_CHECKING:
    from curlshot.vision.camera_path.joint import HouseTrack
    from curlshot.vision.optics.camera import Camera
    from curlshot.vision.optics.placed import Placed
    from curlshot.vision.video.frame import Frame
    from curlshot.vision.video.reader import Video

STONE_RADII = (0.12, 0.18)
"""m; below it a cap leaves hardly any granite to see, above it are diameters."""


@dataclass(frozen=True)
class CameraTrack:
    """The cameras of a clip, one per frame that is yielded, and what is known of the scene."""

    cameras: tuple[Camera, ...]
    disc: Stone
    house: House | None = None
    warnings: tuple[str, ...] = ()


def track_camera(
    video: Video,
    config: Config,
    progress: Progress = no_progress,
    placed: Placed = lambda frame, camera: None,
) -> CameraTrack:
    """Find the camera of each frame of a clip, in one pass over it.

    Parameters
    ----------
    video : Video
        Where the house is found by itself, its black bars are cut off from now on.
    config : Config
        What is known of the clip.
    progress : callable
        Called as the work goes on.
    placed : callable
        Called with each frame and its camera, which may be provisional.

    Returns
    -------
    CameraTrack
        With the true times, in pixels of the frames that `video` yields.

    Raises
    ------
    InputError
        Where the settings do not fit the clip.
    SceneError
        Where no house is found.
    """
    disc, file = disc_of(config), video.files[0]
    refuse_table_settings(file, config)
    house: House | None = None
    warnings: tuple[str, ...] = ()
    if config.camera.stick is not None:
        from curlshot.vision.optics.stick import stick_cameras

        cameras = stick_cameras(video, config.camera.stick, progress, placed)
    elif config.camera.camera is not None:
        cameras, warnings = _given_cameras(video, config.camera.camera, config, progress, placed)
        house = HOUSE if curling_size(config.stones.radius) else None
    else:
        if config.camera.house is None:
            video.cut_bars(progress)
        followed = _follow(video, config, progress, placed)
        house = House(*(float(radius) for radius in followed.radii))
        cameras, warnings = followed.cameras, followed.warnings
    cameras = video.retime(cameras)
    if not cameras:
        raise InputError(f"{file}: none of the selected frames can be read")
    check_size(config.stones.radius, cameras[0])
    return CameraTrack(cameras, disc, house, warnings)


def _given_cameras(
    video: Video, path: Path, config: Config, progress: Progress, placed: Placed
) -> tuple[tuple[Camera, ...], tuple[str, ...]]:
    """Read the cameras of a table, or of a Tracker project."""
    if path.suffix.lower() not in PROJECT_SUFFIXES:
        from curlshot.vision.optics.camera_file import given_cameras

        return given_cameras(video, path, progress, placed)
    from curlshot.data.project import read_project
    from curlshot.vision.optics.project_clip import project_cameras

    project = read_project(path, config.video.tab)
    return project_cameras(video, project, config.tables.length_unit, progress, placed)


def _follow(video: Video, config: Config, progress: Progress, placed: Placed) -> HouseTrack:
    """Follow the house, from where a person says that it is or from where it is found."""
    if config.camera.house is None:
        from curlshot.vision.camera_path.follow_house import follow_house

        return follow_house(video, progress, placed=placed, height=config.camera.camera_height)
    from curlshot.vision.camera_path.given import GivenHouse, follow_given

    frame, *points = config.camera.house
    given = GivenHouse.of(points, frame)
    return follow_given(video, given, progress, placed, config.camera.camera_height)


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
    from curlshot.vision.track import tracks_of
    from curlshot.vision.video.reader import open_video

    disc, video = disc_of(config), open_video(files, config.video)
    alone = len(files) == 1 and files[0].suffix.lower() in IMAGE_SUFFIXES
    # A picture by itself has one chance.
    fine, rough = (Search.of(config.search, clip=clip) for clip in (False, True))
    watch = Watch(disc, fine if alone else rough, fine)

    def look(frame: Frame, camera: Camera) -> None:
        if not watch.begun:
            check_size(config.stones.radius, camera)
        watch.look(frame, camera)

    seen = track_camera(video, config, progress, look)
    stones = tracks_of(watch, seen.cameras)
    return Measurement(
        files,
        stones.table,
        video.fps,
        video.decoded,
        (*video.warnings, *seen.warnings, *stones.warnings),
        video,
        video.finish(seen.cameras),
        seen.house,
        duplicates=video.duplicates,
    )
