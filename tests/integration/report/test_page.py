from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pytest

from curlshot.data.results import Estimate, Friction
from curlshot.data.results_file import results_json
from curlshot.data.sheet import HOUSE
from curlshot.report.numbers import MINUS
from curlshot.report.page import write_report
from curlshot.report.provenance import Provenance, Source
from curlshot.tests.helpers.report.page import Page
from curlshot.vision.optics.camera import Camera, camera_table


def numbers_in(value: object) -> list[float]:
    if isinstance(value, dict):
        return [n for item in value.values() for n in numbers_in(item)]
    if isinstance(value, list):
        return [n for item in value for n in numbers_in(item)]
    return [float(value)] if isinstance(value, (int, float)) else []


def write(folder: Path, shot, **kwargs) -> Path:
    options = {
        "results": shot.results,
        "tracks": shot.tracks,
        "simulations": shot.simulations,
        "house": HOUSE,
        "ensemble": shot.ensemble,
        "provenance": Provenance(
            "1.2.3", "curlshot run 'take 7.mp4'", (Source("a<b", 7, "0" * 64),)
        ),
    }
    return write_report(folder, **(options | kwargs))


@pytest.fixture(scope="module")
def written(tmp_path_factory, shot) -> Path:
    folder = tmp_path_factory.mktemp("report")
    (folder / "overlay.mp4").write_bytes(b"not really a film")
    cameras = [
        Camera(k, k / 25, np.eye(3), (1280, 720), rms_px=0.25 + 0.001 * k, found=k != 3)
        for k in range(5)
    ]
    return write(folder, shot, cameras=camera_table(cameras), overlay=folder / "overlay.mp4")


def test_page_is_well_formed_and_offline(written):
    page = Page(written)
    assert page.text.startswith("<!DOCTYPE html>")
    assert page.tags[0] == ("html", {"lang": "en-GB"})
    assert all((a["src"] or "").startswith("data:") for a in page.all("img"))
    assert [a["src"] for tag in ("video", "script") for a in page.all(tag) if "src" in a] == [
        "overlay.mp4"
    ]
    assert not page.all("link")
    assert not re.search(r"(src|href)=\"https?:|@import|url\(http", page.text)
    ids = [attrs["id"] for _, attrs in page.tags if "id" in attrs]
    assert len(ids) == len(set(ids))
    assert all(attrs.get("alt") for attrs in page.all("img"))
    assert written.stat().st_size < 3_000_000


def test_numbers_are_those_of_the_results(written, shot):
    page = Page(written)
    values = {value for value, _ in page.numbers}
    raw = json.loads(results_json(shot.results))
    for key in ("schema", "joint_estimate", "model_selection", "methods", "stones", "posterior"):
        raw.pop(key)  # the page draws them, or gives what follows from them
    missing = [number for number in numbers_in(raw) if number not in values]
    assert missing == []


def test_what_is_read_is_what_is_meant(written):
    factors = (1, 100, 1000)  # as it is, per cent, millimetres
    for value, text in Page(written).numbers:
        shown = float(text.replace(MINUS, "-"))
        digits = len(text.split(".")[1]) if "." in text else 0
        half = 0.5000001 * 10.0**-digits
        assert any(abs(value * factor - shown) <= half for factor in factors), (value, text)


def test_the_answer_comes_first(written, tmp_path, shot):
    said = Page(written).said
    assert "0.831 ± 0.012" in said
    assert "0.01093 ± 0.00041" in said
    first = said.index("The shot")
    for words in ("A on B at", "1.2 cm rms", "no spins after the hit", "4 of 5 frames", "0.25 px"):
        assert said.index(words) < first
    assert "1.2.3" in said
    said = " ".join(said.split())
    assert "frictional, simulated with the laws and the start of the shot fit" in said
    results = dataclasses.replace(
        shot.results, collisions=shot.results.collisions[:1], glides=shot.results.glides[:1]
    )
    short = Page(write(tmp_path, shot, results=results)).said.split()
    assert "over 1 of 1 hit Friction" in " ".join(short)
    assert "over 1 glide Hits" in " ".join(short)


def test_speeds_are_shown_where_something_moves(written):
    (speeds,) = (div for div in Page(written).all("div") if div.get("class") == "panel speeds")
    assert "hidden" not in speeds


def test_names_of_files_are_no_markup(written):
    page = Page(written)
    assert 'take 7 <best> & "last".mp4' in page.said
    assert "<used as far as it goes>" in page.said
    assert "<best>" not in page.text


def test_the_clip_is_played_from_beside_the_page(written, tmp_path, shot):
    (video,) = Page(written).all("video")
    assert video["src"] == "overlay.mp4"
    still = shot.tracks[shot.tracks["frame"] == 0]
    results = dataclasses.replace(shot.results, collisions=())
    options = {"results": results, "tracks": still, "simulations": {}}
    page = Page(write(tmp_path / "out", shot, overlay=tmp_path / "my clip.mp4", **options))
    assert page.all("video")[0]["src"] == "../my%20clip.mp4"
    assert not Page(write(tmp_path, shot, **options)).all("video")


def test_it_says_how_to_make_it_again(written):
    said = Page(written).said
    for words in ("curlshot run 'take 7.mp4'", "a<b, 7 bytes", "sha256 000", "numpy"):
        assert words in said


def test_figures_lie_beside_the_page(written):
    names = {p.name for p in (written.parent / "figures").iterdir()}
    stems = ["plan", "speed", "friction", "posterior", "hit_1", "hit_2"]
    stems += [f"{kind}_{stone}" for kind in ("motion", "spin", "simulated") for stone in "ABC"]
    assert names == {f"{stem}.{suffix}" for stem in stems for suffix in ("svg", "png")}


def test_what_is_not_known_is_said_with_its_reason(tmp_path, shot):
    results = dataclasses.replace(
        shot.results,
        restitution=Estimate(),
        friction=Friction(),
        collisions=(),
        glides=(),
        simulations={},
        joint_estimate=None,
        warnings=("no hit was seen: no restitution", "no glide is long enough: no friction"),
    )
    (tmp_path / "figures").mkdir()
    for name in ("hit_7.svg", "mine.svg"):
        (tmp_path / "figures" / name).write_text("old")
    still = shot.tracks[shot.tracks["frame"] == 0]
    page = Page(write(tmp_path, shot, results=results, tracks=still, simulations={}, house=None))
    (speeds,) = (div for div in page.all("div") if div.get("class") == "panel speeds")
    assert "hidden" in speeds  # an empty chart says nothing
    assert page.said.count("no hit was seen: no restitution") == 2
    assert page.said.count("no glide is long enough: no friction") == 2
    assert "—" in page.said
    assert "nan" not in page.said.lower().replace("resonance", "")
    assert "None" not in page.said
    names = {p.name for p in (tmp_path / "figures").iterdir()}
    assert names == {"plan.svg", "plan.png", "mine.svg"}


def test_strange_stone_names_make_files_and_pages(tmp_path, shot):
    new = {"A": "../a/b", "B": "a/b", "C": "<i>$c</i>", "D": "D"}
    tracks = shot.tracks.replace({"stone": new})
    results = dataclasses.replace(shot.results, collisions=(), simulations={})
    page = Page(write(tmp_path, shot, results=results, tracks=tracks, simulations={}))
    assert "<i>" not in page.text
    assert "<i>$c</i>" in page.said
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "figures",
        "report.html",
        "tables",
    ]
    assert len(list((tmp_path / "figures").glob("motion_*.svg"))) == 3
