"""Tracker's projects (``.trk``): marks in pixels, the moving coordinate system, the clip.

Facts about the format are from the source of Tracker 6.3 and of versions 4 and 5. Pixels are
Tracker's: the origin is the corner of the top left pixel, y points down, and they belong to
the picture after the video's filters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from data.columns import LENGTH_UNITS
from data.errors import InputError
from data.layouts import TrackFile
from data.osp_xml import Thing
from data.tracks import LATEST

Array = NDArray[np.float64]
Frames = NDArray[np.int64]

_MOVES_PIXELS = {
    "PerspectiveFilter": "perspective",
    "RadialDistortionFilter": "radial distortion",
    "BarrelPincushionFilter": "radial distortion",
    "ResizeFilter": "resize",
    "RotateFilter": "rotate",
}
TEXT_COLUMNS: Mapping[str, str] = {
    "theta": "theta(rad)", "sd_x": "sd_x(m)", "sd_y": "sd_y(m)", "sd_theta": "sd_theta(rad)"
}  # fmt: skip
"""Columns of text in which this program gives Tracker what it has no columns for."""

MEASURED = ("t", "x", "y", *TEXT_COLUMNS)
"""What this program adds to each mark, in this order."""

_UNEVEN = 0.02
"""Share of a frame by which a clip's times may be off equal steps and count as equal."""


@dataclass(frozen=True)
class Coordinates:
    """Tracker's coordinate system; each key holds until the next.

    Attributes
    ----------
    keys : ndarray of int, shape (k,)
        Video frames, increasing.
    origin : ndarray, shape (k, 2)
        Pixels.
    angle : ndarray, shape (k,)
        From the picture's horizontal to the x axis, radians, counter-clockwise.
    scale : ndarray, shape (k, 2)
        Pixels per length unit along the picture's horizontal and vertical.
    """

    keys: Frames
    origin: Array
    angle: Array
    scale: Array

    def at(self, frames: ArrayLike) -> Coordinates:
        """Give the system at each of the frames, as keys."""
        wanted = np.asarray(frames, np.int64)
        key = np.maximum(np.searchsorted(self.keys, wanted, side="right") - 1, 0)
        return Coordinates(wanted, self.origin[key], self.angle[key], self.scale[key])

    def world(self, frames: ArrayLike, pixels: Array) -> Array:
        """Map pixels, shape (n, 2), in frames, shape (n,), to places in length units."""
        here = self.at(frames)
        with np.errstate(over="ignore", invalid="ignore"):
            u, v = ((pixels - here.origin) / here.scale * (1.0, -1.0)).T
            cos, sin = np.cos(here.angle), np.sin(here.angle)
            return np.column_stack([cos * u + sin * v, cos * v - sin * u])

    def pixels(self, frames: ArrayLike, places: Array) -> Array:
        """Map places to pixels; the inverse of `world`."""
        here = self.at(frames)
        x, y = places.T
        cos, sin = np.cos(here.angle), np.sin(here.angle)
        uv = np.column_stack([cos * x - sin * y, -sin * x - cos * y])
        return np.asarray(here.origin + here.scale * uv)


@dataclass(frozen=True)
class PointMass:
    """A track: its marks by video frame.

    Attributes
    ----------
    name : str
        As its user named it.
    mass : float
        In the project's unit; 1 where the user gave none.
    frames : ndarray of int, shape (n,)
        Video frames of the marks, increasing.
    marks : ndarray, shape (n, 2)
        Pixels.
    filled : int
        How many of the marks Tracker put between those of the user.
    texts : mapping of str to ndarray, shape (n,)
        What is in the columns of text that this program writes (`TEXT_COLUMNS`; m, rad); NaN
        where there is no number.
    measured : ndarray, shape (n, 7)
        `MEASURED` of each mark (s, m, rad), where this program wrote the project; else without
        rows.
    team : str
        What the stones of one team share, where this program wrote the project.
    """

    name: str
    mass: float
    frames: Frames
    marks: Array
    filled: int = 0
    texts: Mapping[str, Array] = field(default_factory=dict)
    measured: Array = field(default_factory=lambda: np.empty((0, len(MEASURED))))
    team: str = ""


