"""A clip with its cameras: by its house, a stick, or as a person knows them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.data.errors import InputError
from curlshot.data.inputs import PROJECT_SUFFIXES, SPREADSHEET, SPREADSHEETS, TABLE_SUFFIXES
from curlshot.data.progress import Progress
from curlshot.data.sheet import HOUSE, STONE, House, Stone, curling_size
from curlshot.work.settings import Settings, refuse_table_options

if TYPE_CHECKING:
    from curlshot.vision.camera_path.joint import HouseTrack
    from curlshot.vision.film.clip import Clip
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


def film(files: tuple[Path, ...], settings: Settings, progress: Progress, placed: Placed) -> Filmed:
    """Open a clip, read it and find its cameras; `placed` is told of each frame on the way."""
    clip, disc = _open_clip(files, settings), disc_of(settings)
    refuse_table_options(files[0], settings)
    if settings.stick is not None:
        from curlshot.vision.optics.stick import stick_cameras

        cameras = stick_cameras(clip, settings.stick, progress, placed)
        filmed = Filmed(clip, cameras, disc)
    elif settings.camera is not None:
        cameras, notes = _given_cameras(clip, settings.camera, settings, progress, placed)
        house = HOUSE if curling_size(settings.radius) else None
        filmed = Filmed(clip, cameras, disc, house, notes)
    else:
        if settings.house is None:
            from curlshot.vision.optics.letterbox import lit_clip

            clip = lit_clip(clip, progress)
        followed = _follow(clip, settings, progress, placed)
        house = House(*(float(radius) for radius in followed.radii))
        filmed = Filmed(clip, followed.cameras, disc, house, followed.warnings)
    if clip.cadence is not None:
        from curlshot.vision.optics.camera import taken_at

        filmed = replace(filmed, cameras=taken_at(filmed.cameras, clip.cadence.times))
    if not filmed.cameras:
        raise InputError(f"{files[0]}: none of the frames that are used can be read")
    check_size(settings.radius, filmed.cameras[0])
    return filmed


def _open_clip(files: tuple[Path, ...], settings: Settings) -> Clip:
    """Open a video, pictures, or the clip of a Tracker project."""
    from curlshot.vision.film.clip import open_clip

    kinds = [path.suffix.lower() for path in files]
    if SPREADSHEETS.intersection(kinds):
        raise InputError(f"{files[0]}: {SPREADSHEET}")
    if not TABLE_SUFFIXES.intersection(kinds):
        return open_clip(files, settings.fps, settings.frames)
    if len(files) > 1 or kinds[0] not in PROJECT_SUFFIXES:
        odd = files[0] if kinds[0] not in PROJECT_SUFFIXES else files[1]
        raise InputError(f"{odd}: not a clip; name a video, pictures, or one Tracker project")
    from curlshot.vision.optics.project_clip import open_project_clip

    clip = open_project_clip(files[0], settings.tab, settings.frames)
    if settings.fps is not None:
        clip.warnings.append(f"{files[0]}: a project says how long frames last; --fps is ignored")
    return clip


def _given_cameras(
    clip: Clip, path: Path, settings: Settings, progress: Progress, placed: Placed
) -> tuple[tuple[Camera, ...], tuple[str, ...]]:
    """Read the cameras of a table, or of a Tracker project."""
    if path.suffix.lower() not in PROJECT_SUFFIXES:
        from curlshot.vision.optics.camera_file import given_cameras

        return given_cameras(clip, path, progress, placed)
    from curlshot.data.project import read_project
    from curlshot.vision.optics.project_clip import project_cameras

    project = read_project(path, settings.tab)
    return project_cameras(clip, project, settings.length_unit, progress, placed)


def _follow(clip: Clip, settings: Settings, progress: Progress, placed: Placed) -> HouseTrack:
    """Follow the house, from where a person says that it is or from where it is found."""
    if settings.house is None:
        from curlshot.vision.camera_path.follow_house import follow_house

        return follow_house(clip, progress, placed=placed, height=settings.camera_height)
    from curlshot.vision.camera_path.given import GivenHouse, follow_given

    frame, *points = settings.house
    given = GivenHouse.of(points, frame)
    return follow_given(clip, given, progress, placed, settings.camera_height)


def check_size(radius: float, camera: Camera) -> None:
    """Refuse discs that are no more than a dot, or more than the picture."""
    pixels = radius * float(camera.scale_at((0.0, 0.0)))
    if not 1.5 < pixels < max(camera.size):
        raise InputError(
            f"discs of radius {radius:g} m would have {pixels:.2g} px in the picture; check"
            " --radius, and --stick or --camera if given"
        )


def disc_of(settings: Settings) -> Stone:
    """Say what is looked for: stones in a house or of their size, else plain discs.

    Raises
    ------
    InputError
        Discs in a house of a size at which no granite is left about a cap, or whose diameter was
        given.
    """
    from curlshot.vision.detection.stones import plain_disc

    sized_as_stones = settings.camera is None or curling_size(settings.radius)
    if settings.stick is not None or not sized_as_stones:
        return plain_disc(settings.radius)
    least, most = STONE_RADII
    if not least <= settings.radius <= most:
        raise InputError(
            f"radius {settings.radius:g} m: in a house stones are looked for, which have"
            f" {STONE.radius:g} m ({least:g} to {most:g} are taken); for other discs give the scale"
            " with --stick or --camera"
        )
    return replace(STONE, radius=settings.radius)
