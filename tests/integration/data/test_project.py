from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.tracker import read_table
from curlshot.tests.helpers.data.dialects import archive, project, put


def test_archives_do_no_harm(tmp_path: Path) -> None:
    bomb = archive({"a.trk": b"<object>" + b" " * 80_000_000})
    for raw, reason in [
        (bomb, "too large"),
        (archive({"readme.md": "no"}), "without a Tracker project"),
        (archive({"a/shot.trz": "no"}), "an archive with a/shot.trz in it; unpack it first"),
        (archive({"xl/workbook.xml": "no"}), "a spreadsheet; save it as CSV"),
        (archive({"a.trk": project()})[:-40], "damaged"),
        (archive({f"{k}.trk": "" for k in range(60)}), "too many"),
    ]:
        with pytest.raises(InputError, match=reason):
            read_table([put(tmp_path, raw, "a.trz")])
    outside = put(tmp_path, archive({"../../evil.trk": project()}), "b.trz")
    assert len(read_table([outside]).detections) == 7
    assert sorted(item.name for item in tmp_path.iterdir()) == ["a.trz", "b.trz"]


PAIRS = ("V1", "V2", "V3", "V5", "V8", "V11", "V17", "V23", "V28", "V30")


@pytest.mark.parametrize("name", PAIRS)
def test_project_and_export_of_real_users_agree(shared: Path, name: str) -> None:
    """V28's project was saved again after its export; its marks are still the same."""
    folder = shared / "tracker" / "real"
    marked = read_table([folder / f"pair_{name}.trk"]).detections
    exported = read_table([folder / f"pair_{name}_export.txt"]).detections
    assert len(marked) == len(exported) > 900
    for column in ("t", "x", "y"):
        np.testing.assert_allclose(marked[column], exported[column], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "export"),
    [
        ("project.trk", "export_two_tracks_fullprecision_semicolon.txt"),
        ("sample.trz", "export_two_tracks_fullprecision_semicolon.txt"),
        ("moving_project.trk", "moving_export_after_reopening.txt"),
    ],
)
def test_sample_projects_agree_with_their_exports(shared: Path, name: str, export: str) -> None:
    folder = shared / "tracker" / "samples"
    marked = read_table([folder / name]).detections
    printed = read_table([folder / export]).detections
    columns = ["stone", "frame", "t", "x", "y"]
    pd.testing.assert_frame_equal(marked[columns], printed[columns], rtol=0, atol=5.1e-7)


def test_project_with_a_reference_frame_agrees_with_its_export(shared: Path) -> None:
    folder = shared / "tracker" / "samples"
    marked = read_table([folder / "full_project.trk"]).detections
    printed = read_table([folder / "full_export_default_frame.txt"]).detections
    stones = [rows.reset_index() for _, rows in printed.groupby("stone")]
    red, yellow = stones
    np.testing.assert_allclose(marked["t"], yellow["t"], rtol=0, atol=1e-9)
    for axis in "xy":
        np.testing.assert_allclose(marked[axis], yellow[axis] - red[axis], rtol=0, atol=1.1e-6)


def test_projects_of_real_users_are_read(shared: Path) -> None:
    for path in sorted((shared / "tracker" / "real").glob("*.trz")):
        assert len(read_table([path]).detections) >= 10, path.name
    with pytest.raises(InputError, match="not calibrated"):
        read_table([shared / "tracker" / "real" / "26a2_protractor.trk"])