@dataclass(frozen=True)
class Timing:
    """Which frames of the video are steps of the clip, and when they were taken.

    Attributes
    ----------
    start, step, count : int
        First frame, frames per step, number of steps.
    origin, duration : float
        Time of the first frame, and of each frame, s.
    clock : ndarray
        Times of all frames of the video, s, where they are uneven; else empty.
    """

    start: int
    step: int
    count: int
    origin: float
    duration: float
    clock: Array

    def includes(self, frames: Frames) -> NDArray[np.bool_]:
        """Which frames are steps of the clip."""
        k, rest = np.divmod(frames - self.start, self.step)
        return np.asarray((k >= 0) & (k < self.count) & (rest == 0))

    def times(self, frames: Frames) -> Array:
        """Give the times of frames, s."""
        if len(self.clock) > max(self.start, int(frames.max(initial=0))):
            return np.asarray(self.origin + self.clock[frames] - self.clock[self.start])
        return np.asarray(self.origin + (frames - self.start) * self.duration)


@dataclass(frozen=True)
class Project:
    """One tab of Tracker.

    Attributes
    ----------
    source : str
        The file, and the tab within it.
    masses : tuple of PointMass
        The tracks that have marks; models and derived tracks are not among them.
    coordinates : Coordinates
        With the origin of the reference frame, if the project has one.
    axes : Coordinates
        Without that: where the coordinate system lies in the picture.
    timing : Timing
        Of the clip.
    length_unit : str
        As the project says, or "".
    video : tuple of str
        Path of the video, or of its pictures, as written.
    filters : tuple of str
        What has moved the pixels before they were marked.
    others : tuple of str
        Kinds of its other tracks.
    warnings : tuple of str
        What its numbers do not tell.
    """

    source: str
    masses: tuple[PointMass, ...]
    coordinates: Coordinates
    axes: Coordinates
    timing: Timing
    length_unit: str
    video: tuple[str, ...]
    filters: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def file(self) -> TrackFile:
        """Tracks in the project's length unit, at the steps of its clip.

        Raises
        ------
        InputError
            Where no track has a mark in the clip, two have one name, or there is no scale.
        """
        if not self.masses:
            clip = "; what its clip shows can be measured (--clip)" if self.video else ""
            raise InputError(
                f"{self.source}: no point mass with marks (it has"
                f" {', '.join(self.others)[:80] or 'no tracks'}); mark stones as point masses in"
                f" Tracker{clip}"
            )
        names = [track.name for track in self.masses]
        doubled = [name for name in names if names.count(name) > 1]
        if doubled:
            raise InputError(
                f"{self.source}: two tracks with one name, {min(doubled)}; rename one in Tracker"
            )
        warnings = list(self.warnings)
        if self.filters:
            warnings.append(
                f"{self.source}: marked on a video changed by filters ({', '.join(self.filters)});"
                " places are as Tracker shows them, the picture itself is not changed here"
            )
        parts = []
        for track in self.masses:
            part = self._rows(track)
            if part.empty:
                warnings.append(f"{self.source}: {track.name} has no mark in the clip; left out")
                continue
            if track.filled:
                warnings.append(
                    f"{self.source}: {track.filled} places of {track.name} were filled in by"
                    " Tracker between marks; they are used as if they were measured"
                )
            parts.append(part)
        if not parts:
            raise InputError(f"{self.source}: no point mass with a mark in the clip")
        self.refuse_uncalibrated()
        unit = self.length_unit if self.length_unit in LENGTH_UNITS else None
        if unit is None and self.length_unit:
            warnings.append(
                f"{self.source}: its length unit is “{self.length_unit[:20]}”, which is unknown"
                " here (--length-unit)"
            )
        tracks = pd.concat(parts, ignore_index=True)
        masses = {track.name: track.mass for track in self.masses}
        return TrackFile(tracks, None, unit, "rad", True, warnings, masses)

    def refuse_uncalibrated(self) -> None:
        """Raise `InputError` where nobody has told Tracker how long something is."""
        if (self.axes.scale == 1).all():
            raise InputError(
                f"{self.source}: not calibrated, one pixel is one length unit; set a calibration"
                " stick in Tracker"
            )

    def _rows(self, track: PointMass) -> pd.DataFrame:
        used = self.timing.includes(track.frames)
        frames = track.frames[used]
        if len(track.measured):
            exact = dict(zip(MEASURED, track.measured[used].T, strict=True))
            return pd.DataFrame({"stone": track.name, "team": track.team, "frame": frames, **exact})
        x, y = self.coordinates.world(frames, track.marks[used]).T
        known = {"t": self.timing.times(frames), "frame": frames, "x": x, "y": y}
        metre = 1 / LENGTH_UNITS.get(self.length_unit, 1.0)
        texts = {
            name: column[used] * (metre if name in ("sd_x", "sd_y") else 1.0)
            for name, column in track.texts.items()
        }
        return pd.DataFrame({"stone": track.name, **known, **texts})


