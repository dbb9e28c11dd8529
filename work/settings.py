"""What a person may say about the input."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path

from curlshot.data.coach_units import UNITS
from curlshot.data.errors import InputError
from curlshot.data.inputs import PROJECT_SUFFIXES
from curlshot.data.sheet import STONE
from curlshot.data.units import check_units
from curlshot.work.limits import (
    ANY,
    FRACTION,
    FRAME,
    FRICTION,
    HEIGHT,
    POSITIVE,
    RADIUS,
    SAMPLES,
    Limits,
    has_length,
)

Check = Callable[[str, object], None]
"""Raises `InputError` where a value, of that name, makes no sense."""


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
    camera_height : float, optional
        How high the camera hangs above the ice, m, to 0.1 m; where it is found by the house.
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
        More than one of stick, house and camera, a height beside one of these that tells where the
        camera is, a unit that is unknown, or a number that makes no
        sense.
    """

    fps: float | None = None
    frames: tuple[int, int | None] | None = None
    stick: tuple[float, float, float, float, float] | None = None
    house: tuple[int | None, float, float, float, float, float, float] | None = None
    camera: Path | None = None
    camera_height: float | None = None
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
        if self.camera_height is not None and given not in ([], ["--house"]):
            raise InputError(
                f"--camera-height is of a camera found by its house, not by {given[0]}"
            )
        check_units(self.length_unit, self.angle_unit, self.fps)
        for item in fields(self):
            value, check = getattr(self, item.name), _CHECKS.get(item.name)
            if check is not None and not (value is None and item.default is None):
                check(item.name, value)
        if self.stick is not None and not has_length(self.stick):
            raise InputError(f"stick {self.stick}: has no length")
        # From Python a path may be a string.
        if self.camera is not None:
            object.__setattr__(self, "camera", Path(self.camera))
        angles = {stone: Path(path) for stone, path in self.angles.items()}
        object.__setattr__(self, "angles", angles)


def _parts(*limits: tuple[Limits, bool]) -> Check:
    """Check values that are several numbers, each within its limits, or None if that is allowed."""

    def check(name: str, given: object) -> None:
        several = isinstance(given, Sequence) and not isinstance(given, str)
        if not several or len(given) != len(limits):  # type: ignore[arg-type]
            raise InputError(f"{name} {given!r}: {len(limits)} values, please, in a tuple")
        for part, (limit, none) in zip(given, limits, strict=True):  # type: ignore[call-overload]
            if not (none and part is None):
                limit.check(name, part)

    return check


def _by_stone(each: Check, what: str) -> Check:
    """Check values by stone; `what` says what one is."""

    def check(name: str, given: object) -> None:
        if not isinstance(given, Mapping):
            raise InputError(f"{name}: by stone, please, as in {name}={{'A': …}}")
        for stone, value in given.items():
            each(f"{what} of {stone}", value)

    return check


def _is(what: str, *kinds: type) -> Check:
    """Check what is no number."""

    def check(name: str, given: object) -> None:
        if not isinstance(given, kinds):
            raise InputError(f"{name}: {given!r} is not {what}")

    return check


def _coaches(name: str, given: object) -> None:
    if given not in tuple(UNITS):
        raise InputError(f"{name} {given!r}: one of {', '.join(UNITS)}, please")


_TEXT, _PATH = _is("a text", str), _is("a path", str, os.PathLike)
_YES_NO = _is("True or False", bool)

_CHECKS: Mapping[str, Check] = {
    "frames": _parts((FRAME, False), (FRAME, True)),
    "stick": _parts(*[(ANY, False)] * 5),
    "house": _parts((FRAME, True), *[(ANY, False)] * 6),
    "camera": _PATH,
    "camera_height": HEIGHT.check,
    "radius": RADIUS.check,
    "masses": _by_stone(POSITIVE.check, "mass"),
    "no_house": _YES_NO,
    "clip": _YES_NO,
    "tab": _TEXT,
    "names": _by_stone(_TEXT, "track"),
    "angles": _by_stone(_PATH, "angles"),
    "overlay": _YES_NO,
    "restitution": FRACTION.check,
    "friction": FRICTION.check,
    "samples": SAMPLES.check,
    "units": _coaches,
}
"""By what each setting is checked where it is given; units and the rate are checked together."""


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
    said: dict[str, object] = {"--stick": settings.stick, "--house": settings.house}
    said |= {"--camera": settings.camera, "--camera-height": settings.camera_height}
    said["--frames"] = settings.frames
    given = [name for name, value in said.items() if value]
    if given:
        clip = "; add --clip to measure its clip" if path.suffix.lower() in PROJECT_SUFFIXES else ""
        raise InputError(f"{path}: only clips take {', '.join(given)}; tracks are read here{clip}")
