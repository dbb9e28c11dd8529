"""What ``curlshot check`` looks at in a clip, and what it says of it in a few lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd

from curlshot.report.numbers import count, warned
from curlshot.vision.detection.detection import Detection, Refusal
from curlshot.vision.optics.camera import Camera, camera_table
from curlshot.vision.video.frame import Frame

COLUMNS, UPRIGHT_COLUMNS = 4, 6
"""Frames beside one another on the sheet; of clips that are higher than wide."""

MOST = 3 * COLUMNS
"""Frames on the sheet: as many as a person takes in at one look."""


@dataclass(frozen=True)
class Look:
    """One frame of the sheet.

    Attributes
    ----------
    frame : Frame
    camera : Camera
    stones : sequence of Detection
        What was taken for a stone.
    refused : sequence of Refusal
        What looked like one and was refused, and why.
    """

    frame: Frame
    camera: Camera
    stones: Sequence[Detection]
    refused: Sequence[Refusal] = ()


def check_table(cameras: Sequence[Camera], rim: float) -> pd.DataFrame:
    """As `curlshot.vision.optics.camera.camera_table`, with the stated error of a place at the rim.

    Parameters
    ----------
    cameras : sequence of Camera
    rim : float
        Radius of the 12-ft ring, m; 0 where there is no house.

    Returns
    -------
    DataFrame
        With a column ``sd``: m per axis, the mean over four points of the ring.
    """
    around = rim * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    return camera_table(cameras).assign(
        sd=[float(np.mean(camera.place_sd(around))) for camera in cameras]
    )


def frames_to_show(cameras: pd.DataFrame) -> list[int]:
    """Choose `MOST` frames spread over the clip, the one with the largest residual among them.

    Parameters
    ----------
    cameras : DataFrame
        With ``frame`` and ``rms_px``.

    Returns
    -------
    list of int
        Frame numbers in order.
    """
    at = np.unique(np.round(np.linspace(0, len(cameras) - 1, MOST)).astype(int))
    residual = np.nan_to_num(cameras["rms_px"].to_numpy(float), nan=0.0)
    worst = int(residual.argmax())
    if worst not in at:
        nearest = 1 + int(np.abs(at[1:-1] - worst).argmin()) if len(at) > 2 else 0
        at[nearest] = worst
    return [int(frame) for frame in cameras["frame"].iloc[np.sort(at)]]


def check_lines(
    name: str,
    read: int,
    cameras: pd.DataFrame,
    looks: Sequence[Look],
    warnings: Sequence[str] = (),
) -> list[str]:
    """Say in a few lines how far a clip can be trusted.

    Parameters
    ----------
    name : str
        Of the clip.
    read : int
        Frames read.
    cameras : DataFrame
        As `check_table` gives it.
    looks : sequence of Look
    warnings : sequence of str

    Returns
    -------
    list of str
        Input, camera, places where known, stones, warnings.
    """
    carried = int((cameras["found"] == 0).sum())
    rms, sd = cameras["rms_px"], 1000 * cameras["sd"]
    edges = f"edge residual {rms.median():.2f} px, worst frame {rms.max():.2f} px"
    if rms.isna().all():
        edges = "edges not measured"
    lines = [
        f"input       {name}: {count(read, 'frame')}",
        f"camera      known in {count(len(cameras), 'frame')}, carried over in {carried} of them;"
        f" {edges}",
    ]
    if sd.max() > 0:
        lines.append(
            f"places      known to {sd.median():.1f} mm at the 12-ft ring,"
            f" worst frame {sd.max():.1f} mm (one standard error)"
        )
    most = max(len(look.stones) for look in looks)
    lines.append(f"stones      {most} at most in one of {count(len(looks), 'frame')} examined")
    return lines + warned(warnings)


def way_of_play(looks: Sequence[Look], radius: float) -> int:
    """Tell which way stones are thrown, as `report.tables.play` does of tracks: 1 up y, -1 down.

    All that moves goes that way on the whole. Where more or fewer are seen than just before, one
    came into view or was covered.
    """
    along = 0.0
    for before, after in pairwise([stone.y for stone in look.stones] for look in looks):
        if len(before) == len(after):
            along += sum(after) - sum(before)
    return 1 if along > radius else -1


def numbered(refused: Sequence[Refusal], apart: float) -> list[Refusal]:
    """Choose the refused places that get a number: one of those that lie on one another."""
    chosen: list[Refusal] = []
    for place in refused:
        near = [item for item in chosen if np.hypot(item.x - place.x, item.y - place.y) < apart]
        if all(item.reason != place.reason for item in near):
            chosen.append(place)
    return chosen