def project_of(root: Thing, source: str) -> Project:
    """Make a project of the root object of a ``.trk``.

    Raises
    ------
    InputError
        One line: no project, or numbers that make no sense.
    """
    if root.cls != "TrackerPanel":
        raise InputError(f"{source}: no Tracker project ({root.cls or 'nothing'} instead)")
    try:
        return _project(root, source)
    except InputError as error:
        raise InputError(f"{source}: {error}") from None


def _project(root: Thing, source: str) -> Project:
    clip = root.thing("videoclip") or Thing("VideoClip")
    video = clip.thing("video") or Thing("Video")
    shift = clip.whole("frameshift", 0)
    masses, others, warnings = _tracks(root, shift)
    axes = coordinates = _coordinates(root.thing("coords"), shift)
    reference = root.text("referenceframe")
    giver = next((track for track in masses if track.name == reference), None)
    if giver is not None:
        coordinates = _relative_to(giver, coordinates)
        masses = tuple(track for track in masses if track is not giver)
        warnings.append(
            f"places are relative to {reference}, the project's reference frame; {reference} itself"
            " rests in it and is left out"
        )
    moving = [_MOVES_PIXELS[name] for name in _filters(video) if name in _MOVES_PIXELS]
    timing, note = _timing(clip, root.thing("clipcontrol") or Thing("ClipControl"), video, shift)
    return Project(
        source=source,
        masses=masses,
        coordinates=coordinates,
        axes=axes,
        timing=timing,
        length_unit=root.text("length_unit").strip(),
        video=_video_files(video),
        filters=tuple(dict.fromkeys(moving)),
        others=others,
        warnings=tuple(f"{source}: {text}" for text in (*warnings, *note)),
    )


def _tracks(root: Thing, shift: int) -> tuple[tuple[PointMass, ...], tuple[str, ...], list[str]]:
    """Find the point masses that have marks, the kinds of the other tracks, and warnings."""
    collection = root.thing("tracks")
    tracks = [] if collection is None else list(collection.objects())
    masses: list[PointMass] = []
    warnings: list[str] = []
    for track in tracks:
        if track.cls == "PointMass":
            name = " ".join(track.text("name").split()) or f"track {len(masses) + 1}"
            mass = _point_mass(track, name, shift)
            if len(mass.frames):
                masses.append(mass)
            else:
                warnings.append(f"{name} has no marks; left out")
    return tuple(masses), tuple(sorted({track.cls for track in tracks})), warnings


def _point_mass(track: Thing, name: str, shift: int) -> PointMass:
    data = track.thing("framedata")
    entries = data.sparse() if data is not None else {}
    marks = {
        frame - shift: (entry.number("x"), entry.number("y"))
        for frame, entry in sorted(entries.items())
        if isinstance(entry, Thing) and frame >= shift
    }
    mass = track.number("mass", 1.0)
    frames = np.array(list(marks), np.int64)
    places = np.array(list(marks.values()), float).reshape(-1, 2)
    keys = track.thing("keyFrames")
    by_hand = np.isin(frames, keys.floats() - shift) if keys is not None else frames < 0
    return PointMass(
        name=name,
        mass=mass if mass > 0 else 1.0,
        frames=frames,
        marks=places,
        filled=_filled(frames, places, by_hand),
        texts=_texts(track, frames + shift),
        measured=_measured(track, len(frames)),
        team=track.text("team").strip(),
    )


def _texts(track: Thing, frames: Frames) -> dict[str, Array]:
    """Read the columns of text that this program writes."""
    names, columns = track.thing("text_column_names"), track.thing("text_column_entries")
    if names is None or columns is None:
        return {}
    entries = columns.sparse()
    known = {label: name for name, label in TEXT_COLUMNS.items()}
    found = {}
    for n, label in names.sparse().items():
        column = entries.get(n)
        if isinstance(label, str) and label in known and isinstance(column, Thing):
            cells = column.sparse()
            numbers = [_number_or_nan(cells.get(frame)) for frame in frames.tolist()]
            found[known[label]] = np.array(numbers)
    return found


def _number_or_nan(cell: str | Thing | None) -> float:
    """Read a number that a person may have written over."""
    try:
        value = float(cell) if isinstance(cell, str) else np.nan
    except ValueError:
        return np.nan
    return value if np.isfinite(value) else np.nan


