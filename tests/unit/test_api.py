"""The public API: what it lists, and what it costs to import."""

from __future__ import annotations

import shutil
import subprocess
import sys
import types
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

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


STONES = (curlshot.StoneStart("A", 0.0, 2.0, vy=-1.5), curlshot.StoneStart("B", 0.0, 0.0))


@pytest.fixture(scope="module")
def simulated() -> curlshot.SimulatedShot:
    return curlshot.simulate(curlshot.Shot(STONES))


@pytest.mark.parametrize(
    ("method", "arguments", "name"),
    [
        ("throw", {"samples": 0}, "samples"),
        ("throw", {"samples": -1}, "samples"),
        ("throw", {"samples": "a"}, "samples"),
        ("throw", {"throw_sd": (1,)}, "throw_sd"),
        ("throw", {"throw_sd": 0.1}, "throw_sd"),
        ("throw", {"throw_sd": (-1, 0.1)}, "throw_sd"),
        ("throw", {"throw_sd": ("a", 0.1)}, "throw_sd"),
        ("sample", {"times": [-1]}, "times"),
        ("sample", {"times": None}, "times"),
        ("sample", {"times": ["a"]}, "times"),
        ("table", {"fps": 0}, "fps"),
        ("table", {"fps": "a"}, "fps"),
        ("plot", {"ax": "x"}, "ax"),
    ],
)
def test_a_simulated_shot_names_the_argument_that_makes_no_sense(
    simulated: curlshot.SimulatedShot, method: str, arguments: dict[str, Any], name: str
) -> None:
    with pytest.raises(curlshot.InputError, match=f"^`{name}`: "):
        getattr(simulated, method)(**arguments)


@pytest.mark.parametrize(
    ("parts", "names"),
    [
        ({"stones": ("A",)}, "`stones`: 'A' is not a StoneStart"),
        ({"stones": STONES[0]}, "`stones`: .* is not a tuple of StoneStart"),
        ({"stones": (replace(STONES[0], x="q"),)}, "`x` of stone A: 'q' is not a number"),
        ({"stones": (replace(STONES[0], name=1),)}, "`name`: 1 is not the name"),
        ({"stones": (replace(STONES[0], omega_after=("q",)),)}, "`omega_after` of stone A"),
        ({"stones": (replace(STONES[0], x=float("nan")),)}, "stone A: x = nan is not finite"),
        ({"radius": None}, "`radius`: None is not a number"),
        ({"bounds": "sheet"}, "`bounds`: 'sheet' is not Bounds"),
        ({"ice": "fcv1"}, "`ice`: 'fcv1' is not a law of ice"),
        ({"curl": curlshot.NoCurl}, "`curl`: .* is not a law of curl"),
        ({"impact": "frictional"}, "`impact`: 'frictional' is not a model of hits"),
        (
            {"impact": curlshot.Frictional(restitution=2)},
            "`restitution` of `impact`: 2 is not a number 0 or more, at most 1",
        ),
        ({"impact": curlshot.Frictional(inertia=0.0)}, "`inertia` of `impact`: .* above 0"),
        ({"impact": curlshot.PointMass("q")}, "`restitution` of `impact`: 'q'"),  # type: ignore[arg-type]
    ],
)
def test_a_shot_names_the_part_that_makes_no_sense(parts: dict[str, Any], names: str) -> None:
    shot = replace(curlshot.Shot(STONES), **parts)
    with pytest.raises(curlshot.InputError, match=names):
        curlshot.simulate(shot)


@pytest.mark.parametrize(
    ("function", "arguments", "name"),
    [
        ("simulate", {"shot": None}, "shot"),
        ("simulate", {"shot": curlshot.Shot(STONES), "aim_offset": None}, "aim_offset"),
        ("load", {"folder": None}, "folder"),
        ("run", {"inputs": 5}, "inputs"),
        ("run", {"inputs": [5]}, "inputs"),
        ("run", {"out": 5}, "out"),
        ("run", {"config": {}}, "config"),
        ("check", {"inputs": None}, "inputs"),
        ("convert", {"inputs": "tracks.csv", "out": "tracks.txt", "config": {}}, "config"),
        ("run_each", {"clips": "a.mp4", "out": "out", "jobs": "a"}, "jobs"),
        ("run_each", {"clips": None, "out": "out"}, "clips"),
        ("combine", {"runs": None}, "runs"),
        ("combine", {"runs": {"a": 5}}, "runs"),
        ("Config", {"video": {}}, "video"),
    ],
)
def test_a_function_names_the_argument_of_a_wrong_type(
    function: str, arguments: dict[str, Any], name: str
) -> None:
    with pytest.raises(curlshot.InputError, match=f"^`{name}`: .* is not a"):
        getattr(curlshot, function)(**arguments)


@pytest.fixture(scope="module")
def still(tmp_path_factory: pytest.TempPathFactory) -> curlshot.Run:
    """A run with files, of stones that lie still."""
    folder = tmp_path_factory.mktemp("runs")
    stones = (replace(STONES[0], vy=0.0), STONES[1])
    table = curlshot.simulate(curlshot.Shot(stones)).sample([0.0, 0.1, 0.2, 0.3])
    table.to_csv(folder / "still.csv")
    return curlshot.run(folder / "still.csv", out=folder / "still")


@pytest.fixture
def copied(still: curlshot.Run, tmp_path: Path) -> Path:
    """The folder of a run, to be changed."""
    assert still.out is not None
    return shutil.copytree(still.out, tmp_path / "copied")


def test_runs_are_combined_without_names(still: curlshot.Run) -> None:
    unwritten = replace(still, out=None)
    for given in (still, [still], [unwritten], {"still": still}):
        assert curlshot.combine(given).shots["shot"].tolist() == ["still"]
    season = curlshot.combine([still, unwritten])
    assert len(season.shots) + len(season.left_out) == 2
    with pytest.raises(curlshot.InputError, match="`runs`: "):
        curlshot.combine([still, still.out])  # type: ignore[list-item]


def test_runs_and_seasons_compare_by_identity(still: curlshot.Run) -> None:
    assert still.out is not None and still.measurement is not None
    again, season = curlshot.load(still.out), curlshot.combine(still)
    assert again == again and again != still
    assert season == season and season != curlshot.combine(still)
    assert still.measurement == still.measurement and len({still, again, season}) == 3
    with pytest.raises(curlshot.InputError, match="`folder`: None is not a path"):
        still.report(None)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["camera.csv", "posterior.csv"])
@pytest.mark.parametrize("text", ["", "one,two\n1,2\n", "\0\xff"])
def test_a_broken_file_of_a_run_is_refused(copied: Path, name: str, text: str) -> None:
    (copied / name).write_text(text, encoding="latin-1")
    with pytest.raises(curlshot.InputError, match=name):
        curlshot.load(copied)


def test_a_file_of_a_run_holds_numbers(copied: Path) -> None:
    path = copied / "posterior.csv"
    path.write_text("sample,restitution,friction,stone_friction\n0,0.8,0.01,\n", "utf-8")
    table = curlshot.load(copied).posterior
    assert table is not None and table["friction"].tolist() == [0.01]
    path.write_text("sample,restitution,friction,stone_friction\n0,high,0.01,\n", "utf-8")
    with pytest.raises(curlshot.InputError, match="column restitution is not all numbers"):
        curlshot.load(copied)
