from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.project import read_project, unpack_clip
from curlshot.data.tracker import read_table
from curlshot.data.tracks import check_detections
from curlshot.data.trk import Coordinates
from curlshot.data.trk_write import View, plain_view, project_xml, write_trk, write_trz

SAME = ["stone", "team", "frame", "t", "x", "y", "theta", "sd_x", "sd_y", "sd_theta"]


def shot(even: bool = True) -> pd.DataFrame:
    frame = np.arange(7, 27)
    rng = np.random.default_rng(2)
    t = frame / 30 if even else np.cumsum(rng.uniform(0.02, 0.06, len(frame)))
    a = pd.DataFrame({"stone": "A", "frame": frame, "t": t, "x": t, "y": np.sin(t), "theta": 3 * t})
    b = a.assign(stone='b & "c" <d>', x=-t / 3, theta=np.nan)[rng.uniform(size=len(t)) > 0.3]
    return check_detections(pd.concat([a.assign(team="#c02020"), b]))


def moving_view(frames: np.ndarray) -> View:
    n = len(frames)
    origin = np.column_stack([np.linspace(600, 640, n), np.linspace(400, 300, n)])
    scale = np.linspace(150, 170, n)
    angle = np.linspace(0.1, -0.2, n)
    return View(Coordinates(frames, origin, angle, np.column_stack([scale, scale])))


@pytest.mark.parametrize("even", [True, False])
def test_a_written_project_reads_back(tmp_path: Path, even: bool) -> None:
    table, path = shot(even), tmp_path / "shot.trk"
    view = moving_view(np.arange(7, 27))
    # As a perspective would have it: not where the similarity puts the places.
    marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy()) + 3.0
    write_trk(project_xml(table, view, marks), path)
    found = read_table([path])
    pd.testing.assert_frame_equal(found.detections[SAME], table[SAME], check_exact=True)
    assert found.masses == {}
    project = read_project(path)
    written = np.concatenate([mass.marks for mass in project.masses])
    np.testing.assert_array_equal(written, marks)


def test_what_tracker_saves_again_reads_by_its_marks(tmp_path: Path) -> None:
    """It keeps columns of text, so angles and errors survive, whatever unit it is told."""
    table, path = shot(), tmp_path / "shot.trk"
    table = table.assign(sd_x=0.002, sd_y=0.003, sd_theta=0.01)
    view = moving_view(np.arange(7, 27))
    marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy())
    write_trk(project_xml(table, view, marks), path)
    path.write_text(path.read_text("utf-8").replace('"measured"', '"unknown"'), "utf-8")
    found = read_table([path]).detections
    np.testing.assert_allclose(found[["t", "x", "y"]], table[["t", "x", "y"]], rtol=0, atol=1e-9)
    kept = ["frame", "theta", "sd_x", "sd_y"]
    pd.testing.assert_frame_equal(found[kept], table[kept])
    text = path.read_text("utf-8").replace('"string">m<', '"string">cm<')
    path.write_text(text.replace('">0.01<', '">a word<', 1), "utf-8")
    rescaled = read_table([path]).detections
    np.testing.assert_allclose(rescaled["x"], table["x"] / 100)
    np.testing.assert_allclose(rescaled["sd_y"], 0.003)
    assert rescaled["sd_theta"].isna().sum() == 1


@pytest.mark.parametrize("damage", ["NaN", "1e999", "x"])
def test_damaged_exact_places_are_not_used(tmp_path: Path, damage: str) -> None:
    table, path = shot(), tmp_path / "shot.trk"
    view = plain_view(table)
    marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy())
    write_trk(project_xml(table, view, marks), path)
    text = path.read_text("utf-8").replace("{{", "{{" + damage + ",", 1)
    path.write_text(text, "utf-8")
    if damage == "x":
        with pytest.raises(Exception, match="no number"):
            read_table([path])
        return
    found = read_table([path]).detections
    np.testing.assert_allclose(found[["x", "y"]], table[["x", "y"]], rtol=0, atol=1e-9)


def test_tracker_shows_what_it_is_told_to_show(tmp_path: Path) -> None:
    """Tracker takes what is not said for a no, and breaks on a model without masses."""
    table = shot()
    view = moving_view(np.arange(7, 27))
    marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy())
    text = project_xml(table, view, marks, {"frictional": table})
    tracks = text.count('tracker.PointMass">') + text.count("ParticleDataTrack")
    assert tracks == 3
    assert text.count('name="visible" type="boolean">true') == tracks
    for name in ("mass", "mass0", "color", "color0", "footprint", "footprint0"):
        assert f'name="{name}"' in text[text.index("ParticleDataTrack") :]


def test_clips_are_videos_or_pictures(tmp_path: Path) -> None:
    table = shot()
    for video, cls in ((("a b.mp4",), "XuggleVideo"), (("f/1.png", "f/2.png"), "ImageVideo")):
        view = replace(plain_view(table), video=video, frames=40)
        write_trk(project_xml(table, view, np.zeros((len(table), 2))), tmp_path / "a.trk")
        assert f'{cls}">' in (tmp_path / "a.trk").read_text("utf-8")
        assert read_project(tmp_path / "a.trk").video == video


def test_an_archive_holds_the_clip_under_its_name_in_the_project(tmp_path: Path) -> None:
    table, clip = shot(), tmp_path / "c.mp4"
    clip.write_bytes(b"clip")
    view = replace(plain_view(table), video=("videos/c.mp4",))
    project = project_xml(table, view, np.zeros((len(table), 2)))
    write_trz(project, tmp_path / "shot.trz", {"videos/c.mp4": clip})
    found = read_table([tmp_path / "shot.trz"]).detections
    pd.testing.assert_frame_equal(found[SAME], table[SAME], check_exact=True)
    (tmp_path / "to").mkdir()
    _, files = unpack_clip(tmp_path / "shot.trz", None, tmp_path / "to")
    assert [file.read_bytes() for file in files] == [b"clip"]


def test_a_plain_view_shows_all_places(tmp_path: Path) -> None:
    table = shot()
    view = plain_view(table)
    marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy())
    assert (marks > 0).all()
    assert (marks < view.size).all()


def test_simulations_are_external_models_at_the_steps_of_the_clip(tmp_path: Path) -> None:
    table, path = shot(), tmp_path / "shot.trk"
    view = plain_view(table)
    marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy())
    model = table[table["stone"] == "A"].iloc[5:]
    both = pd.concat([model, model.assign(stone="B", y=1.0)])
    write_trk(project_xml(table, view, marks, {"frictional": both}), path)
    text = path.read_text("utf-8")
    part = text[text.index("ParticleDataTrack") :]
    for name in ("x", "y", "t", "pointname", "x0", "y0", "pointname0", "start_frame"):
        assert f'name="{name}"' in part
    xs = part[part.index('name="x"') :].split("{")[1].split("}")[0].split(",")
    assert len(xs) == 20
    np.testing.assert_allclose([float(v) for v in xs[5:]], model["x"])
    # Models are no measurements.
    assert len(read_table([path]).detections) == len(table)
