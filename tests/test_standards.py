"""Lint, format, types and the direction of imports, as part of the one test command."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from curlshot.data.version import VERSION

ROOT = Path(__file__).resolve().parents[1]
MAY_IMPORT = {
    "data": set(),
    "config": {"data"},
    "physics": {"data", "config"},
    "vision": {"data", "config"},
    "synthetic": set(),
    "report": {"data", "config", "physics", "vision", "outcome"},
    "outcome": {"data", "config", "physics", "report"},
    "pipeline": {"data", "config", "physics", "vision", "outcome"},
    "simulated": {"data", "config", "physics", "report", "outcome"},
    "season": {"data", "config", "physics", "report", "outcome", "pipeline"},
    "cli": {
        "data",
        "config",
        "physics",
        "vision",
        "report",
        "outcome",
        "pipeline",
        "simulated",
        "season",
    },
}
"""The rooms that each room may import. `outcome` and `report` are one floor: a run draws itself."""
ORDER = {
    "vision": "video optics sheet camera_path spin detection association track measure",
    "physics": "registry impact ice curl filter statistics local_fit kalman simulator shot_fit"
    " estimate posterior prediction steps cautions",
}
"""Folders and modules of a room: each may import itself and those before it."""


def modules(room: str) -> list[Path]:
    file = ROOT / f"{room}.py"
    return [file] if file.exists() else sorted((ROOT / room).rglob("*.py"))


def imported(path: Path) -> set[str]:
    """Dotted names of all that a module imports, with what it takes out of modules."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports hide the direction"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def imported_rooms(path: Path) -> set[str]:
    names = [name.split(".") for name in imported(path)]
    outside = {first for first, *_ in names} & MAY_IMPORT.keys()
    assert not outside, f"{path}: the package is curlshot, so curlshot.{outside.pop()}"
    rooms = {rest[0] for first, *rest in names if first == "curlshot" and rest}
    return rooms & (MAY_IMPORT.keys() | {"tests", "benchmarks"})


@pytest.mark.parametrize("room", sorted(MAY_IMPORT))
def test_imports_point_one_way(room: str) -> None:
    for path in modules(room):
        wrong = imported_rooms(path) - MAY_IMPORT[room] - {room}
        assert not wrong, f"{path.relative_to(ROOT)} imports {', '.join(sorted(wrong))}"


def test_benchmarks_do_not_import_tests() -> None:
    for path in sorted((ROOT / "benchmarks").rglob("*.py")):
        assert "tests" not in imported_rooms(path), path.name


def test_the_version_stands_in_one_place_and_is_cited() -> None:
    cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.M)
    assert cited is not None and cited[1].strip("'\"") == VERSION
    assert f"## {VERSION.partition('.dev')[0]}" in (ROOT / "CHANGELOG.md").read_text("utf-8")


@pytest.mark.parametrize("room", sorted(ORDER))
def test_imports_within_a_room_point_one_way(room: str) -> None:
    order = ORDER[room].split()
    for path in modules(room):
        place = path.relative_to(ROOT / room).with_suffix("").parts[0]
        if place == "__init__":
            continue
        assert place in order, f"{path.relative_to(ROOT)} has no place in the order of {room}"
        start = f"curlshot.{room}."
        within = {name.split(".")[2] for name in imported(path) if name.startswith(start)}
        wrong = within - set(order[: order.index(place) + 1])
        assert not wrong, f"{path.relative_to(ROOT)} imports {', '.join(sorted(wrong))}"


@pytest.mark.parametrize("room", sorted(MAY_IMPORT))
def test_what_a_docstring_refers_to_is_there(room: str) -> None:
    name = re.compile(rf"(?<!`)`(?:curlshot\.)?((?:{'|'.join(MAY_IMPORT)})(?:\.\w+)+)`(?!`)")
    for path in modules(room):
        for dotted in name.findall(path.read_text(encoding="utf-8")):
            place, rest = ROOT, dotted.split(".")
            while rest and ((place / rest[0]).is_dir() or (place / f"{rest[0]}.py").exists()):
                place /= rest.pop(0)
            module = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
            there = not rest or re.search(rf"\b{rest[0]}\b", module.read_text(encoding="utf-8"))
            assert there, f"{path.relative_to(ROOT)} refers to {dotted}"


@pytest.mark.parametrize(
    "command",
    [
        ["-m", "ruff", "check", "."],
        ["-m", "ruff", "format", "--check", "."],
        ["tests/check_types.py"],
    ],
    ids=["lint", "format", "types"],
)
def test_clean(command: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, *command], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_data_and_physics_load_neither_opencv_nor_matplotlib() -> None:
    paths = [path.relative_to(ROOT) for room in ("data", "physics") for path in modules(room)]
    names = [".".join(("curlshot", *path.with_suffix("").parts)) for path in paths]
    code = f"import sys, {', '.join(names)}; "
    code += "print([m for m in ('cv2', 'matplotlib') if m in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
