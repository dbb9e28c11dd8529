from __future__ import annotations

import copy
import json
import sys
from pathlib import Path
from typing import Any

import pytest

from curlshot.tests.golden import compare, stored

TABLE = "stone,frame,x,note\nA,0,1.0,seen\nA,1,,\n"
RESULTS = {"schema": 1, "restitution": {"value": 0.8, "stderr": 0.01}, "warnings": ["dark"]}


def written(folder: Path, table: str = TABLE, **results: object) -> Path:
    case = folder / "case"
    case.mkdir(parents=True)
    (case / "tracks.csv").write_text(table, encoding="utf-8")
    (case / "results.json").write_text(json.dumps({**RESULTS, **results}), encoding="utf-8")
    return folder


def status(monkeypatch: pytest.MonkeyPatch, *words: str | Path) -> int:
    monkeypatch.setattr(sys, "argv", ["compare.py", *map(str, words)])
    return compare.main()


@pytest.mark.parametrize(
    ("table", "results", "same", "same_but_words"),
    [
        (TABLE, {}, True, True),
        (TABLE.replace("1.0", "1.0000009"), {"schema": 2}, True, True),
        (TABLE.replace("1.0", "1.000002"), {}, False, False),
        (TABLE.replace("A,1,,", "A,1,0,"), {}, False, False),
        (TABLE.replace("seen", "unseen"), {"warnings": ["dark", "blurred"]}, False, True),
        (TABLE + "A,2,3.0,\n", {}, False, False),
        (TABLE.replace("A,0", "B,0"), {}, False, False),
        (TABLE, {"restitution": {"value": 0.800001, "stderr": 0.01}}, False, False),
        (TABLE, {"restitution": {"value": None, "stderr": 0.01}}, False, False),
        (TABLE, {"more": 1}, False, False),
    ],
)
def test_what_differs_fails(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    table: str,
    results: dict[str, object],
    same: bool,
    same_but_words: bool,
) -> None:
    before, after = written(tmp_path / "a"), written(tmp_path / "b", table, **results)
    assert status(monkeypatch, before, after) == (0 if same else 1)
    assert status(monkeypatch, before, after, "--words") == (0 if same_but_words else 1)


def test_columns_and_keys_have_new_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = TABLE.replace(",x,", ",meas_x,")
    after = written(tmp_path / "b", table, restitution={"value": 0.8, "error": 0.01})
    before = written(tmp_path / "a")
    assert status(monkeypatch, before, after) == 1
    names = {"tracks.csv": {"x": "meas_x"}, "results.json": {"stderr": "error"}}
    monkeypatch.setattr(compare, "RENAMED", names)
    assert status(monkeypatch, before, after) == 0


def test_a_file_that_is_missing_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before, after = written(tmp_path / "a"), written(tmp_path / "b")
    (after / "case" / "tracks.csv").unlink()
    assert status(monkeypatch, before, after, "--words") == 1


def _shift(table: str, column: str, by: float) -> Any:
    def change(run: dict[str, Any]) -> None:
        run[table][column][4] += by

    return change


def _restitution(run: dict[str, Any]) -> None:
    run["results"]["restitution"]["value"] += 0.3 * run["results"]["restitution"]["stderr"]


def _last_hit(run: dict[str, Any]) -> None:
    run["results"]["collisions"].pop()


@pytest.mark.parametrize(
    ("change", "of"),
    [
        (_shift("tracks", "x", 0.002), "tracks: x in 1 of"),
        (_shift("tracks", "vy", 0.006), "tracks: vy in 1 of"),
        (_shift("tracks", "theta", 3.14), "tracks: theta in 1 of"),
        (_shift("camera", "h13", 0.4), "camera: ice points up to"),
        (_shift("camera", "k1", 0.004), "camera: ice points up to"),
        (_restitution, "restitution.value"),
        (_last_hit, "collisions.1.t"),
    ],
)
def test_a_stored_run_that_differs_is_noticed(change: Any, of: str) -> None:
    kept = stored.read("sample")
    changed = copy.deepcopy(kept)
    change(changed)
    assert not stored.differences("sample", kept, kept)
    assert any(line.startswith(of) for line in stored.differences("sample", kept, changed))


@pytest.mark.parametrize("column", ["x", "theta"])
def test_less_than_the_tolerance_passes(column: str) -> None:
    kept = stored.read("sample")
    changed = copy.deepcopy(kept)
    _shift("tracks", column, 0.0009)(changed)
    assert not stored.differences("sample", kept, changed)
