from __future__ import annotations

import fcntl
import os
import pickle
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
    """One run of the bundled sample with all its files, which no test may change.

    Processes of pytest-xdist share it: the first that asks for it makes it, others wait and read.
    """
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    with (shared / "sample.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        kept = shared / "sample.pickle"
        if not kept.exists():
            run = pipeline.run(out=shared / "sample" / "out")
            kept.write_bytes(pickle.dumps(run))
        return pickle.loads(kept.read_bytes())
