"""The public API: what it lists, its examples, and what it costs to import."""

from __future__ import annotations

import doctest
import subprocess
import sys
import time
import types
from importlib import import_module
from pathlib import Path

import matplotlib as mpl
import pytest

import curlshot

ROOT = Path(__file__).resolve().parents[2]
PUBLIC = [name for name in curlshot.__all__ if name != "__version__"]
MOST_NAMES = 40
LONGEST = 2.0
"""Processor time of one example, s."""


def examples() -> dict[str, list[doctest.DocTest]]:
    """All docstrings with examples, by module, of modules that anybody has written some in."""
    finder, found = doctest.DocTestFinder(exclude_empty=True), {}
    for path in sorted(ROOT.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        if parts[0] in ("tests", "benchmarks", "examples", "docs", "build"):
            continue
        if ">>> " in path.read_text(encoding="utf-8"):
            name = ".".join(("curlshot", *parts)).removesuffix(".__init__")
            tests = finder.find(import_module(name))
            found[name] = [test for test in tests if test.examples]
    return found


def test_the_public_names_are_few_and_sorted() -> None:
    assert dir(curlshot) == sorted(curlshot.__all__) == sorted(set(curlshot.__all__))
    assert len(dir(curlshot)) <= MOST_NAMES
    assert set(PUBLIC) == set(curlshot._MODULE_OF)
    assert not any(isinstance(getattr(curlshot, name), types.ModuleType) for name in PUBLIC)
    with pytest.raises(AttributeError, match="has no attribute 'pipelines'"):
        _ = curlshot.pipelines


def test_rooms_that_were_imported_are_not_listed() -> None:
    import_module("curlshot.season.together")
    import_module("curlshot.physics.simulator.simulate")
    assert not {"season", "physics", "data", "pipeline"} & set(dir(curlshot))


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_name_has_an_example(name: str) -> None:
    assert ">>> " in (getattr(curlshot, name).__doc__ or "")


def test_the_import_loads_no_library() -> None:
    code = (
        "import sys, curlshot; print(*(m for m in ('numpy', 'pandas', 'cv2') if m in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT.parent
    )
    assert done.stdout.strip() == ""


def test_examples_run_and_are_quick(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mpl.use("agg")
    monkeypatch.chdir(tmp_path)
    said, slow, run = [], {}, set()
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for tests in examples().values():
        for test in tests:
            began = time.process_time()
            failed = runner.run(test, out=said.append).failed
            took = time.process_time() - began
            run.add(test.name)
            if took > LONGEST and not failed:
                slow[test.name] = took
    assert runner.failures == 0, "".join(said)
    assert not slow
    assert len(run) >= len(PUBLIC)
