from __future__ import annotations

from pathlib import Path

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
    assert any("a, b, c" in text and ": b (`tab`)" in text for text in found.warnings)
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
