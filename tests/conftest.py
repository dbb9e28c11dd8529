from __future__ import annotations

import fcntl
import os
import pickle
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from curlshot.cli.threads import use_one_thread

if TYPE_CHECKING:
    from curlshot.outcome import Run
    from curlshot.tests.helpers.report.browser import Browser
    from curlshot.tests.helpers.report.shot import Shot

# The suite has a process for each core: more threads only wait for each other. NumPy reads the
# limits when it is loaded, so nothing above may load it.
use_one_thread()

ROOT = Path(__file__).resolve().parents[1]
KINDS = ("unit", "integration", "golden", "property")
"""Folders of tests; each marks what lies in it. What lies in none is of the kind integration."""
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
            from curlshot import pipeline

            run = pipeline.run(out=shared / "sample" / "out")
            kept.write_bytes(pickle.dumps(run))
        return pickle.loads(kept.read_bytes())


@pytest.fixture(scope="session")
def shot() -> Shot:
    """Tracks and results of a shot in closed form."""
    from curlshot.tests.helpers.report.shot import make_shot

    return make_shot()


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A Chromium without a window."""
    from curlshot.tests.helpers.report.browser import Browser

    with Browser(tmp_path_factory.mktemp("profile")) as browser:
        yield browser


@pytest.fixture(scope="session", autouse=True)
def all_modules_are_in_the_package() -> Iterator[None]:
    """Fail at the end where a module of the project was loaded under another name as well."""
    yield
    outside = modules_outside()
    assert not outside, f"loaded outside of curlshot: {outside}"


def modules_outside() -> dict[str, str]:
    """Return modules whose file is the project's and whose name is not, by their names."""
    files = {name: getattr(module, "__file__", None) for name, module in [*sys.modules.items()]}
    return {
        name: file
        for name, file in files.items()
        if file is not None
        and not name.startswith("curlshot.")
        and name != "curlshot"
        and Path(file).resolve().is_relative_to(ROOT)
        and Path(file).name != "conftest.py"
        and "site-packages" not in Path(file).parts
    }


def kind_of(path: Path) -> str:
    """Return the kind of the tests in a file, by its folder."""
    first = path.relative_to(ROOT / "tests").parts[0]
    return first if first in KINDS else "integration"


def pytest_itemcollected(item: pytest.Item) -> None:
    item.add_marker(kind_of(item.path))


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave the files of other kinds unread where one kind alone is asked for."""
    asked = config.option.markexpr
    if asked in KINDS and collection_path.suffix == ".py" and kind_of(collection_path) != asked:
        return True
    return None


class PackageModule(pytest.Module):
    """A test module under its name in the package, so that no second copy of it is loaded."""

    def _getobj(self) -> object:
        parts = self.path.relative_to(ROOT).with_suffix("").parts
        return import_module(".".join(("curlshot", *parts)))


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> PackageModule:
    return PackageModule.from_parent(parent, path=module_path)


class PlainFolders:
    """All folders hold tests and are no packages: pytest would load the root's under its own name.

    A plugin of its own, since hooks of a conftest serve the folders below it only.
    """

    def pytest_collect_directory(self, path: Path, parent: pytest.Collector) -> pytest.Dir:
        return pytest.Dir.from_parent(parent, path=path)


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(PlainFolders())
