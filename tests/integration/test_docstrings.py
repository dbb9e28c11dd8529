"""The examples in docstrings run and print what they show."""

from __future__ import annotations

import doctest
import time
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages

import matplotlib as mpl
import pytest

import curlshot

LONGEST = 2.0
"""Processor time of the example of one name, s."""

OTHERS = ("curlshot.tests", "curlshot.benchmarks", "curlshot.examples", "curlshot.docs")


def modules() -> list[str]:
    """Return the names of all modules of the package that can be imported without running it."""
    names = ["curlshot", *(found.name for found in walk_packages(curlshot.__path__, "curlshot."))]
    return [name for name in names if not name.startswith(OTHERS) and "__main__" not in name]


def test_all_rooms_are_looked_through() -> None:
    rooms = {path.parent.name for path in Path(curlshot.__path__[0]).glob("*/__init__.py")}
    assert rooms >= {"cli", "data", "physics", "report", "season", "synthetic", "vision"}
    assert {f"curlshot.{room}" for room in rooms} <= {*modules()}


@pytest.mark.parametrize("name", modules())
def test_examples_hold_and_are_quick(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mpl.use("agg")
    monkeypatch.chdir(tmp_path)
    said: list[str] = []
    runner = doctest.DocTestRunner()
    for test in doctest.DocTestFinder().find(import_module(name)):
        began = time.process_time()
        runner.run(test, out=said.append)
        assert not said, "".join(said)
        assert time.process_time() - began < LONGEST, test.name
