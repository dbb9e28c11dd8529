"""Write a project for Tracker (``.trk``): tracks as point masses, simulations as external models.

Tracker draws with one similarity per frame, a tilted camera needs a perspective: what Tracker
shows as x and y differs away from the tee. So every point mass also carries its exact times,
places and angles in a property `measured`, which Tracker passes over and `curlshot.data.trk` reads.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.files import whole_file, write_text
from curlshot.data.inputs import IMAGE_SUFFIXES
from curlshot.data.osp_write import (
    STRINGS,
    array,
    collection,
    entry,
    nested,
    numbers,
    sparse,
    strings,
    thing,
)
from curlshot.data.sheet import STONE
from curlshot.data.trk import MEASURED, TEXT_COLUMNS, Coordinates

Array = NDArray[np.float64]

PLAIN_SIZE = (1280, 720)
"""Width and height of a picture that no video gives, px."""

_TRACKER = "org.opensourcephysics.cabrillo.tracker."
_MEDIA = "org.opensourcephysics.media."
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
    size: tuple[int, int] = PLAIN_SIZE
    video: tuple[str, ...] = ()
    frames: int = 0


def plain_view(detections: pd.DataFrame) -> View:
    """Give a view from above without a video, in which all places lie within the picture."""
    xy = detections[["x", "y"]].to_numpy(float)
    low, high = xy.min(axis=0), xy.max(axis=0)
    size = np.array(PLAIN_SIZE)
    scale = float(np.clip(0.8 * np.min(size / np.maximum(high - low, 0.2)), 1.5, 1e4))
    middle = (low + high) / 2
    origin = size / 2 + scale * middle * (-1.0, 1.0)
    keys = np.zeros(1, np.int64)
    return View(Coordinates(keys, origin[None], np.zeros(1), np.full((1, 2), scale)))


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
    detections: pd.DataFrame,
    view: View,
    marks: Array,
    simulations: Mapping[str, pd.DataFrame] | None = None,
) -> str:
    """Make a project with one tab.

    Parameters
    ----------
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`.
    view : View
        What the tracks are shown over.
    marks : ndarray, shape (n, 2)
        Where each detection is in the picture, Tracker's pixels.
    simulations : mapping, optional
        Tables with ``stone, t, x, y`` by the name of the model.
    """
    clock = _Clock.of(detections)
    tracks = [
        _point_mass(str(stone), rows, marks[rows.index], colour)
        for (stone, rows), colour in zip(
            detections.reset_index(drop=True).groupby("stone", sort=False),
            _cycle(detections["stone"].nunique()),
            strict=True,
        )
    ]
    for (model, table), colour in zip(
        (simulations or {}).items(), _cycle(len(simulations or {}), 2), strict=True
    ):
        tracks.append(_external_model(model, table, clock, colour))
    root = thing(
        f"{_TRACKER}TrackerPanel",
        [
            entry("semantic_version", "6.2.0"),
            entry("width", float(view.size[0])),
            entry("height", float(view.size[1])),
            nested("videoclip", _clip(view, clock)),
            nested(
                "clipcontrol",
                thing(
                    f"{_MEDIA}core.StepperClipControl",
                    [
                        entry("rate", 1.0),
                        entry("delta_t", 1000 * clock.duration),
                        entry("frame", clock.first),
                    ],
                ),
            ),
            nested("coords", _coordinates(view.coordinates)),
            entry("length_unit", "m"),
            entry("mass_unit", "kg"),
            entry("units_visible", True),
            collection("tracks", tracks),
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
    def of(cls, detections: pd.DataFrame) -> _Clock:
        by_frame = detections.drop_duplicates("frame").sort_values("frame")
        frames, t = by_frame["frame"].to_numpy(int), by_frame["t"].to_numpy(float)
        first, last = int(frames[0]), int(frames[-1])
        duration = float((t[-1] - t[0]) / (last - first)) if last > first else 0.04
        times = np.interp(np.arange(first, last + 1), frames, t)
        return cls(first, last, float(t[0]), duration, times)


def _clip(view: View, clock: _Clock) -> list[str]:
    return thing(
        f"{_MEDIA}core.VideoClip",
        [
            *([nested("video", _video(view, clock))] if view.video else []),
            entry("video_framecount", max(view.frames, clock.last + 1)),
            entry("startframe", clock.first),
            entry("stepsize", 1),
            entry("stepcount", clock.last - clock.first + 1),
            entry("starttime", 1000 * clock.start),
        ],
    )


def _video(view: View, clock: _Clock) -> list[str]:
    path = entry("path", view.video[0])
    if Path(view.video[0]).suffix.lower() not in IMAGE_SUFFIXES:
        return thing(f"{_MEDIA}xuggle.XuggleVideo", [path])
    pictures = strings("paths", dict(enumerate(view.video)))
    step = entry("delta_t", 1000 * clock.duration)
    return thing(f"{_MEDIA}core.ImageVideo", [pictures, path, step])


def _coordinates(system: Coordinates) -> list[str]:
    cls = f"{_MEDIA}core.ImageCoordSystem"
    fixed = len(system.keys) == 1
    rows = np.column_stack([system.origin, np.degrees(system.angle), system.scale])
    names = ("xorigin", "yorigin", "angle", "xscale", "yscale")
    data = {
        # Frames before the first key are drawn with it.
        0 if k == 0 else int(key): thing(
            f"{cls}$FrameData",
            [entry(name, float(v)) for name, v in zip(names, row, strict=True)],
        )
        for k, (key, row) in enumerate(zip(system.keys, rows, strict=True))
    }
    return thing(
        cls,
        [
            entry("fixedorigin", fixed),
            entry("fixedangle", fixed),
            entry("fixedscale", fixed),
            entry("locked", True),
            sparse("framedata", f"{cls}$FrameData", data),
        ],
    )


def _point_mass(
    stone: str, rows: pd.DataFrame, marks: Array, colour: tuple[int, int, int]
) -> list[str]:
    cls = f"{_TRACKER}PointMass"
    data = {
        int(frame): thing(f"{cls}$FrameData", [entry("x", float(x)), entry("y", float(y))])
        for frame, (x, y) in zip(rows["frame"], marks, strict=True)
    }
    return thing(
        cls,
        [
            entry("mass", STONE.mass),
            entry("name", stone),
            entry("team", str(rows["team"].iloc[0])),
            *_look(colour, _MARK),
            *_texts(rows),
            sparse("framedata", f"{cls}$FrameData", data),
            numbers("measured", rows[list(MEASURED)].to_numpy(float)),
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
            columns += strings(f"[{len(labels)}]", entries)
            labels[len(labels)] = label
    if not labels:
        return []
    return [
        strings("text_column_names", labels),
        array("text_column_entries", f"[{STRINGS}", columns),
    ]


def _external_model(
    model: str, table: pd.DataFrame, clock: _Clock, colour: tuple[int, int, int]
) -> list[str]:
    """Give all stones of a simulation at the steps of the clip, resting where it ends."""
    properties = [entry("name", model), *_look(colour, _MODEL), numbers("t", clock.times)]
    for k, (stone, rows) in enumerate(table.groupby("stone")):
        # The first point is the model's own, the others are numbered.
        end = "" if k == 0 else str(k - 1)
        for axis in ("x", "y"):
            at = np.interp(clock.times, rows["t"], rows[axis])
            properties.append(numbers(f"{axis}{end}", at))
        properties.append(entry(f"pointname{end}", str(stone)))
        properties.append(entry(f"mass{end}", STONE.mass))
        if end:
            properties += [_colour(colour, f"color{end}"), entry(f"footprint{end}", _MODEL)]
    properties.append(entry("start_frame", clock.first))
    return thing(f"{_TRACKER}ParticleDataTrack", properties)


def _look(colour: tuple[int, int, int], footprint: str) -> list[list[str]]:
    """Make a track visible, which Tracker does not unless told.

    Without the trail of past places: they lie elsewhere once the camera has moved.
    """
    return [_colour(colour), entry("footprint", footprint), entry("visible", True)]


def _cycle(count: int, start: int = 0) -> list[tuple[int, int, int]]:
    return [_COLOURS[(start + k) % len(_COLOURS)] for k in range(count)]


def _colour(colour: tuple[int, int, int], name: str = "color") -> list[str]:
    parts = zip(("red", "green", "blue", "alpha"), (*colour, 255), strict=True)
    return nested(name, thing("java.awt.Color", [entry(part, v) for part, v in parts]))
