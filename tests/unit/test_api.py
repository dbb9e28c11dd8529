"""The public API: what it lists, and what it costs to import."""

from __future__ import annotations

import subprocess
import sys
import types
from importlib import import_module
from pathlib import Path

import pytest

import curlshot

ROOT = Path(__file__).resolve().parents[2]
PUBLIC = [name for name in curlshot.__all__ if name != "__version__"]
MOST_NAMES = 40


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