def _measured(track: Thing, count: int) -> Array:
    """Read the exact places that this program adds; Tracker drops them when it saves."""
    written = track.thing("measured")
    numbers = np.empty(0) if written is None else written.floats()
    width = len(MEASURED)
    rows = numbers.reshape(-1, width) if len(numbers) == width * count else np.empty((0, width))
    sound = np.isfinite(rows[:, :3]).all() and not np.isinf(rows).any()
    return rows if sound and (np.diff(rows[:, 0]) > 0).all() else rows[:0]


def _filled(frames: Frames, marks: Array, by_hand: NDArray[np.bool_]) -> int:
    """Count the marks that stand exactly where a line between two marks by hand puts them.

    The list of key frames alone does not tell: some versions left it stale.
    """
    if by_hand.sum() < 2 or by_hand.all():
        return 0
    line = np.column_stack([np.interp(frames, frames[by_hand], axis[by_hand]) for axis in marks.T])
    within = (frames > frames[by_hand][0]) & (frames < frames[by_hand][-1]) & ~by_hand
    return int((within & (np.abs(line - marks).max(axis=1) < 1e-6)).sum())


def _coordinates(coords: Thing | None, shift: int) -> Coordinates:
    data = coords.thing("framedata") if coords is not None else None
    entries = data.sparse() if data is not None else {}
    rows = {
        max(frame - shift, 0): [
            entry.number(name) for name in ("xorigin", "yorigin", "angle", "xscale", "yscale")
        ]
        for frame, entry in sorted(entries.items())
        if isinstance(entry, Thing)
    }
    if not rows:
        raise InputError("no coordinate system")
    table = np.array(list(rows.values()))
    scale = table[:, 3:]
    if (scale == 0).any() or (np.abs(scale) > 1e9).any() or (np.abs(scale) < 1e-9).any():
        raise InputError("a scale of its coordinate system makes no sense")
    return Coordinates(np.array(list(rows), np.int64), table[:, :2], np.radians(table[:, 2]), scale)


def _relative_to(giver: PointMass, coordinates: Coordinates) -> Coordinates:
    """Put the origin where a track is, in gaps where it was last, before at its first mark."""
    keys = np.union1d(coordinates.keys, giver.frames)
    here = coordinates.at(keys)
    last = np.maximum(np.searchsorted(giver.frames, keys, side="right") - 1, 0)
    return replace(here, origin=giver.marks[last])


def _timing(clip: Thing, control: Thing, video: Thing, shift: int) -> tuple[Timing, list[str]]:
    start = max(clip.whole("startframe", 0) - shift, 0)
    step = clip.whole("stepsize", 1)
    count = clip.whole("stepcount", 10**9)
    if step < 1 or count < 1:
        raise InputError(f"a clip of {count} steps of {step} frames makes no sense")
    duration = control.number("delta_t", video.number("delta_t", 0.0)) / 1000
    if duration <= 0:
        raise InputError("no duration of a frame (delta_t); save it again with Tracker")
    origin = clip.number("starttime", 0.0) / 1000
    if max(abs(origin), duration) > LATEST / 1e9:
        raise InputError("the times of its clip make no sense")
    times = video.thing("start_times")
    clock, note = _clock(np.empty(0) if times is None else times.floats(), duration)
    return Timing(start, step, count, origin, duration, clock), note


def _clock(stamps: Array, duration: float) -> tuple[Array, list[str]]:
    """Find times of uneven frames, s, at the pace the user gave the clip; none where even."""
    if len(stamps) < 3 or not (np.diff(stamps) > 0).all() or not np.isfinite(stamps).all():
        return np.empty(0), []
    mean = (stamps[-1] - stamps[0]) / (len(stamps) - 1)
    clock = (stamps - stamps[0]) / mean * duration
    off = float(np.abs(clock - np.arange(len(clock)) * duration).max())
    if off < _UNEVEN * duration:
        return np.empty(0), []
    return clock, [
        f"the frames of its video are uneven; their own times are used, up to {1000 * off:.0f} ms"
        " from those that Tracker exports"
    ]


def _filters(video: Thing) -> Sequence[str]:
    filters = video.thing("filters")
    if filters is None:
        return []
    return [item.cls for item in filters.objects() if not item.true("disabled")]


def _video_files(video: Thing) -> tuple[str, ...]:
    paths = video.thing("paths")
    if paths is not None:
        found = [path for _, path in sorted(paths.sparse().items()) if isinstance(path, str)]
        if found:
            return tuple(found)
    return (video.text("path"),) if video.text("path") else ()
