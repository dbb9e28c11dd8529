"""A text as a file of tracks, and what it holds."""

from __future__ import annotations

from pathlib import Path

from curlshot.data.layouts import read_layout
from curlshot.data.track_file import TrackFile


def read(folder: Path, text: str, fps: float | None = None, name: str = "shot.txt") -> TrackFile:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return read_layout(path, fps)


def stones(file: TrackFile) -> list[str]:
    return list(file.tracks["stone"].unique())


def xy(file: TrackFile, stone: str) -> list[list[float]]:
    rows = file.tracks[file.tracks["stone"] == stone]
    return [list(row) for row in rows[["x", "y"]].to_numpy()]
