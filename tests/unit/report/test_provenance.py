from __future__ import annotations

import hashlib
from pathlib import Path

from curlshot.report.provenance import MOST_FILES, libraries, sources


def files(folder: Path, count: int) -> list[Path]:
    paths = [folder / f"{k}.png" for k in range(count)]
    for k, path in enumerate(paths):
        path.write_bytes(bytes([k]) * (k + 1))
    return paths


def test_each_file_has_its_hash(tmp_path):
    first, second = sources(files(tmp_path, 2))
    assert (first.name, first.size) == ("0.png", 1)
    assert second.sha256 == hashlib.sha256(b"\x01\x01").hexdigest()


def test_many_files_have_one_hash(tmp_path):
    paths = files(tmp_path, MOST_FILES + 1)
    (one,) = sources(paths)
    assert one.name == f"{MOST_FILES + 1} files, 0.png to {MOST_FILES}.png"
    assert one.size == sum(path.stat().st_size for path in paths)
    assert one.sha256 == hashlib.sha256(b"".join(p.read_bytes() for p in paths)).hexdigest()


def test_versions_are_told():
    found = libraries()
    assert found["Python"].startswith("3.")
    assert {"numpy", "scipy", "pandas"} <= found.keys()
