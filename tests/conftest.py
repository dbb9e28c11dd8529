from __future__ import annotations

from pathlib import Path

import pytest

import pipeline
from command.threads import use_one_thread

use_one_thread()  # the suite has a process for each core: more threads only wait for each other

SHARED = Path(__file__).resolve().parents[2] / "shared"


@pytest.fixture(scope="session")
def shared() -> Path:
    """Third-party footage and tracks beside the repository, where they are at hand."""
    if not SHARED.is_dir():
        pytest.skip("the folder ../shared with real footage and tracks is not here")
    return SHARED


@pytest.fixture(scope="session")
def sample(tmp_path_factory: pytest.TempPathFactory) -> pipeline.Run:
    """One run of the bundled sample with all its files."""
    return pipeline.run(out=tmp_path_factory.mktemp("sample") / "out")
