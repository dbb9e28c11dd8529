"""Write a project for Tracker (``.trk``): tracks as point masses, simulations as external models.

Tracker draws with one similarity per frame, a tilted camera needs a perspective: what Tracker
shows as x and y differs away from the tee. So every point mass also carries its exact times,
places and angles in a property `measured`, which Tracker passes over and `data.trk` reads.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from data.files import whole_file, write_text
from data.inputs import IMAGE_SUFFIXES
from data.sheet import STONE
from data.trk import MEASURED, TEXT_COLUMNS, Coordinates

Array = NDArray[np.float64]

_TRACKER = "org.opensourcephysics.cabrillo.tracker."
_MEDIA = "org.opensourcephysics.media."
_STRINGS = "[Ljava.lang.String;"
_MARK, _MODEL = "Footprint.Diamond", "CircleFootprint.Circle#7 outline"
"""How Tracker draws places: those that were measured, and the larger ones of simulations."""
_COLOURS = ((255, 0, 0), (255, 200, 0), (0, 120, 255), (0, 160, 80), (200, 0, 200), (0, 200, 200))


@dataclass(frozen=True)
class View:
    """What Tracker shows the tracks over.

    Attributes
    ----------
    coordinates : data.trk.Coordinates
        In Tracker's pixels.
    size : tuple of int
        Width and height of the picture, px.
    video : tuple of str
        Path of the video from the project's folder, or of its pictures; empty for none.
    frames : int
        How many the video has.
    """

    coordinates: Coordinates
    size: tuple[int, int] = (1280, 720)
    video: tuple[str, ...] = ()
    frames: int = 0


def plain_view(sightings: pd.DataFrame, size: tuple[int, int] = (1280, 720)) -> View:
    """Give a view from above without a video, in which all places lie within the picture."""
    xy = sightings[["x", "y"]].to_numpy(float)
    low, high = xy.min(axis=0), xy.max(axis=0)
    scale = float(np.clip(0.8 * np.min(np.array(size) / np.maximum(high - low, 0.2)), 1.5, 1e4))
    middle = (low + high) / 2
    origin = np.array(size) / 2 + scale * middle * (-1.0, 1.0)
    keys = np.zeros(1, np.int64)
    return View(Coordinates(keys, origin[None], np.zeros(1), np.full((1, 2), scale)), size)


def write_trk(project: str, path: Path) -> None:
    """Write a project as a ``.trk``, whole or not at all."""
    write_text(path, project)


def write_trz(project: str, path: Path, clip: Mapping[str, Path]) -> None:
    """Write a project as a ``.trz``: an archive with the clip's files by their names in it."""
    with whole_file(path) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{path.stem}.trk", project)
        for name, file in clip.items():
            # What codecs have packed gets no smaller.
            archive.write(file, name, zipfile.ZIP_STORED)


def project_xml(
    sightings: pd.DataFrame,
    view: View,
    marks: Array,
    simulations: Mapping[str, pd.DataFrame] | None = None,
) -> str:
    """Make a project with one tab.

    Parameters
    ----------
    sightings : DataFrame
        `data.tracks.SIGHTING_COLUMNS`.
    view : View
        What the tracks are shown over.
    marks : ndarray, shape (n, 2)
        Where each sighting is in the picture, Tracker's pixels.
    simulations : mapping, optional
        Tables with ``stone, t, x, y`` by the name of the model.
    """
    clock = _Clock.of(sightings)
    tracks = [
        _point_mass(str(stone), rows, marks[rows.index], colour)
        for (stone, rows), colour in zip(
            sightings.reset_index(drop=True).groupby("stone", sort=False),
            _cycle(sightings["stone"].nunique()),
            strict=True,
        )
    ]
    for (model, table), colour in zip(
        (simulations or {}).items(), _cycle(len(simulations or {}), 2), strict=True
    ):
        tracks.append(_external_model(model, table, clock, colour))
    root = _object(
        f"{_TRACKER}TrackerPanel",
        [
            _value("semantic_version", "6.2.0"),
            _value("width", float(view.size[0])),
            _value("height", float(view.size[1])),
            _nested("videoclip", _clip(view, clock)),
            _nested(
                "clipcontrol",
                _object(
                    f"{_MEDIA}core.StepperClipControl",
                    [
                        _value("rate", 1.0),
                        _value("delta_t", 1000 * clock.duration),
                        _value("frame", clock.first),
                    ],
                ),
            ),
            _nested("coords", _coordinates(view.coordinates)),
            _value("length_unit", "m"),
            _value("mass_unit", "kg"),
            _value("units_visible", True),
            _collection("tracks", tracks),
        ],
    )
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + "\n".join(root) + "\n"


