from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

import pytest

from curlshot.data import archive
from curlshot.data.archive import unpack
from curlshot.data.errors import InputError
from curlshot.data.project import unpack_clip
from curlshot.tests.helpers.data import dialects
from curlshot.tests.helpers.data.dialects import project

CLIP = '<property name="path" type="string">v/c.mp4</property>'


def zipped(entries: Mapping[str, bytes]) -> zipfile.ZipFile:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in entries.items():
            file.writestr(name, content)
    return zipfile.ZipFile(buffer)


def files_of(
    folder: Path, entries: Mapping[str, bytes], *names: str, start: str = ""
) -> list[Path]:
    folder.mkdir(exist_ok=True)
    return list(unpack(zipped(entries), Path("a.trz"), PurePosixPath(start), names, folder))


@pytest.mark.parametrize(
    ("start", "entry", "name"),
    [
        ("", "videos/c.mp4", "videos/c.mp4"),
        ("top", "top/videos/c.mp4", "videos/c.mp4"),
        ("trk", "videos/c.mp4", "../videos/c.mp4"),
        ("", "videos/c.mp4", "videos\\c.mp4"),
        ("", "videos/c.mp4", "/home/someone/c.mp4"),
        ("", "videos/Curling é.mp4", "videos/Curling é.mp4"),
    ],
)
def test_a_clip_is_found_from_the_project(
    tmp_path: Path, start: str, entry: str, name: str
) -> None:
    (file,) = files_of(tmp_path / "to", {entry: b"clip", "other.mp4": b""}, name, start=start)
    assert file.read_bytes() == b"clip"
    assert file.name.endswith(PurePosixPath(entry).name)


def test_pictures_keep_their_order_and_apart(tmp_path: Path) -> None:
    entries = {"a/2.png": b"first", "b/2.png": b"second", "1.png": b"third"}
    files = files_of(tmp_path / "to", entries, *entries)
    assert [file.read_bytes() for file in sorted(files)] == list(entries.values())


@pytest.mark.parametrize(
    "name",
    ["../../evil.mp4", "/etc/evil.mp4", "..", "a/..", ".mp4", "con\0.mp4", "x" * 400 + ".mp4"],
)
def test_no_name_leads_out_of_the_folder(tmp_path: Path, name: str) -> None:
    entry = zipfile.ZipInfo(name)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as file:
        file.writestr(entry, b"evil")
    (tmp_path / "in" / "to").mkdir(parents=True)
    try:
        found = unpack(
            zipfile.ZipFile(buffer), Path("a.trz"), PurePosixPath(), [name], tmp_path / "in" / "to"
        )
    except InputError:
        found = ()
    there = [item for item in tmp_path.rglob("*") if item.is_file()]
    assert there == list(found)
    assert all(item.parent == tmp_path / "in" / "to" for item in there)


def test_what_is_not_there_or_not_clear_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a\.trz: its clip c\.mp4 is not in it"):
        files_of(tmp_path, {"other.mp4": b""}, "videos/c.mp4")
    with pytest.raises(InputError, match="is in it 2 times"):
        files_of(tmp_path, {"a/c.mp4": b"", "b/c.mp4": b""}, "c.mp4")


def test_bombs_are_refused_before_they_go_off(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="would unpack to 30 MB, which is too large for a clip"):
        files_of(tmp_path, {"c.mp4": bytes(30_000_000)}, "c.mp4")
    assert list(tmp_path.iterdir()) == []


def test_an_archive_that_lies_about_sizes_is_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = zipped({"c.mp4": bytes(5_000_000)})
    file.infolist()[0].file_size = 100
    # What follows the promised size is never read.
    try:
        (unpacked,) = unpack(file, Path("a.trz"), PurePosixPath(), ["c.mp4"], tmp_path)
        assert unpacked.stat().st_size <= 100
    except (InputError, zipfile.BadZipFile):
        pass
    monkeypatch.setattr(archive, "LARGEST_CLIP", 10)
    with pytest.raises(InputError, match="which is too large for a clip"):
        files_of(tmp_path, {"c.mp4": b"more than ten bytes"}, "c.mp4")


def test_an_entry_that_starts_nowhere_is_refused(tmp_path: Path) -> None:
    raw = bytearray(dialects.archive({"a.trk": project(video=CLIP), "v/c.mp4": b"clip"}))
    at = raw.index(b"PK\x01\x02", raw.index(b"PK\x01\x02") + 1)  # the clip in the directory
    raw[at + 42 : at + 46] = b"\xff\xff\xff\x7f"  # where it starts
    path = dialects.put(tmp_path, bytes(raw), "a.trz")
    (tmp_path / "to").mkdir()
    with pytest.raises(InputError, match=r"a\.trz"):
        unpack_clip(path, None, tmp_path / "to")
