from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.tracker import read_table
from curlshot.tests.helpers.data.dialects import archive, numbers, project, put


def test_masses_count_only_if_all_were_set(tmp_path: Path) -> None:
    both = read_table([put(tmp_path, project(mass={"red": 19.0, "blue": 20.0}))])
    assert both.masses == {"red": 19.0, "blue": 20.0}
    one = read_table([put(tmp_path, project(mass={"red": 19.0}))])
    assert one.masses == {}
    assert any("mass of blue is Tracker's default" in text for text in one.warnings)


def test_a_project_in_latin_1_that_calls_itself_utf_8_is_read(tmp_path: Path) -> None:
    text = project({"Jalón": {0: (1.0, 2.0)}})
    found = read_table([put(tmp_path, text.encode("latin-1"))]).detections
    assert list(found["stone"]) == ["Jalón"]


def test_first_tab_with_marks_is_used_unless_another_is_named(tmp_path: Path) -> None:
    other = project({"green": {0: (5.0, 5.0)}})
    content = {"a.trk": project({}), "b.trk": project(), "x/c.trk": other, "x/._c.trk": b"\0"}
    path = put(tmp_path, archive(content), "tabs.trz")
    found = read_table([path])
    assert set(found.detections["stone"]) == {"red", "blue"}
    assert any("a, b, c" in text and ": b (--tab)" in text for text in found.warnings)
    assert set(read_table([path], tab="c").detections["stone"]) == {"green"}
    with pytest.raises(InputError, match="no tab d; there is a, b, c"):
        read_table([path], tab="d")
    table = put(tmp_path, "stone,t,x,y\nA,0,0,0\nA,1,0,1\n", "shot.csv")
    with pytest.raises(InputError, match="no Tracker project"):
        read_table([table], tab="a")


def test_a_set_of_tabs_leads_to_its_projects(tmp_path: Path) -> None:
    put(tmp_path, project(), "one.trk")
    entry = (
        '<property name="[0]" type="array" class="s"><property name="[0]" type="string">/no/one.trk'
        '</property><property name="[1]" type="string">one.trk</property></property>'
    )
    text = (
        f'<object class="T.TFrame"><property name="tabs" type="array">{entry}</property></object>'
    )
    assert len(read_table([put(tmp_path, text, "tabs.trk")]).detections) == 7


LAUGHS = (
    '<?xml version="1.0"?><!DOCTYPE o [<!ENTITY a "ha"><!ENTITY b "'
    + "&a;" * 1000
    + '">]><object class="x.TrackerPanel">&b;</object>'
)
OUTSIDE = '<!DOCTYPE o [<!ENTITY a SYSTEM "file:///etc/passwd">]><object>&a;</object>'
NONSENSE = {
    "<": "damaged",
    project()[:700]: "damaged",
    project().replace("200.0", "NaN", 1): "no number",
    project().replace("200.0", "1_0", 1): "no number",
    project().replace("50.0", "0.0"): "scale",
    project().replace("[3]", "[99999999999]"): "too large",
    project(keys={}): "no coordinate system",
    project(keys={0: (0.0, 0.0, 0.0, 1.0, 1.0)}): "not calibrated",
    project({}): "no point mass with marks",
    project(duration=0): "no duration",
    project(clip=numbers(stepsize=0)): "makes no sense",
    project({"a": {0: (1.0, 1.0)}, " a ": {0: (2.0, 2.0)}}): "two tracks with one name, a",
    '<object class="x.Other"/>': "Other instead",
    "<html><body/></html>": "element “html”",
    "<object>" * 100: "nested too deeply",
    LAUGHS: "entities",
    OUTSIDE: "entities",
}


@pytest.mark.parametrize("text", NONSENSE, ids=range(len(NONSENSE)))
def test_nonsense_is_refused_in_one_line(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError, match=NONSENSE[text]) as refusal:
        read_table([put(tmp_path, text)])
    assert "\n" not in str(refusal.value)
    assert str(tmp_path) in str(refusal.value)


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


# Files that Tracker and its users wrote.


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