@dataclass(frozen=True)
class _Clock:
    """Steps of the clip: first and last frame, time of the first, mean duration, s."""

    first: int
    last: int
    start: float
    duration: float
    times: Array = field(repr=False)

    @classmethod
    def of(cls, sightings: pd.DataFrame) -> _Clock:
        by_frame = sightings.drop_duplicates("frame").sort_values("frame")
        frames, t = by_frame["frame"].to_numpy(int), by_frame["t"].to_numpy(float)
        first, last = int(frames[0]), int(frames[-1])
        duration = float((t[-1] - t[0]) / (last - first)) if last > first else 0.04
        times = np.interp(np.arange(first, last + 1), frames, t)
        return cls(first, last, float(t[0]), duration, times)


def _clip(view: View, clock: _Clock) -> list[str]:
    return _object(
        f"{_MEDIA}core.VideoClip",
        [
            *([_nested("video", _video(view, clock))] if view.video else []),
            _value("video_framecount", max(view.frames, clock.last + 1)),
            _value("startframe", clock.first),
            _value("stepsize", 1),
            _value("stepcount", clock.last - clock.first + 1),
            _value("starttime", 1000 * clock.start),
        ],
    )


def _video(view: View, clock: _Clock) -> list[str]:
    path = _value("path", view.video[0])
    if Path(view.video[0]).suffix.lower() not in IMAGE_SUFFIXES:
        return _object(f"{_MEDIA}xuggle.XuggleVideo", [path])
    pictures = _strings("paths", dict(enumerate(view.video)))
    step = _value("delta_t", 1000 * clock.duration)
    return _object(f"{_MEDIA}core.ImageVideo", [pictures, path, step])


def _coordinates(system: Coordinates) -> list[str]:
    cls = f"{_MEDIA}core.ImageCoordSystem"
    fixed = len(system.keys) == 1
    rows = np.column_stack([system.origin, np.degrees(system.angle), system.scale])
    names = ("xorigin", "yorigin", "angle", "xscale", "yscale")
    data = {
        # Frames before the first key are drawn with it.
        0 if k == 0 else int(key): _object(
            f"{cls}$FrameData",
            [_value(name, float(v)) for name, v in zip(names, row, strict=True)],
        )
        for k, (key, row) in enumerate(zip(system.keys, rows, strict=True))
    }
    return _object(
        cls,
        [
            _value("fixedorigin", fixed),
            _value("fixedangle", fixed),
            _value("fixedscale", fixed),
            _value("locked", True),
            _sparse("framedata", f"{cls}$FrameData", data),
        ],
    )


def _point_mass(
    stone: str, rows: pd.DataFrame, marks: Array, colour: tuple[int, int, int]
) -> list[str]:
    cls = f"{_TRACKER}PointMass"
    data = {
        int(frame): _object(f"{cls}$FrameData", [_value("x", float(x)), _value("y", float(y))])
        for frame, (x, y) in zip(rows["frame"], marks, strict=True)
    }
    return _object(
        cls,
        [
            _value("mass", STONE.mass),
            _value("name", stone),
            _value("team", str(rows["team"].iloc[0])),
            *_look(colour, _MARK),
            *_texts(rows),
            _sparse("framedata", f"{cls}$FrameData", data),
            _numbers("measured", "[[D", rows[list(MEASURED)].to_numpy(float)),
        ],
    )


def _texts(rows: pd.DataFrame) -> list[list[str]]:
    """Put angles and errors into columns of text, which Tracker shows, exports and saves again."""
    labels: dict[int, str] = {}
    columns: list[str] = []
    for name, label in TEXT_COLUMNS.items():
        known = rows[rows[name].notna()]
        if len(known):
            cells = zip(known["frame"], known[name], strict=True)
            entries = {int(frame): repr(float(value)) for frame, value in cells}
            columns += _strings(f"[{len(labels)}]", entries)
            labels[len(labels)] = label
    if not labels:
        return []
    return [
        _strings("text_column_names", labels),
        [*_array("text_column_entries", f"[{_STRINGS}"), *columns, "</property>"],
    ]


