"""Reading Tracker's projects: from the objects of a ``.trk`` to what they mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.osp_xml import Thing
from curlshot.data.tracks import LATEST
from curlshot.data.trk import (
    MEASURED,
    TEXT_COLUMNS,
    Array,
    Coordinates,
    Frames,
    PointMass,
    Project,
    Timing,
)

_MOVES_PIXELS = {
    "PerspectiveFilter": "perspective",
    "RadialDistortionFilter": "radial distortion",
    "BarrelPincushionFilter": "radial distortion",
    "ResizeFilter": "resize",
    "RotateFilter": "rotate",
}

_UNEVEN = 0.02
"""Share of a frame by which a clip's times may be off equal steps and count as equal."""


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
            f"places are relative to {reference}, the reference frame of the project; {reference}"
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
        "the frames of its video are unevenly spaced; their own times are used, up to"
        f" {1000 * off:.0f} ms from those that Tracker exports"
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
