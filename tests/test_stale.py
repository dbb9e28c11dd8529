"""A folder that is written again holds nothing of an earlier run beside the new files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import pipeline
from data.tracks import TRACK_COLUMNS

OLD = "old"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An earlier run, and a file of one's own."""
    out = tmp_path / "shot"
    for name in pipeline.WRITTEN:
        if "." in name:
            (out / name).parent.mkdir(parents=True, exist_ok=True)
            (out / name).write_text(OLD)
        else:
            (out / name).mkdir(parents=True)
            (out / name / "plan.svg").write_text(OLD)
    (out / "notes.txt").write_text("mine")
    return out


def glide(path: Path) -> Path:
    """Tracks of one stone that glides."""
    t = np.arange(60) / 25
    table = pd.DataFrame({"stone": "A", "frame": np.arange(60), "t": t, "x": 0.1})
    table["y"] = 1.5 * t - 0.0109 * 9.81 * t**2 / 2
    table["sd_x"] = table["sd_y"] = 0.003
    path.parent.mkdir(parents=True, exist_ok=True)
    table.reindex(columns=list(TRACK_COLUMNS)).assign(seen=1).to_csv(path, index=False)
    return path


def left(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_estimates_of_other_tracks_stand_alone(folder, tmp_path):
    tracks = glide(tmp_path / "other.csv")
    assert pipeline.main(["estimate", str(tracks), "-o", str(folder), "-q"]) == 0
    assert left(folder) == {"results.json", "notes.txt"}
    assert (folder / "results.json").read_text() != OLD


def test_estimates_stay_beside_their_own_tracks(folder):
    tracks = glide(folder / "tracks.csv")
    text = tracks.read_text()
    assert pipeline.main(["estimate", str(tracks), "-o", str(folder), "-q"]) == 0
    assert left(folder) == {"results.json", "tracks.csv", "camera.csv", "notes.txt"}
    assert tracks.read_text() == text


def test_tracks_stay_alone(folder):
    clip = str(pipeline.sample_clip())
    assert pipeline.main(["track", clip, "--frames", "0:8", "-o", str(folder), "-q"]) == 0
    assert left(folder) == {"tracks.csv", "camera.csv", "notes.txt"}
    assert all((folder / name).read_text() != OLD for name in ("tracks.csv", "camera.csv"))


def test_a_failure_leaves_the_earlier_run(folder, tmp_path):
    assert pipeline.main(["estimate", str(tmp_path / "none.csv"), "-o", str(folder), "-q"]) == 2
    assert left(folder) == {*pipeline.WRITTEN, "notes.txt"}
