"""A folder that is written again holds nothing of an earlier run beside the new files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot import pipeline
from curlshot.cli.main import main
from curlshot.config import Config
from curlshot.data.tracks import TRACK_COLUMNS
from curlshot.outcome import load
from curlshot.report.write import WRITTEN

OLD = "old"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An earlier run, and a file of one's own."""
    out = tmp_path / "shot"
    for name in WRITTEN:
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
    assert main(["estimate", str(tracks), "-o", str(folder), "-q"]) == 0
    assert left(folder) == {"results.json", "ensemble.json", "notes.txt"}
    assert (folder / "results.json").read_text() != OLD


def test_estimates_stay_beside_their_own_tracks(folder):
    tracks = glide(folder / "tracks.csv")
    text = tracks.read_text()
    assert main(["estimate", str(tracks), "-o", str(folder), "-q"]) == 0
    written = {"results.json", "ensemble.json"}
    assert left(folder) == {*written, "tracks.csv", "camera.csv", "notes.txt"}
    assert tracks.read_text() == text


def test_changed_settings_are_written_and_restored(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tracks, preset = glide(tmp_path / "other.csv"), folder / "config.toml"
    preset.write_text("[search]\nmin_evidence = 1.2\n[camera]\ncamera = '../camera.csv'\n")
    words = ["estimate", str(tracks), "-o", str(folder), "-q", "--units", "ft"]
    assert main([*words, "--config", str(preset)]) == 0
    assert left(folder) == {"results.json", "ensemble.json", "config.toml", "notes.txt"}
    camera = (tmp_path / "camera.csv").resolve()
    expected = Config().replace(min_evidence=1.2, units="ft", camera=camera)
    assert load(folder).config == expected
    assert main(words[:-2]) == 0
    assert "config.toml" not in left(folder)
    assert load(folder).config == Config()


def test_tracks_stay_alone(folder):
    clip = str(pipeline.sample_clip())
    assert main(["track", clip, "--frames", "0:8", "-o", str(folder), "-q"]) == 0
    assert left(folder) == {"tracks.csv", "camera.csv", "notes.txt"}
    assert all((folder / name).read_text() != OLD for name in ("tracks.csv", "camera.csv"))


def test_a_failure_leaves_the_earlier_run(folder, tmp_path):
    assert main(["estimate", str(tmp_path / "none.csv"), "-o", str(folder), "-q"]) == 2
    assert left(folder) == {*WRITTEN, "notes.txt"}


def test_a_run_does_not_write_over_its_own_input(folder, capsys):
    tracks = folder / "tracks.csv"
    before = tracks.read_bytes()
    assert main(["run", str(tracks), "-o", str(folder), "-q"]) == 2
    assert "would be overwritten" in capsys.readouterr().err
    assert tracks.read_bytes() == before


def test_a_broken_simulation_beside_tracks_is_one_line(folder, tmp_path, capsys):
    glide(folder / "tracks.csv")
    for text in ("", "a,b\n1,2\n", "model,stone,t,x,y\nm,A,no,1,2\n"):
        (folder / "simulation.csv").write_text(text, encoding="utf-8")
        assert main(["convert", str(folder / "tracks.csv"), str(tmp_path / "x.trk")]) == 2
        assert "not a simulation.csv" in capsys.readouterr().err


def test_a_mass_given_twice_is_refused(folder, tmp_path, capsys):
    words = ["estimate", str(glide(tmp_path / "t.csv")), "-o", str(tmp_path / "o"), "-q"]
    assert main([*words, "--mass", "A=1", "--mass", "A=2"]) == 2
    assert "given twice" in capsys.readouterr().err


def test_options_of_tables_are_refused_on_clips(tmp_path, capsys):
    for words in (["--names", "A=x"], ["--length-unit", "cm"], ["--tab", "x"]):
        command = ["run", str(pipeline.sample_clip()), "-o", str(tmp_path / "o"), "-q", *words]
        assert main(command) == 2
        assert f"only tables take {words[0]}" in capsys.readouterr().err
