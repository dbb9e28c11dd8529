"""Every setting of the program: frozen dataclasses, one per room, readable from a TOML file.

A setting has one name everywhere: it is a field here, a key in the file, an option of the command
(``--camera-height`` is `camera_height`) and an argument of `curlshot.run`.

Examples
--------
>>> config = Config().replace(radius=0.1445, camera_height=6.4)
>>> config.stones.radius, config.camera.camera_height
(0.1445, 6.4)
>>> Config.from_text("video.fps = 30.0").video.fps
30.0
"""

from __future__ import annotations

import json
import math
import os
import sys
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import Field as _Field
from dataclasses import dataclass, field, fields, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Self

from curlshot.data.arguments import check_type
from curlshot.data.coach_units import UNITS
from curlshot.data.errors import InputError
from curlshot.data.inputs import PROJECT_SUFFIXES
from curlshot.data.limits import (
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
from curlshot.data.sheet import STONE
from curlshot.data.units import ANGLE_UNITS, LENGTH_UNITS

Check = Callable[[str, object], None]
"""Raises `InputError` where a value of that name makes no sense."""

CONFIG_FILE = "config.toml"
"""File of the changed settings of a run, in its folder."""

__all__ = [
    "CONFIG_FILE",
    "CameraConfig",
    "Config",
    "PhysicsConfig",
    "ReportConfig",
    "SearchConfig",
    "StonesConfig",
    "TablesConfig",
    "VideoConfig",
]


# ---------------------------------------------------------------------------------------
# What a value may be
# ---------------------------------------------------------------------------------------


def _tuple_of(*limits: tuple[Limits, bool], what: str) -> Check:
    """Return a check of several numbers, each within its limits, or None where that is allowed.

    `what` names them in the message where their number is wrong.
    """

    def check(name: str, given: object) -> None:
        several = isinstance(given, Sequence) and not isinstance(given, str)
        if not several or len(given) != len(limits):  # type: ignore[arg-type]
            shown = f"[{', '.join(map(str, given))}]" if several else repr(given)  # type: ignore[call-overload]
            raise InputError(f"{name} {shown}: {what}, please")
        for part, (limit, none) in zip(given, limits, strict=True):  # type: ignore[call-overload]
            if not (none and part is None):
                limit.check(name, part)

    return check


def _by_stone(each: Check, what: str) -> Check:
    """Return a check of values by stone; `what` names one of them."""

    def check(name: str, given: object) -> None:
        if not isinstance(given, Mapping):
            raise InputError(f"{name}: a value for each stone, please, by its name")
        for stone, value in given.items():
            each(f"{what} of {stone}", value)

    return check


def _numbers(given: object) -> int:
    """Return the number of values of a list or tuple; 0 of anything else."""
    return len(given) if isinstance(given, (list, tuple)) else 0


def _instance(what: str, *kinds: type) -> Check:
    """Return a check of the type of a value that is no number."""

    def check(name: str, given: object) -> None:
        if not isinstance(given, kinds):
            raise InputError(f"{name}: {given!r} is not {what}")

    return check


def _stick(name: str, given: object) -> None:
    _tuple_of(*[(ANY, False)] * 5, what="5 numbers")(name, given)
    if not has_length(given):  # type: ignore[arg-type]
        raise InputError(f"{name} {given}: has no length")


def _one_of(known: Iterable[str]) -> Check:
    """Return a check of a word among some."""
    words = tuple(known)

    def check(name: str, given: object) -> None:
        if given not in words:
            raise InputError(f"{name} {given!r}: one of {', '.join(words)}, please")

    return check


NONNEGATIVE = Limits(0.0, sys.float_info.max, "a number, 0 or more").check
LENGTH = Limits(math.ulp(0.0), 100.0, "a positive number, at most 100").check
_TEXT, _PATH = _instance("a text", str), _instance("a path", str, os.PathLike)
_YES_NO = _instance("true or false", bool)


def setting(default: Any, meaning: str, check: Check, unit: str = "") -> Any:
    """Return a field with its meaning, unit and check."""
    about = {"meaning": meaning, "unit": unit, "check": check}
    if default == {}:
        return field(default_factory=dict, metadata=about)
    return field(default=default, metadata=about)


class _Section:
    """Checks each field where a value is made."""

    def __post_init__(self) -> None:
        for item in fields(self):  # type: ignore[arg-type]
            value = getattr(self, item.name)
            if not (value is None and item.default is None):
                item.metadata["check"](item.name, value)


# ---------------------------------------------------------------------------------------
# The sections
# ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class VideoConfig(_Section):
    """How a clip, or a table without times, is read.

    Attributes
    ----------
    fps : float, optional
        Rate of pictures, or of a table without times, 1/s.
    frames : (int, int or None), optional
        First and last frame of a clip to use, both included; to its end without the last.
    clip : bool
        Whether the clip of a Tracker project is measured, not what is marked in it.
    tab : str, optional
        Tab of a Tracker project that has several.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.VideoConfig(fps=30.0, frames=(10, None)).frames
    (10, None)
    """

    fps: float | None = setting(
        None, "frame rate of pictures, or of a table without times", POSITIVE.check, "1/s"
    )
    frames: tuple[int, int | None] | None = setting(
        None,
        "first and last frame of a clip to use, both included",
        _tuple_of((FRAME, False), (FRAME, True), what="1 or 2 numbers"),
    )
    clip: bool = setting(
        False, "measure the clip of a Tracker project, not the marks in it", _YES_NO
    )
    tab: str | None = setting(None, "tab of a Tracker project that has several", _TEXT)

    def __post_init__(self) -> None:
        if _numbers(self.frames) == 1:
            object.__setattr__(self, "frames", (*self.frames, None))  # type: ignore[misc]
        super().__post_init__()


@dataclass(frozen=True)
class CameraConfig(_Section):
    """What is known of the camera.

    Attributes
    ----------
    stick : (x1, y1, x2, y2, metres), optional
        Calibration stick: two pixels and their distance, for a still camera and no house.
    house : (frame, xc, yc, x1, y1, x2, y2), optional
        The tee and two points on the outer edge of the 12-ft ring, px, in one frame (None: the
        first, as without it), for a house that is not found by itself.
    camera : Path, optional
        Table as ``camera.csv`` with a known camera: one row, or one per frame; or a Tracker
        project, whose coordinate system is the camera. With a radius other than a curling
        stone's, plain discs are looked for, on no house.
    camera_height : float, optional
        Height of the camera above the ice, m, to 0.1 m; where it is found by the house.

    Raises
    ------
    InputError
        More than one of stick, house and camera, or a height beside one that tells where the
        camera is.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.CameraConfig(camera_height=6.4).camera_height
    6.4
    """

    stick: tuple[float, float, float, float, float] | None = setting(
        None, "two pixels of a still camera without a house, and their distance", _stick, "px, m"
    )
    house: tuple[int | None, float, float, float, float, float, float] | None = setting(
        None,
        "frame, tee and two points on the outer edge of the 12-ft ring",
        _tuple_of((FRAME, True), *[(ANY, False)] * 6, what="6 or 7 numbers"),
        "px",
    )
    camera: Path | None = setting(
        None, "a known camera: a run's camera.csv, or a Tracker project", _PATH
    )
    camera_height: float | None = setting(
        None, "height of the camera above the ice, to 0.1 m", HEIGHT.check, "m"
    )

    def __post_init__(self) -> None:
        if _numbers(self.house) == 6:
            object.__setattr__(self, "house", (None, *self.house))  # type: ignore[misc]
        super().__post_init__()
        if self.camera is not None:
            object.__setattr__(self, "camera", Path(self.camera))
        given = [name for name in ("stick", "house", "camera") if getattr(self, name) is not None]
        if len(given) > 1:
            names = " and ".join(f"`{name}`" for name in given)
            raise InputError(f"{names} exclude each other; give one of them")
        if self.camera_height is not None and given not in ([], ["house"]):
            raise InputError(
                f"`camera_height` belongs to a camera found by its house, not to `{given[0]}`"
            )


@dataclass(frozen=True)
class StonesConfig(_Section):
    """What is known of the stones, or of other discs.

    Attributes
    ----------
    radius : float
        Radius of the discs, m.
    masses : mapping of str to float
        Masses by stone, in any unit, where they are not all equal.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.StonesConfig().radius
    0.1455
    """

    radius: float = setting(STONE.radius, "radius of the discs", RADIUS.check, "m")
    masses: Mapping[str, float] = setting(
        {}, "masses by stone, where they are not all equal", _by_stone(POSITIVE.check, "mass"),
        "any",
    )  # fmt: skip


@dataclass(frozen=True)
class SearchConfig(_Section):
    """Where stones are searched for, and what they must show.

    The coordinates are those of the ice. Both ends of the sheet are searched, since cameras stand
    at either end.

    Attributes
    ----------
    search_half_width, search_half_length : float
        Stones are searched for on |x| and |y| up to these, m.
    search_radius_px, tracking_radius_px : float
        Radius of a disc on the rectified map: for a single frame, and for a clip, where the next
        frames show what one hides.
    search_min_response, tracking_min_response : float
        Template response (0 to 2) from which a place is examined, in the same two cases.
    min_visible_ratio : float
        Share of the rays that must look like a stone.
    min_evidence, min_disc_evidence : float
        Least evidence for a stone (0 to about 3), and for a plain disc (0 to 1).
    min_repeated_evidence : float
        Least evidence for a stone where one was seen a moment ago.
    max_centre_shift_ratio : float
        Largest distance of a centre from the peak of the response, in radii of cap or disc.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.SearchConfig(min_evidence=1.2).min_evidence
    1.2
    """

    search_half_width: float = setting(2.40, "stones are searched for on |x| up to", LENGTH, "m")
    search_half_length: float = setting(9.0, "stones are searched for on |y| up to", LENGTH, "m")
    search_radius_px: float = setting(
        11.6, "radius of a disc on the map of a single frame", POSITIVE.check, "px"
    )
    search_min_response: float = setting(
        0.45, "template response (0 to 2) from which a place is examined", NONNEGATIVE
    )
    tracking_radius_px: float = setting(
        6.5, "radius of a disc on the map of a clip's frame", POSITIVE.check, "px"
    )
    tracking_min_response: float = setting(
        0.3, "template response from which a place is examined in a clip", NONNEGATIVE
    )
    min_visible_ratio: float = setting(
        0.30, "share of the rays that must look like a stone", FRACTION.check
    )
    min_evidence: float = setting(1.05, "least evidence for a stone (0 to 3)", NONNEGATIVE)
    min_repeated_evidence: float = setting(
        0.7, "least evidence where a stone was seen a moment ago", NONNEGATIVE
    )
    min_disc_evidence: float = setting(
        0.6, "least evidence for a plain disc (0 to 1)", FRACTION.check
    )
    max_centre_shift_ratio: float = setting(
        0.35, "largest distance of a centre from the peak, in radii", NONNEGATIVE
    )


@dataclass(frozen=True)
class TablesConfig(_Section):
    """How tables of tracks are read.

    Attributes
    ----------
    length_unit, angle_unit : str, optional
        Units of tables; where not given as the tables say, else m and by evidence.
    no_house : bool
        Whether the origin of tables is not the tee of a house.
    names : mapping of str to str
        Names of stones to names of tracks; empty for all tracks by their own names.
    angles : mapping of str to Path
        Tables of the angles of stones, by stone.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.Config(tables=curlshot.TablesConfig(length_unit="cm")).tables.length_unit
    'cm'
    """

    length_unit: str | None = setting(None, "unit of lengths in tables", _one_of(LENGTH_UNITS))
    angle_unit: str | None = setting(None, "unit of angles in tables", _one_of(ANGLE_UNITS))
    no_house: bool = setting(False, "the origin of tables is not the tee of a house", _YES_NO)
    names: Mapping[str, str] = setting(
        {}, "names of stones to names of tracks", _by_stone(_TEXT, "track")
    )
    angles: Mapping[str, Path] = setting(
        {}, "tables of the angles of stones, by stone", _by_stone(_PATH, "angles")
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        angles = {stone: Path(path) for stone, path in self.angles.items()}
        object.__setattr__(self, "angles", angles)


@dataclass(frozen=True)
class PhysicsConfig(_Section):
    """What is assumed before a shot is measured, and what is drawn after.

    Attributes
    ----------
    restitution, friction : float, optional
        What predictions assume; values of the literature by default.
    samples : int
        Draws of restitution and frictions from the posterior of the shot.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.PhysicsConfig(friction=0.012).friction
    0.012
    """

    restitution: float | None = setting(
        None, "e that predictions assume (literature: 0.83)", FRACTION.check
    )
    friction: float | None = setting(
        None,
        "μ that predictions assume (literature, then the motion before the hit)",
        FRICTION.check,
    )
    samples: int = setting(
        0, "number of draws of e and the frictions for posterior.csv", SAMPLES.check
    )


@dataclass(frozen=True)
class ReportConfig(_Section):
    """What is written.

    Attributes
    ----------
    overlay : bool
        Whether the annotated clip is written.
    units : str
        Unit of what coaches read: m or ft. All else is SI.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.ReportConfig(units="ft").overlay
    True
    """

    overlay: bool = setting(True, "write the annotated clip", _YES_NO)
    units: str = setting("m", "unit of the coach's tables, m or ft", _one_of(UNITS))


@dataclass(frozen=True)
class Config:
    """All settings of a run, by room.

    Attributes
    ----------
    video : VideoConfig
    camera : CameraConfig
    stones : StonesConfig
    tables : TablesConfig
    physics : PhysicsConfig
    report : ReportConfig
    search : SearchConfig
    preset : frozenset of str
        Names of the settings that a file gave. Where they do not fit an input they are ignored;
        others are refused. Equality leaves them out.

    Examples
    --------
    >>> pucks = Config(
    ...     camera=CameraConfig(stick=(20.0, 36.0, 20.0, 220.0, 0.5)),
    ...     stones=StonesConfig(radius=0.0465),
    ... )
    >>> pucks == Config().replace(stick=(20.0, 36.0, 20.0, 220.0, 0.5), radius=0.0465)
    True
    """

    video: VideoConfig = field(default_factory=VideoConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
    stones: StonesConfig = field(default_factory=StonesConfig)
    tables: TablesConfig = field(default_factory=TablesConfig)
    physics: PhysicsConfig = field(default_factory=PhysicsConfig)
    report: ReportConfig = field(default_factory=ReportConfig)
    search: SearchConfig = field(default_factory=SearchConfig)
    preset: frozenset[str] = field(default=frozenset(), compare=False, repr=False)

    def __post_init__(self) -> None:
        for item in fields(self):
            kind: Any = frozenset if item.name == "preset" else item.default_factory
            check_type(f"`{item.name}`", getattr(self, item.name), kind, f"a {kind.__name__}")

    def replace(self, **settings: Any) -> Self:
        """Return a copy with other values of some settings, each by its own name.

        Parameters
        ----------
        **settings
            Fields of any section: `fps`, `radius`, `camera_height` …

        Raises
        ------
        InputError
            A value that makes no sense.
        TypeError
            A name that is no setting; the nearest one is named.

        Examples
        --------
        >>> Config().replace(raduis=0.145)
        Traceback (most recent call last):
            ...
        TypeError: no setting 'raduis'; did you mean 'radius'?
        """
        sections = {item.name: section for section, item in self.settings()}
        changed: dict[str, dict[str, Any]] = {}
        for name, value in settings.items():
            if name not in sections:
                raise TypeError(f"no setting {name!r}{_nearest(name, sections)}")
            changed.setdefault(sections[name], {})[name] = value
        parts = {name: replace(getattr(self, name), **new) for name, new in changed.items()}
        return replace(self, **parts, preset=self.preset.difference(settings))

    @classmethod
    def settings(cls) -> Iterator[tuple[str, _Field[Any]]]:
        """Yield the name of the section and the field of every setting, in order."""
        for section in fields(cls):
            if section.name == "preset":
                continue
            for item in fields(section.default_factory):  # type: ignore[arg-type]
                yield section.name, item

    def values(self) -> dict[str, Any]:
        """Return the value of every setting by its name."""
        return {
            item.name: getattr(getattr(self, room), item.name) for room, item in self.settings()
        }

    def changed(self) -> dict[str, Any]:
        """Return the settings that do not have their default value.

        Examples
        --------
        >>> Config().replace(fps=25.0, samples=0).changed()
        {'fps': 25.0}
        """
        usual = Config().values()
        return {name: value for name, value in self.values().items() if value != usual[name]}

    def absolute(self) -> Self:
        """Return a copy whose paths do not depend on the current folder."""
        camera, angles = self.camera.camera, self.tables.angles
        return self.replace(
            camera=None if camera is None else camera.resolve(),
            angles={stone: path.resolve() for stone, path in angles.items()},
        )

    @classmethod
    def from_file(cls, path: str | Path) -> Self:
        """Read a TOML file; paths in it are relative to its folder.

        Raises
        ------
        InputError
            A file that cannot be read, an unknown key (the nearest one is named), or a value that
            makes no sense.
        """
        path = Path(path)
        try:
            text = path.read_text(encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: {error.strerror}") from None
        except UnicodeDecodeError:
            raise InputError(f"{path}: not a text in UTF-8") from None
        return cls.from_text(text, str(path), path.parent)

    @classmethod
    def from_text(cls, text: str, source: str = "configuration", folder: Path = Path()) -> Self:
        """Read the text of a TOML file; `source` names it in messages. See `from_file`."""
        try:
            content = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise InputError(f"{source}: {error}") from None
        known: dict[str, dict[str, _Field[Any]]] = {}
        for section, item in cls.settings():
            known.setdefault(section, {})[item.name] = item
        given: dict[str, Any] = {}
        for section, table in content.items():
            if section not in known:
                raise InputError(f"{source}: no section [{section}]{_nearest(section, known)}")
            if not isinstance(table, dict):
                raise InputError(f"{source}: {section} is a section, so [{section}]")
            for name, value in table.items():
                if name not in known[section]:
                    near = _nearest(name, known[section])
                    raise InputError(f"{source}: no key {name!r} in [{section}]{near}")
                given[name] = _from_toml(known[section][name], value, folder)
        try:
            return replace(cls().replace(**given), preset=frozenset(given))
        except InputError as error:
            raise InputError(f"{source}: {error}") from None

    def to_toml(self) -> str:
        """Return the text of a TOML file with all settings, their units and meanings.

        Settings that have their default value, or none, stand in comments, so that a file keeps
        only what was changed.

        Examples
        --------
        >>> for line in Config().replace(fps=25.0).to_toml().splitlines()[:3]:
        ...     print(line)
        [video]
        fps = 25.0                       # 1/s: frame rate of pictures, or of a table without times
        # frames =                       # first and last frame of a clip to use, both included
        """
        lines: list[str] = []
        last = None
        values, changed = self.values(), self.changed()
        for section, item in self.settings():
            if section != last:
                lines += [*([""] if lines else []), f"[{section}]"]
                last = section
            value = values[item.name]
            key = f"{item.name} = {_toml(value) or ''}".rstrip()
            if item.name not in changed:
                key = f"# {key}"
            unit, meaning = item.metadata["unit"], item.metadata["meaning"]
            lines.append(f"{key:<{_KEY_WIDTH}} # {unit + ': ' if unit else ''}{meaning}")
        return "\n".join([*lines, ""])


_KEY_WIDTH = 32
"""Width of a key with its default value in a file."""


def with_settings(config: object, settings: Mapping[str, Any]) -> Config:
    """Return a configuration with other values of some settings; see `Config.replace`.

    Raises
    ------
    InputError
        What is no configuration, or a value that makes no sense.
    """
    if not isinstance(config, Config):
        raise InputError(f"`config`: {config!r} is not a Config")
    return config.replace(**settings)


def _nearest(name: str, known: Mapping[str, Any]) -> str:
    """Return the nearest of the known names as a hint, or which there are."""
    near = get_close_matches(name, known, 1)
    return f"; did you mean {near[0]!r}?" if near else f"; there are {', '.join(known)}"


def _from_toml(item: _Field[Any], value: Any, folder: Path) -> Any:
    """Return a value of a TOML file as the setting has it."""
    if item.name == "camera" and isinstance(value, str):
        return folder / value
    if item.name == "angles" and isinstance(value, dict):
        return {k: folder / v if isinstance(v, str) else v for k, v in value.items()}
    return tuple(value) if isinstance(value, list) else value


def _toml(value: Any) -> str | None:
    """Return a value as TOML writes it; None for what has none."""
    if value is None or value == {}:
        return None
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, tuple):
        return f"[{', '.join(repr(part) for part in value if part is not None)}]"
    if isinstance(value, Mapping):
        pairs = (f"{json.dumps(str(k))} = {_toml(v)}" for k, v in value.items())
        return f"{{ {', '.join(pairs)} }}"
    return json.dumps(str(value), ensure_ascii=False)


# ---------------------------------------------------------------------------------------
# Settings that do not fit an input
# ---------------------------------------------------------------------------------------


def refuse_table_settings(path: Path, config: Config) -> None:
    """Refuse settings of tables where a clip is measured; those of a preset are ignored.

    Tabs and units of length of a project count there too, be it the clip's own or the camera's.
    """
    tables = config.tables
    given: dict[str, object] = {"names": tables.names, "angles": tables.angles}
    given |= {"angle_unit": tables.angle_unit, "no_house": tables.no_house}
    camera = config.camera.camera
    sources = [path] if camera is None else [path, camera]
    if not any(source.suffix.lower() in PROJECT_SUFFIXES for source in sources):
        given |= {"tab": config.video.tab, "length_unit": tables.length_unit}
    names = _said(given, config)
    if names:
        raise InputError(f"{path}: only tables take {names}; a clip is measured here")


def refuse_clip_settings(path: Path, config: Config) -> None:
    """Refuse settings of a clip where tracks are read; those of a preset are ignored."""
    given = {name: getattr(config.camera, name) for name in
             ("stick", "house", "camera", "camera_height")}  # fmt: skip
    given["frames"] = config.video.frames
    names = _said(given, config)
    if names:
        clip = "; add `clip` to measure its clip" if path.suffix.lower() in PROJECT_SUFFIXES else ""
        raise InputError(f"{path}: only clips take {names}; tracks are read here{clip}")


def measures_clip(files: Sequence[Path], config: Config) -> bool:
    """Return whether `clip` holds for these files; of a preset it does for projects alone."""
    projects = any(file.suffix.lower() in PROJECT_SUFFIXES for file in files)
    return config.video.clip and (projects or "clip" not in config.preset)


def _said(given: Mapping[str, object], config: Config) -> str:
    """Return the names, in backticks, of settings that have a value and are not of a preset."""
    names = (name for name, value in given.items() if value and name not in config.preset)
    return ", ".join(f"`{name}`" for name in names)
