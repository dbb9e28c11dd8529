"""Cameras as Tracker has them: one similarity per frame, closest at the tee."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from curlshot.data.convert import Projected
from curlshot.data.errors import InputError
from curlshot.data.files import relative_path
from curlshot.data.measurement import Measurement
from curlshot.data.sheet import HOUSE
from curlshot.data.trk import Coordinates
from curlshot.data.trk_write import View
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.camera_file import cameras_of
from curlshot.vision.video.reader import Video, open_video

Array = NDArray[np.float64]

CORNER = 0.5
"""Tracker counts pixels from the corner of the first, OpenCV from its middle, px."""


def projected(measured: Measurement, clip_files: Sequence[Path], path: Path) -> Projected:
    """Return tracks over a clip, by the ``camera.csv`` beside them, for a project to be written.

    Parameters
    ----------
    measured : Measurement
        The tracks.
    clip_files : sequence of Path
        The clip that Tracker shall show.
    path : Path
        The project; a .trz holds the clip.

    Raises
    ------
    InputError
        No clip, no such table of cameras, or not of these tracks.
    """
    clip = open_video(clip_files)
    packed: dict[str, Path] = {}
    if path.suffix.lower() == ".trz":
        packed = {f"videos/{file.name}": file for file in clip.files}
    video = tuple(packed) or tuple(relative_path(file, path.parent) for file in clip.files)
    camera_csv = measured.files[0].parent / "camera.csv"
    return Projected(*view_over(clip, camera_csv, measured.detections, video), packed)


def view_over(
    clip: Video, camera_csv: Path, detections: pd.DataFrame, video: tuple[str, ...]
) -> tuple[View, Array, float]:
    """Place tracks in the pictures of a clip by the cameras of a run.

    Parameters
    ----------
    clip : Video
        What Tracker shall show.
    camera_csv : Path
        Of the run that measured the tracks.
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`.
    video : tuple of str
        Where Tracker finds the clip's files, from the project's folder.

    Returns
    -------
    View
        The clip, with the camera as Tracker's coordinate system.
    ndarray, shape (n, 2)
        Where each detection is in the picture, Tracker's pixels.
    float
        How far off Tracker shows places at the 12-ft ring, m, at worst.

    Raises
    ------
    InputError
        No such table of cameras, or not of these tracks.
    """
    if not camera_csv.is_file():
        raise InputError(f"{camera_csv}: no such file; `over` needs tracks.csv and camera.csv")
    cameras = cameras_of(camera_csv, clip.size)
    unknown = sorted(set(detections["frame"]) - set(cameras))
    if unknown:
        raise InputError(f"{camera_csv}: no camera of frame {unknown[0]}; not of the same run")
    system = closest_similarity(list(cameras.values()))
    marks = marks_of(cameras, detections["frame"], detections[["x", "y"]].to_numpy(float))
    off = off_at(system, list(cameras.values()), HOUSE.twelve_foot)
    return View(system, clip.size, video, clip.expected), marks, off


def closest_similarity(cameras: Sequence[Camera]) -> Coordinates:
    """Tracker's coordinate systems that agree with cameras at the tee.

    Origin, and, of all rotations with one scale, the one closest (least squares) to the
    derivative of the projection there.

    Parameters
    ----------
    cameras : sequence of Camera
        In the order of their frames.
    """
    step = 1e-4  # for the derivative, m
    around = step * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]], float)
    pixels = np.array([camera.project(around) for camera in cameras])
    along_x = (pixels[:, 1] - pixels[:, 2]) / (2 * step)
    along_y = (pixels[:, 3] - pixels[:, 4]) / (2 * step)
    cos = (along_x[:, 0] - along_y[:, 1]) / 2
    sin = -(along_x[:, 1] + along_y[:, 0]) / 2
    scale = np.hypot(cos, sin)
    return Coordinates(
        np.array([camera.frame for camera in cameras], np.int64),
        pixels[:, 0] + CORNER,
        np.arctan2(sin, cos),
        np.column_stack([scale, scale]),
    )


def off_at(system: Coordinates, cameras: Sequence[Camera], radius: float) -> float:
    """How far Tracker shows places on a circle about the tee from where they are, m, at worst."""
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    worst = [
        np.hypot(*(system.world(np.full(len(ring), c.frame), c.project(ring) + CORNER) - ring).T)
        for c in cameras
    ]
    return float(np.max(worst))


def marks_of(cameras: dict[int, Camera], frames: ArrayLike, places: Array) -> Array:
    """Where places on the ice are in the pictures, Tracker's pixels, shape (n, 2)."""
    marks = [
        cameras[int(frame)].project(place)
        for frame, place in zip(np.asarray(frames), places, strict=True)
    ]
    return np.array(marks) + CORNER
