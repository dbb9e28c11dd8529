from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.tracker import read_table
from curlshot.data.tracks import DETECTION_COLUMNS
from curlshot.tests.helpers.data.dialects import export, truth
from curlshot.tests.helpers.data.tracker import assert_same, read


@pytest.mark.parametrize("pattern", ["full", "four digits"])
@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("delimiter", ["\t", ";", ",", " ", "|", "::"])
def test_every_delimiter_and_decimal_sign(
    tmp_path: Path, delimiter: str, decimal: str, pattern: str
) -> None:
    text = export(truth(), delimiter, pattern, decimal)
    found = read(tmp_path, text)
    assert_same(found.detections, truth(), 5.1e-7 if pattern == "full" else 5.1e-4)
    assert tuple(found.detections.columns) == DETECTION_COLUMNS
    assert found.detections["theta"].isna().all()
    assert bool(found.warnings) == (delimiter == decimal == ",")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_swedish_numbers_line_ends_and_encodings(
    tmp_path: Path, line_end: str, encoding: str
) -> None:
    text = export(truth(), ";", "full", ",", swedish=True).replace("\n", line_end)
    assert_same(read(tmp_path, text.encode(encoding)).detections, truth(), 5.1e-7)


def _texts(folder: Path) -> list[Path]:
    return sorted([*folder.glob("*.txt"), *folder.glob("*.csv")])


def test_every_export_at_hand_is_read_or_refused(shared: Path) -> None:
    refused = {}
    for path in _texts(shared / "tracker" / "samples") + _texts(shared / "tracker" / "real"):
        try:
            assert len(read_table([path]).detections) > 0
        except InputError as refusal:
            assert "\n" not in str(refusal)
            refused[path.name] = str(refusal)
    angles = {name for name in refused if "angles" in name}
    assert all("only angles about the origin" in refused[name] for name in angles)
    # Marked in centimetres and in millimetres or pixels: the unit is not in the file.
    others = set(refused) - angles
    assert others == {"finnss_11.txt", "jake-bobowski_PHYS121_tracker.csv"}
    assert all("length unit" in refused[name] for name in others)


@pytest.mark.parametrize(
    ("family", "best"),
    [
        ("", "export_two_tracks_fullprecision_semicolon.txt"),
        ("moving_", "moving_export_after_reopening.txt"),
        ("svSE_", "svSE_export_two_tracks_fullprecision_semicolon.txt"),
        ("windows_crlf_", "export_two_tracks_fullprecision_semicolon.txt"),
    ],
)
def test_all_dialects_of_one_shot_agree(shared: Path, family: str, best: str) -> None:
    folder = shared / "tracker" / "samples"
    truth_rows = read_table([folder / best]).detections.set_index(["stone", "frame"])
    if family == "moving_":
        paths = [p for p in _texts(folder) if p.name.startswith(family)]
    else:
        paths = _texts(folder)
        paths = [p for p in paths if p.name.startswith((f"{family}export", f"{family}tablecopy"))]
    compared = 0
    for path in paths:
        if "angles" in path.name:
            continue
        rows = read_table([path]).detections
        formatted = "fullprecision" not in path.name and "reopening" not in path.name
        # A table copy knows no frames: match by time.
        rows = rows.assign(frame=np.round(rows["t"] * 30).astype(int))
        rows = rows.set_index(["stone", "frame"])
        wanted = truth_rows.loc[rows.index]
        atol = 5.1e-4 if formatted else 5.1e-7
        np.testing.assert_allclose(rows[["x", "y"]], wanted[["x", "y"]], rtol=0, atol=atol)
        np.testing.assert_allclose(rows["t"], wanted["t"], rtol=0, atol=5e-4)
        compared += 1
    assert compared >= 1


def test_rows_between_the_steps_of_a_clip_are_no_places(shared: Path) -> None:
    folder = shared / "tracker" / "samples"
    step2 = sorted(p for p in _texts(folder) if p.name.startswith("step2_"))
    best = folder / "step2_export_one_track_all_columns_fullprecision_tab.txt"
    wanted = read_table([best]).detections.set_index("t")
    assert (np.diff(wanted["frame"]) == 2).all()
    compared = 0
    for path in step2:
        if "angles" in path.name:
            continue
        rows = read_table([path]).detections
        rows = rows[rows["stone"].str.startswith("red")]
        if rows.empty:
            continue
        rounding = 5.1e-7 if "fullprecision" in path.name else 5.1e-4
        at = wanted.index.to_numpy()
        same = np.abs(rows["t"].to_numpy()[:, None] - at).argmin(axis=1)
        np.testing.assert_allclose(rows["t"], at[same], rtol=0, atol=5.1e-4)
        assert len(rows) == len(wanted)
        here = wanted.iloc[same][["x", "y"]]
        np.testing.assert_allclose(rows[["x", "y"]], here, rtol=0, atol=rounding)
        compared += 1
    assert compared >= 4


def test_two_pucks_without_header(shared: Path) -> None:
    path = shared / "tracks" / "airtable_two_pucks.csv"
    raw = np.loadtxt(path, delimiter=";")
    found = read_table([path], length_unit="cm")
    for k, name in enumerate("AB"):
        rows = found.detections[found.detections["stone"] == name]
        np.testing.assert_allclose(rows["t"], raw[:, 0], atol=1e-9)
        np.testing.assert_allclose(rows[["x", "y"]], raw[:, 1 + 2 * k : 3 + 2 * k] / 100)
    assert found.fps == pytest.approx(100)
    with pytest.raises(InputError, match="length unit"):
        read_table([path])


def test_discs_of_motion_capture(shared: Path) -> None:
    paths = sorted((shared / "tracks" / "discs_500hz").glob("*.csv"))
    assert paths
    for path in paths:
        found = read_table([path], fps=500)
        raw = pd.read_csv(path)
        for name, rows in found.detections.groupby("stone"):
            assert len(rows) == len(raw)
            np.testing.assert_allclose(rows["x"], raw[f"c_{name}_x"])
            turns = (rows["theta"].to_numpy() - raw[f"ang_{name}"]) / (2 * np.pi)
            np.testing.assert_allclose(turns, np.round(turns), atol=1e-9)
            assert np.abs(np.diff(rows["theta"])).max() < 0.1
        assert found.warnings == ()
        with pytest.raises(InputError, match="no time column"):
            read_table([path])
