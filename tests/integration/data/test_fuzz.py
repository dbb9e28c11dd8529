"""Damaged files of every kind: each is read or refused in one line, without hang or bloat."""

from __future__ import annotations

import resource
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from curlshot.data.angles import read_angles
from curlshot.data.errors import InputError
from curlshot.data.project import unpack_clip
from curlshot.data.tracker import read_table
from curlshot.data.tracks import check_detections
from curlshot.data.trk_write import plain_view, project_xml
from curlshot.tests.helpers.data.dialects import archive, export, project, put, truth

MOST_MEMORY = 500_000_000
"""Bytes by which reading whatever files may make the process grow."""

WORDS = [
    *("t", "x", "y", "stone", "theta", "frame", "seen", "x1", "y1", "ang_1", "sd_x", "A", "team"),
    *("0", "1", "-1.5", "2,5", "1e308", "-1e308", "1E-3", "inf", "nan", "−2×10^−3", "٣", "1_0"),
    *("\t", ";", ",", " ", "::", "\n", "\r\n", '"', "(ms)", "[cm]", "1e17", "9" * 400, "#multi:"),
    *(
        "NaN",
        "-1",
        "null",
        "&a;",
        "[7]",
        "[99999999]",
        "</object>",
        "<property",
        "{",
        "}",
        "]]>",
        "",
    ),
]
RAW_WORDS = [*(word.encode() for word in WORDS), b"\xff", b"\0", b"\xff\xfe"]


@pytest.fixture(autouse=True, scope="module")
def no_bloat() -> Iterator[None]:
    """Hold all cases of this file to the memory they may take."""
    scale = 1 if sys.platform == "darwin" else 1024
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    yield
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert scale * grown < MOST_MEMORY


def read_or_refused(path: Path) -> None:
    """Read a file as tracks; what is accepted makes sense, what is not says why in a line."""
    try:
        found = read_table([path], fps=25)
    except InputError as refusal:
        assert "\n" not in str(refusal)
        return
    table = found.detections
    assert np.isfinite(table[["t", "x", "y"]].to_numpy()).all()
    assert (table.groupby("stone")["t"].diff().dropna() > 0).all()
    assert table[["x", "y"]].abs().to_numpy().max() <= 100
    assert not np.isinf(table[["theta", "sd_x", "sd_y", "sd_theta"]].to_numpy()).any()
    assert found.fps is None or 0 < found.fps < np.inf
    assert all(0 < mass < np.inf for mass in found.masses.values())


def angles_or_refused(path: Path) -> None:
    """Read a file as the angle of a stone."""
    try:
        found = read_angles(path)
    except InputError as refusal:
        assert "\n" not in str(refusal)
        return
    assert np.isfinite(found.t).all()
    assert np.isfinite(found.theta).all()
    assert (np.diff(found.t) > 0).all()


def clip_or_refused(path: Path, folder: Path) -> None:
    """Unpack the clip of a project into a folder and nowhere else."""
    folder.mkdir(exist_ok=True)
    try:
        _, files = unpack_clip(path, None, folder)
    except InputError as refusal:
        assert "\n" not in str(refusal)
        files = ()
    assert all(file.parent == folder for file in files)
    for file in folder.iterdir():
        file.unlink()


fuzzed = settings(
    deadline=None,
    max_examples=300,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@fuzzed
@given(raw=st.binary(max_size=300))
def test_any_bytes(tmp_path: Path, raw: bytes) -> None:
    path = put(tmp_path, raw)
    read_or_refused(path)
    angles_or_refused(path)


@fuzzed
@given(words=st.lists(st.sampled_from(WORDS), max_size=60), header=st.sampled_from(["", "t,x,y\n"]))
def test_any_words(tmp_path: Path, words: list[str], header: str) -> None:
    path = put(tmp_path, header + "".join(words))
    read_or_refused(path)
    angles_or_refused(path)


def damaged(raw: bytes, rng: np.random.Generator) -> bytes:
    """Write over some places of a file, or repeat, swap or lose some of its lines."""
    out = bytearray(raw)
    for _ in range(rng.choice([1, 1, 1, 2, 4])):
        at = int(rng.integers(len(out) + 1))
        if rng.uniform() < 0.8:
            until = at + int(rng.choice([0, 0, 1, 5, 40]))
            out[at:until] = RAW_WORDS[rng.integers(len(RAW_WORDS))]
        else:
            lines = out.split(b"\n")
            one, other = rng.integers(len(lines), size=2)
            lines[one], lines[other] = lines[other], lines[one] * int(rng.integers(3))
            out = bytearray(b"\n".join(lines))
    return bytes(out)


def own_files() -> dict[str, bytes]:
    """Small files of every kind, by name."""
    table, few = truth(8), truth(5)
    detections = check_detections(few.assign(theta=0.1 * few["t"], sd_x=0.002, sd_y=0.002))
    view = plain_view(detections)
    marks = view.coordinates.pixels(detections["frame"], detections[["x", "y"]].to_numpy())
    texts = {
        "tab.txt": export(table),
        "comma.csv": export(table, ",", "four digits"),
        "swedish.txt": export(table, ";", "full", ",", swedish=True),
        "blank.txt": export(table[table["stone"] == "yellow"], " ", columns=("x", "y")),
        "tidy.csv": table.to_csv(index=False),
        "angle.txt": "edge\nt\tx\ty\tθ\n0\t0.1\t0\t0\n0.1\t0.1\t0.01\t5.7\n0.2\t0.09\t0.02\t12\n",
        "bare.txt": "0 1 2 3 4\n0.1 1.1 2.1 3.1 4.1\n0.2 1.2 2.2 3.2 4.2\n",
        "project.trk": project(),
        "own.trk": project_xml(detections, view, marks, {"frictional": few}),
    }
    packed = {"a.trk": project(video='<property name="path" type="string">v/c.mp4</property>')}
    return {name: text.encode() for name, text in texts.items()} | {
        "tabs.trz": archive(packed | {"b.trk": project(), "v/c.mp4": b"clip" * 50})
    }


@pytest.mark.parametrize("name", own_files())
def test_damaged_files_of_every_kind(tmp_path: Path, name: str) -> None:
    rng = np.random.default_rng(sum(name.encode()))
    raw = own_files()[name]
    for _ in range(500):
        path = put(tmp_path, damaged(raw, rng), name)
        read_or_refused(path)
        if "angle" in name:
            angles_or_refused(path)
        if name.endswith((".trk", ".trz")):
            clip_or_refused(path, tmp_path / "clip")


def test_damaged_projects_in_sound_archives(tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    raw = project().encode()
    for _ in range(300):
        read_or_refused(put(tmp_path, archive({"a.trk": damaged(raw, rng)}), "a.trz"))


def test_damaged_files_of_users(tmp_path: Path, shared: Path) -> None:
    rng = np.random.default_rng(5)
    folders = [shared / "tracker" / "samples", shared / "tracker" / "real"]
    paths = [path for folder in folders for path in sorted(folder.iterdir())]
    texts = [path.read_bytes()[:1500] for path in paths if path.suffix in (".txt", ".csv")]
    assert len(texts) > 20
    for _ in range(900):
        read_or_refused(put(tmp_path, damaged(texts[rng.integers(len(texts))], rng)))
