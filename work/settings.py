"""What a person may say about the input."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from data.errors import InputError
from data.inputs import PROJECT_SUFFIXES
from data.sheet import STONE
from data.units import check_units
from work.limits import ANY, FRACTION, FRAME, FRICTION, POSITIVE, RADIUS, SAMPLES, has_length

COACHES = ("m", "ft")
"""Units of what coaches read."""


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
        project, whose coordinate system is the camera. With a radius other than a curling
        stone's, the discs are looked for as plain ones on no house.
    radius : float
        Radius of the discs, m.
    masses : mapping
        Masses by stone, in any unit, where they are not all equal.
    length_unit, angle_unit : str, optional
        Units of tables; as these say, else m and by evidence, where not given.
    no_house : bool
        Whether the origin of tables is not the tee of a house.
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
        More than one of stick, house and camera, a unit that is unknown, or a number that makes no
        sense.
    """

    fps: float | None = None
    frames: tuple[int, int | None] | None = None
    stick: tuple[float, float, float, float, float] | None = None
    house: tuple[int | None, float, float, float, float, float, float] | None = None
    camera: Path | None = None
    radius: float = STONE.radius
    masses: Mapping[str, float] = field(default_factory=dict)
    length_unit: str | None = None
    angle_unit: str | None = None
    no_house: bool = False
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
        check_units(self.length_unit, self.angle_unit, self.fps)
        if self.units not in COACHES:
            raise InputError(f"units {self.units!r}: one of {', '.join(COACHES)}, please")
        if self.frames is not None:
            first, last = _parts("frames", self.frames, 2)
            FRAME.check("frames", first)
            if last is not None:
                FRAME.check("frames", last)
        if self.stick is not None:
            for part in _parts("stick", self.stick, 5):
                ANY.check("stick", part)
            if not has_length(self.stick):
                raise InputError(f"stick {self.stick}: has no length")
        if self.house is not None:
            frame, *points = _parts("house", self.house, 7)
            if frame is not None:
                FRAME.check("house", frame)
            for part in points:
                ANY.check("house", part)
        RADIUS.check("radius", self.radius)
        SAMPLES.check("samples", self.samples)
        for name in ("masses", "names", "angles"):
            if not isinstance(getattr(self, name), Mapping):
                raise InputError(f"{name}: by stone, please, as in {name}={{'A': …}}")
        for stone, mass in self.masses.items():
            POSITIVE.check(f"mass of {stone}", mass)
        # From Python a path may be a string.
        if self.camera is not None:
            object.__setattr__(self, "camera", Path(self.camera))
        angles = {stone: Path(path) for stone, path in self.angles.items()}
        object.__setattr__(self, "angles", angles)
        if self.restitution is not None:
            FRACTION.check("restitution", self.restitution)
        if self.friction is not None:
            FRICTION.check("friction", self.friction)


def _parts(name: str, given: object, count: int) -> Sequence[Any]:
    """Give the parts of a value that has so many."""
    if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != count:
        raise InputError(f"{name} {given!r}: {count} values, please")
    return given


def refuse_table_options(path: Path, settings: Settings) -> None:
    """Refuse to pass over what a person says about tables where a clip is measured.

    Tabs and lengths of a project count there too, be it the clip's own or the camera's.
    """
    said: dict[str, object] = {"--names": settings.names, "--angles": settings.angles}
    said["--angle-unit"], said["--no-house"] = settings.angle_unit, settings.no_house
    sources = [path] if settings.camera is None else [path, settings.camera]
    if not any(source.suffix.lower() in PROJECT_SUFFIXES for source in sources):
        said["--tab"] = settings.tab
        said["--length-unit"] = settings.length_unit
    given = [name for name, value in said.items() if value]
    if given:
        raise InputError(f"{path}: only tables take {', '.join(given)}; a clip is measured here")


def refuse_clip_options(path: Path, settings: Settings) -> None:
    """Refuse to pass over what a person says about a clip where tracks are read."""
    said = {"--stick": settings.stick, "--house": settings.house, "--camera": settings.camera}
    given = [name for name, value in {**said, "--frames": settings.frames}.items() if value]
    if given:
        clip = "; add --clip to measure its clip" if path.suffix.lower() in PROJECT_SUFFIXES else ""
        raise InputError(f"{path}: only clips take {', '.join(given)}; tracks are read here{clip}")
