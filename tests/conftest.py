from __future__ import annotations

import fcntl
import os
import pickle
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

from curlshot import pipeline
from curlshot.cli.threads import use_one_thread
from curlshot.outcome import Run
from curlshot.tests.helpers.report.browser import Browser
from curlshot.tests.helpers.report.shot import Shot, make_shot

use_one_thread()  # the suite has a process for each core: more threads only wait for each other

ROOT = Path(__file__).resolve().parents[1]
SHARED = ROOT.parent / "shared"


@pytest.fixture(scope="session")
def shared() -> Path:
    """Third-party footage and tracks beside the repository, where they are at hand."""
    if not SHARED.is_dir():
        pytest.skip("the folder ../shared with real footage and tracks is not here")
    return SHARED


@pytest.fixture(scope="session")
def sample(tmp_path_factory: pytest.TempPathFactory) -> Run:
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


@pytest.fixture(scope="session")
def shot() -> Shot:
    """Tracks and results of a shot in closed form."""
    return make_shot()


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A Chromium without a window."""
    with Browser(tmp_path_factory.mktemp("profile")) as browser:
        yield browser


class PackageModule(pytest.Module):
    """A test module under its name in the package, so that no second copy of it is loaded."""

    def _getobj(self) -> object:
        parts = self.path.relative_to(ROOT).with_suffix("").parts
        return import_module(".".join(("curlshot", *parts)))


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> PackageModule:
    return PackageModule.from_parent(parent, path=module_path)