def _external_model(
    model: str, table: pd.DataFrame, clock: _Clock, colour: tuple[int, int, int]
) -> list[str]:
    """Give all stones of a simulation at the steps of the clip, resting where it ends."""
    properties = [_value("name", model), *_look(colour, _MODEL), _numbers("t", "[D", clock.times)]
    for k, (stone, rows) in enumerate(table.groupby("stone")):
        # The first point is the model's own, the others are numbered.
        end = "" if k == 0 else str(k - 1)
        for axis in ("x", "y"):
            at = np.interp(clock.times, rows["t"], rows[axis])
            properties.append(_numbers(f"{axis}{end}", "[D", at))
        properties.append(_value(f"pointname{end}", str(stone)))
        properties.append(_value(f"mass{end}", STONE.mass))
        if end:
            properties += [_colour(colour, f"color{end}"), _value(f"footprint{end}", _MODEL)]
    properties.append(_value("start_frame", clock.first))
    return _object(f"{_TRACKER}ParticleDataTrack", properties)


def _look(colour: tuple[int, int, int], footprint: str) -> list[list[str]]:
    """Make a track visible, which Tracker does not unless told.

    Without the trail of past places: they lie elsewhere once the camera has moved.
    """
    return [_colour(colour), _value("footprint", footprint), _value("visible", True)]


def _cycle(count: int, start: int = 0) -> list[tuple[int, int, int]]:
    return [_COLOURS[(start + k) % len(_COLOURS)] for k in range(count)]


def _colour(colour: tuple[int, int, int], name: str = "color") -> list[str]:
    parts = zip(("red", "green", "blue", "alpha"), (*colour, 255), strict=True)
    return _nested(name, _object("java.awt.Color", [_value(part, v) for part, v in parts]))


# The grammar: Tracker reads it line by line, one property each.


def _object(cls: str, properties: Iterable[Sequence[str]]) -> list[str]:
    return [f'<object class="{cls}">', *(line for p in properties for line in p), "</object>"]


def _nested(name: str, thing: Sequence[str]) -> list[str]:
    return [f'<property name="{name}" type="object">', *thing, "</property>"]


def _value(name: str, value: str | float | bool) -> list[str]:
    kind = {bool: "boolean", int: "int", float: "double", str: "string"}[type(value)]
    text = str(value).lower() if kind == "boolean" else str(value)
    if kind == "string":
        text = " ".join("".join(c for c in text if c.isprintable()).split())
        if not set(text).isdisjoint("\"'<>&"):
            text = f"<![CDATA[{text.replace(']]>', ']] >')}]]>"
    return [f'<property name="{name}" type="{kind}">{text}</property>']


def _array(name: str, cls: str) -> list[str]:
    return [f'<property name="{name}" type="array" class="{cls}">']


def _sparse(name: str, cls: str, entries: Mapping[int, Sequence[str]]) -> list[str]:
    body = [line for n, entry in entries.items() for line in _nested(f"[{n}]", entry)]
    return [*_array(name, f"[L{cls};"), *body, "</property>"]


def _strings(name: str, entries: Mapping[int, str]) -> list[str]:
    body = [line for n, text in entries.items() for line in _value(f"[{n}]", text)]
    return [*_array(name, _STRINGS), *body, "</property>"]


def _collection(name: str, things: Iterable[Sequence[str]]) -> list[str]:
    body = [line for thing in things for line in _nested("item", thing)]
    head = f'<property name="{name}" type="collection" class="java.util.ArrayList">'
    return [head, *body, "</property>"]


def _numbers(name: str, cls: str, values: Array) -> list[str]:
    def row(numbers: Array) -> str:
        cells = ("NaN" if np.isnan(v) else repr(float(v)) for v in numbers)
        return "{" + ",".join(cells) + "}"

    text = row(values) if values.ndim == 1 else "{" + ",".join(row(r) for r in values) + "}"
    return [*_array(name, cls), *_value("array", text), "</property>"]
