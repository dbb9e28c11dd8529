"""Tables and projects of an invented shot, in the dialects that people have.

Each function writes one set of files into a folder and returns their paths. The shot is known:
stone A hits B and, in the longer one, B hits C.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from pathlib import Path

import numpy as np
import pandas as pd

from curlshot.data.export import write_csv, write_text
from curlshot.data.tracks import check_detections, write_tracks
from curlshot.data.trk import Coordinates
from curlshot.data.trk_write import View, plain_view, project_xml, write_trk, write_trz
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.synthetic.physics import RADIUS, Ice, Impact, simulate
from curlshot.synthetic.scenes import sample_scene
from curlshot.tests.helpers.data.dialects import archive, export, java, project

FPS = 25.0
PLACE_SD, ANGLE_SD = 0.002, 0.02
"""Standard errors of what is read from the frames, m and rad."""

Writer = Callable[[Path], list[Path]]


@cache
def shot(stones: int = 3, duration: float = 4.0) -> pd.DataFrame:
    """Return the measured places of the shot of the bundled clip, of so many of its stones."""
    scene = sample_scene()
    starts = [stone.start for stone in scene.stones[:stones]]
    motion = simulate(starts, duration + 0.1, ice=Ice(b=0.0115), impact=Impact(0.82, 0.06))
    rng = np.random.default_rng(stones)
    frame = np.arange(round(duration * FPS))
    tables = []
    for index, states in enumerate(np.moveaxis(motion.at(frame / FPS), 1, 0)):
        table = pd.DataFrame({"stone": "ABC"[index], "frame": frame, "t": frame / FPS})
        table[["x", "y"]] = states[:, :2] + rng.normal(0, PLACE_SD, (len(frame), 2))
        table["theta"] = states[:, 2] + rng.normal(0, ANGLE_SD, len(frame))
        tables.append(table)
    return check_detections(pd.concat(tables, ignore_index=True))


def in_tracker(
    folder: Path,
    *,
    ending: str = ".txt",
    encoding: str = "utf-8",
    newline: str = "\n",
    names: Mapping[str, str] | None = None,
    scale: float = 1.0,
    step: int = 1,
    stones: int = 3,
    degrees: bool = False,
    columns: Sequence[str] = ("x", "y"),
    delimiter: str = "\t",
    pattern: str = "full",
    decimal: str = ".",
    swedish: bool = False,
) -> list[Path]:
    """Write all stones into one file, as Tracker exports them."""
    table = shot(stones)
    table = table[table["frame"] % step == 0]
    table = table.assign(x=scale * table["x"], y=scale * table["y"])
    if names is not None:
        table = table.assign(stone=table["stone"].map(names))
    if degrees:
        table = table.assign(θ=np.degrees(table["theta"]))
    text = export(table, delimiter, pattern, decimal, swedish, columns)
    path = folder / f"shot{ending}"
    path.write_bytes(text.replace("\n", newline).encode(encoding))
    return [path]


def file_for_each(folder: Path, *, ending: str = ".txt", **how: object) -> list[Path]:
    """Write one file for each stone, as Tracker exports a single track."""
    paths = []
    for stone, rows in shot().groupby("stone"):
        paths.append(folder / f"{stone}{ending}")
        text = export(rows, columns=("x", "y"), **how)  # type: ignore[arg-type]
        paths[-1].write_text(text, encoding="utf-8")
    return paths


def table_copy(
    folder: Path, *, pattern: str = "full", decimal: str = ".", swedish: bool = False
) -> list[Path]:
    """Write one file for each stone, as Tracker puts its table on the clipboard."""
    paths = []
    for stone, rows in shot().groupby("stone"):
        text = export(rows, pattern=pattern, decimal=decimal, swedish=swedish, columns=("x", "y"))
        first, second, *body = text.splitlines()
        paths.append(folder / f"{stone}.txt")
        lines = [first.rstrip("\t"), second.rstrip("\t"), *body]
        paths[-1].write_text("\n".join(lines) + "\n", encoding="utf-8")
    return paths


def legacy(folder: Path) -> list[Path]:
    """Write one file for each stone, as versions 4 and 5 of Tracker did."""
    paths = []
    for stone, rows in shot(2).groupby("stone"):
        lines = [f"mass_{stone}", "t\tx\ty\tv_{x}\tv_{y}"]
        for t, x, y in rows[["t", "x", "y"]].to_numpy(float):
            lines.append(f"{t:.3f}\t{java(x, '4')}\t{java(y, '4')}\t\t")
        paths.append(folder / f"mass_{stone}.txt")
        paths[-1].write_text("\n".join(lines) + "\n", encoding="utf-8")
    return paths


def own_project(folder: Path, *, packed: bool = False) -> list[Path]:
    """Write a project of this program, on axes that move where it is packed."""
    table = shot()
    view = plain_view(table)
    if packed:
        frames = np.arange(table["frame"].max() + 1)
        origin = np.column_stack([640 + 1.5 * frames, 360 - 0.5 * frames])
        scale = np.repeat((90 + 0.2 * frames)[:, None], 2, axis=1)
        view = View(Coordinates(frames, origin, np.radians(5 + 0.1 * frames), scale))
    marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy(float))
    text = project_xml(table, view, marks)
    path = folder / ("shot.trz" if packed else "shot.trk")
    if packed:
        write_trz(text, path, {})
    else:
        write_trk(text, path)
    return [path]


def tracker_project(folder: Path, *, moving: bool, packed: bool = False) -> list[Path]:
    """Write a project as Tracker does, on axes that stand or move."""
    table = shot()
    last = int(table["frame"].max())
    keys = {
        n: (640 + 1.5 * n, 300 - 0.5 * n, 4 + 0.1 * n, 110 - 0.2 * n, 110 - 0.2 * n)
        for n in (range(last + 1) if moving else (0,))
    }
    rows = np.array([*keys.values()])
    axes = Coordinates(np.array([*keys]), rows[:, :2], np.radians(rows[:, 2]), rows[:, 3:])
    pixels = axes.pixels(table["frame"], table[["x", "y"]].to_numpy(float))
    marks: dict[str, dict[int, tuple[float, float]]] = {}
    for (stone, frame), (x, y) in zip(
        table[["stone", "frame"]].itertuples(index=False), pixels, strict=True
    ):
        marks.setdefault(stone, {})[frame] = (round(x, 3), round(y, 3))
    text = project(marks, keys, mass=dict.fromkeys(marks, 19.1), duration=1000 / FPS)
    path = folder / ("shot.trz" if packed else "shot.trk")
    path.write_bytes(archive({"shot.trk": text}) if packed else text.encode())
    return [path]


def wide_table(folder: Path, *, scale: float = 1.0, unit: str = "") -> list[Path]:
    """Write a table with the stones side by side, in a unit that the header names."""
    table = shot()
    columns = {"t (s)": table.loc[table["stone"] == "A", "t"].to_numpy()}
    for stone, rows in table.groupby("stone"):
        for axis in ("x", "y"):
            columns[f"{axis}{stone}{unit}"] = (scale * rows[axis]).round(4).to_numpy()
    path = folder / "shot.csv"
    pd.DataFrame(columns).to_csv(path, index=False)
    return [path]


def long_table(folder: Path, *, times: bool = True) -> list[Path]:
    """Write a row for each stone and frame: with all columns, or numbers of frames alone."""
    path = folder / "shot.csv"
    if times:
        write_csv(shot(), path)
    else:
        shot()[["stone", "frame", "x", "y"]].to_csv(path, index=False)
    return [path]


def tracker_import(folder: Path) -> list[Path]:
    """Write the text that Tracker imports."""
    path = folder / "shot.txt"
    write_text(shot(), path)
    return [path]


def own_tracks(folder: Path, *, measured: bool) -> list[Path]:
    """Write the tracks of an earlier run, with what was measured or the smoothed places alone."""
    table = shot(2).assign(sd_x=PLACE_SD, sd_y=PLACE_SD, sd_theta=ANGLE_SD)
    path = folder / "tracks.csv"
    tracks = smooth(table, detect_hits(table, RADIUS), radius=RADIUS)
    write_tracks(tracks, path, table if measured else None)
    return [path]


NORDIC = {"A": "röd", "B": "gul", "C": "blå"}

WRITERS: Mapping[str, Writer] = {
    "tab_full": in_tracker,
    "tab_formatted": partial(in_tracker, pattern="4"),
    "one_hit": partial(in_tracker, stones=2, columns=("x", "y", "vx", "frame")),
    "comma_full": partial(in_tracker, ending=".csv", delimiter=","),
    "comma_formatted_crlf": partial(
        in_tracker, ending=".csv", delimiter=",", pattern="4", newline="\r\n"
    ),
    "semicolon_full": partial(in_tracker, delimiter=";"),
    "semicolon_decimal_comma": partial(in_tracker, delimiter=";", pattern="4", decimal=","),
    "swedish_full": partial(in_tracker, delimiter=";", decimal=",", swedish=True),
    "swedish_formatted": partial(in_tracker, pattern="4", decimal=",", swedish=True),
    "file_for_each": file_for_each,
    "file_for_each_decimal_comma": partial(file_for_each, decimal=","),
    "table_copy_full": table_copy,
    "table_copy_swedish": partial(table_copy, decimal=",", swedish=True),
    "legacy": legacy,
    "step_2": partial(in_tracker, step=2, columns=("x", "y", "frame")),
    "degrees": partial(in_tracker, degrees=True, columns=("x", "y", "θ")),
    "centimetres": partial(in_tracker, scale=100.0),
    "latin_1": partial(in_tracker, encoding="latin-1", names=NORDIC),
    "utf_16": partial(in_tracker, encoding="utf-16", names=NORDIC),
    "tracker_project": partial(tracker_project, moving=False),
    "tracker_project_moving_axes": partial(tracker_project, moving=True),
    "tracker_archive_moving_axes": partial(tracker_project, moving=True, packed=True),
    "own_project": own_project,
    "own_archive_moving_axes": partial(own_project, packed=True),
    "wide_millimetres": partial(wide_table, scale=1000.0, unit=" (mm)"),
    "long": long_table,
    "long_frames": partial(long_table, times=False),
    "tracker_import": tracker_import,
    "tracks_measured": partial(own_tracks, measured=True),
    "tracks_smoothed": partial(own_tracks, measured=False),
}
"""What writes a table, by the name of its case."""
