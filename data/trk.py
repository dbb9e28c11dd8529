"""Tracker's projects (``.trk``): marks in pixels, the moving coordinate system, the clip.

Facts about the format are from the source of Tracker 6.3 and of versions 4 and 5. Pixels are
Tracker's: the origin is the corner of the top left pixel, y points down, and they belong to
the picture after the video's filters.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from curlshot.data.errors import InputError
from curlshot.data.track_file import TrackFile
from curlshot.data.tracks import LENGTHS
from curlshot.data.units import LENGTH_UNITS, abbreviated

Array = NDArray[np.float64]
Frames = NDArray[np.int64]

TEXT_COLUMNS: Mapping[str, str] = {
    "theta": "theta(rad)", "sd_x": "sd_x(m)", "sd_y": "sd_y(m)", "sd_theta": "sd_theta(rad)",
    "sd_place_x": "sd_place_x(m)", "sd_place_y": "sd_place_y(m)",
    "rise_a": "rise_a(rad)", "rise_b": "rise_b(rad)",
}  # fmt: skip
"""Columns of text in which this program gives Tracker what it has no columns for."""

MEASURED = ("t", "x", "y", *TEXT_COLUMNS)
"""What this program adds to each mark, in this order."""


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
    measured : ndarray, shape (n, 9)
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
            clip = "; its clip can be measured (`clip`)" if self.video else ""
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
                f"{self.source}: marked on a video changed by filters"
                f" ({', '.join(self.filters)}); places are as Tracker shows them, the frames are"
                " not changed here"
            )
        parts = []
        for track in self.masses:
            part = self._rows(track)
            if part.empty:
                warnings.append(f"{self.source}: {track.name} has no mark in the clip; left out")
                continue
            if track.filled:
                warnings.append(
                    f"{self.source}: Tracker filled in {track.filled} places of {track.name}"
                    " between marks; they are used as if measured"
                )
            parts.append(part)
        if not parts:
            raise InputError(f"{self.source}: no point mass with a mark in the clip")
        self.refuse_uncalibrated()
        unit = self.length_unit or None
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
        metre = 1 / LENGTH_UNITS.get(abbreviated(self.length_unit), 1.0)
        texts = {
            name: column[used] * (metre if name in LENGTHS else 1.0)
            for name, column in track.texts.items()
        }
        return pd.DataFrame({"stone": track.name, **known, **texts})
