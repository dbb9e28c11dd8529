"""The wheel, installed where nobody knows the checkout, beside files that have our rooms' names."""

from __future__ import annotations

import os
import shutil
import site
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a wheel built from a copy of the tracked files, without what an earlier build left."""
    folder = tmp_path_factory.mktemp("wheel")
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if listed.returncode != 0:
        pytest.skip("not a git checkout: which files belong to the package is not known")
    for name in filter(None, listed.stdout.split("\0")):
        if (ROOT / name).is_file():
            (folder / "tree" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / "tree" / name)
    command = ["-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder)]
    done = subprocess.run(
        [sys.executable, *command, str(folder / "tree")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = folder.glob("*.whl")
    return built


def python_of(home: Path) -> Path:
    """Return the interpreter of a virtual environment."""
    return home / ("Scripts" if os.name == "nt" else "bin") / "python"


def test_the_wheel_has_one_name_at_its_top(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    top = {name.split("/")[0] for name in names}
    assert {name for name in top if not name.endswith(".dist-info")} == {"curlshot"}
    rooms = {name.split("/")[1] for name in names if name.startswith("curlshot/")}
    assert not rooms & {"tests", "benchmarks", "docs", "examples"}


def test_the_wheel_holds_every_module_of_the_product(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        packed = {name.removeprefix("curlshot/") for name in archive.namelist()}
    outside = {"tests", "benchmarks", "docs", "examples", "build"}
    tracked = [path.relative_to(wheel.parent / "tree") for path in wheel.parent.rglob("*.py")]
    modules = {path.as_posix() for path in tracked if path.parts[0] not in outside}
    assert "pipeline.py" in modules
    assert modules - packed == set()


def test_the_sample_runs_beside_files_with_the_names_of_our_rooms(
    wheel: Path, tmp_path: Path
) -> None:
    home = tmp_path / "env"
    venv.create(home, with_pip=False, symlinks=os.name != "nt")
    (packages,) = home.glob("lib/python*/site-packages") or home.glob("Lib/site-packages")
    install = [sys.executable, "-m", "pip", "--python", str(python_of(home)), "install"]
    subprocess.run(
        [*install, "--quiet", "--no-deps", "--no-index", str(wheel)], cwd=tmp_path, check=True
    )
    # The libraries come from where the tests run; a path file brings no other editable install in.
    (packages / "libraries.pth").write_text("\n".join(site.getsitepackages()), "utf-8")
    work = tmp_path / "work"
    for name in ("data", "physics"):
        (work / name).mkdir(parents=True)
        (work / name / "__init__.py").write_text("raise ImportError('of the user')\n", "utf-8")
    for name in ("report", "pipeline", "config", "vision"):
        (work / f"{name}.py").write_text("raise ImportError('of the user')\n", "utf-8")
    python = python_of(home)
    where = subprocess.run(
        [python, "-c", "import curlshot; print(*curlshot.__path__)"],
        cwd=work, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert Path(where.stdout.strip()) == packages / "curlshot"
    done = subprocess.run(
        [python.with_name("curlshot"), "run", "-q", "--no-overlay"],
        cwd=work, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "restitution e = 0.83" in done.stdout
    assert (work / "sample-curlshot" / "report.html").exists()
