"""A camera that is given: the table ``camera.csv`` read back, for a still camera or per frame."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import STONE
from curlshot.vision.optics.camera import CAMERA_COLUMNS, Camera
from curlshot.vision.optics.placed import Placed, nobody
from curlshot.vision.video.reader import Video

Array = NDArray[np.float64]

HOMOGRAPHY = tuple(f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
PLACE = ("f_px", "cam_x", "cam_y", "cam_z")
ABSENT = {"k1": 0.0, "k2": 0.0, "found": 1.0}
"""What a column that is left out means; the others mean that nothing is known."""

LEAST_AREA = 1e-3
"""Picture of a square metre at the tee, px², below which a homography is singular."""


def given_cameras(
    video: Video, path: Path, progress: Progress = no_progress, placed: Placed = nobody
) -> tuple[tuple[Camera, ...], tuple[str, ...]]:
    """Give the frames of a clip the cameras of a table, and what a person should know.

    Parameters
    ----------
    video : Video
        Says the size of the picture and the time of each frame.
    path : Path
        A table as ``camera.csv``: of one row, for all frames, or of one row per frame; frames
        without one are left out. Only the homography is needed, and with several rows `frame`;
        further columns are ignored.
    progress : Progress
    placed : Placed
        Told of each frame that has a camera.

    Raises
    ------
    InputError
        A file that is no such table, or that has no camera for any frame of the clip.
    """
    table = read_cameras(path)
    frames = table["frame"].astype(int).tolist()
    row = {frame: k for k, frame in enumerate(frames)}
    cameras = []
    for done, frame in enumerate(video, 1):
        if len(row) == 1 or frame.index in row:
            given = table.iloc[row.get(frame.index, 0)]
            cameras.append(_camera(given, frame.index, frame.t, video.size))
            placed(frame, cameras[-1])
        progress("camera", done, video.expected)
    if not cameras:
        raise InputError(
            f"{path}: has frames {min(row)} to {max(row)}, none of the selected ones of"
            f" {video.files[0].name}"
        )
    notes = [f"{path.name}: the errors do not include that of the given camera"]
    if any(camera.position is None for camera in cameras):
        notes.append(
            f"{path.name}: the position of the camera is not given; since caps are above the ice,"
            " stones away from the point below it may be centimetres wrong"
        )
    if len(cameras) < video.read:
        left = video.read - len(cameras)
        notes.append(f"{path.name}: no camera for {left} of {video.read} frames; left out")
    return tuple(cameras), tuple(notes)


def cameras_of(path: Path, size: tuple[int, int]) -> dict[int, Camera]:
    """Read the cameras of a run by their frames, for pictures of a size.

    Raises
    ------
    InputError
        As `read_cameras`, and where a column of ``camera.csv`` is missing.
    """
    table = read_cameras(path, CAMERA_COLUMNS)
    return {
        int(row["frame"]): _camera(row, int(row["frame"]), float(row["t"]), size)
        for _, row in table.iterrows()
    }


def read_cameras(path: Path, columns: Sequence[str] = ()) -> pd.DataFrame:
    """Read a table of cameras, with `CAMERA_COLUMNS`; NaN where something is not known.

    Parameters
    ----------
    path : Path
    columns : sequence of str
        What must be there beyond what is needed, though cells may be empty.

    Raises
    ------
    InputError
        Where it makes no sense: one line says what, and in which line of the file.
    """
    table = _table(path, columns)
    # The picture's scale of a homography is free: h33 = 1 as elsewhere.
    with np.errstate(all="ignore"):
        matrices = table[list(HOMOGRAPHY)].to_numpy() / table[["h33"]].to_numpy()
        area = -np.linalg.det(np.nan_to_num(matrices).reshape(-1, 3, 3))
    table[list(HOMOGRAPHY)] = matrices
    # At half way to the corners a lens may not fold the picture.
    slope = 1 + 3 / 4 * table["k1"] + 5 / 16 * table["k2"]
    low = table["cam_z"] <= STONE.cap_height
    doubled = table["frame"].duplicated()
    whole = (table["frame"] >= 0) & (table["frame"] % 1 == 0)
    for wrong, what in (
        (~np.isfinite(matrices).all(1), "h33 is 0: the tee would be at the horizon"),
        (np.abs(area) < LEAST_AREA, "the homography is singular"),
        (area < 0, "the homography is mirrored; x goes to the right and y up in the frame"),
        (~(slope > 0), "k1 and k2 fold the image"),
        (low, "cam_z is not above the stones"),
        (~whole, "frame is not a whole number from 0"),
        (doubled, "a repeated frame; one row per frame"),
    ):
        if np.any(wrong):
            raise InputError(f"{path}: line {_line(np.asarray(wrong))}: {what}")
    return table


def _table(path: Path, columns: Sequence[str]) -> pd.DataFrame:
    """Read the columns as numbers."""
    try:
        text = pd.read_csv(path, dtype=str, skipinitialspace=True, encoding_errors="replace")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise InputError(f"{path}: a folder, not a table of cameras") from None
    except (OSError, ValueError) as error:
        why = " ".join(str(error).split())
        raise InputError(f"{path}: not a table of cameras ({why})") from None
    text.columns = text.columns.str.strip()
    doubled = text.columns[text.columns.duplicated()]
    if len(doubled):
        raise InputError(f"{path}: column {doubled[0]} occurs twice")
    needed = HOMOGRAPHY if len(text) == 1 else ("frame", *HOMOGRAPHY)
    missing = [name for name in dict.fromkeys((*needed, *columns)) if name not in text]
    if missing:
        raise InputError(
            f"{path}: no column {', '.join(missing)}; not a table of cameras, which needs those"
            " of a camera.csv"
        )
    if text.empty:
        raise InputError(f"{path}: has no row")
    table = pd.DataFrame(index=text.index)
    for name in CAMERA_COLUMNS:
        empty = ABSENT.get(name, float("nan"))
        given = text[name].fillna("").str.strip() if name in text else pd.Series("", text.index)
        numbers = pd.to_numeric(given.mask(given == "", str(empty)), errors="coerce")
        table[name] = numbers.astype(float)
        known = np.isfinite(numbers)
        wrong = ~known if name in needed else ~known & ~given.str.lower().isin(("", "nan"))
        if wrong.any():
            line = _line(wrong.to_numpy())
            raise InputError(f"{path}: line {line}: {name} is not a number")
    if len(table) == 1:
        table["frame"] = table["frame"].fillna(0)
    return table


def _line(wrong: NDArray[np.bool_]) -> int:
    """Line of the file in which the first row stands of which this is true."""
    return int(wrong.argmax()) + 2


def _camera(row: pd.Series, frame: int, t: float, size: tuple[int, int]) -> Camera:
    focal, *place = (float(row[name]) for name in PLACE)
    known = bool(np.isfinite([focal, *place]).all())
    return Camera(
        frame=frame,
        t=t,
        homography=row[list(HOMOGRAPHY)].to_numpy(float).reshape(3, 3),
        size=size,
        k1=float(row["k1"]),
        k2=float(row["k2"]),
        f_px=focal if known else float("nan"),
        position=np.array(place) if known else None,
        rms_px=float(row["rms_px"]),
        found=bool(row["found"] > 0),
    )
