from __future__ import annotations

from argparse import Namespace
from pathlib import Path

import pytest

from curlshot.cli.arguments import config_of, out_folder, what_if_folder
from curlshot.config import Config
from curlshot.data.errors import InputError


def test_what_was_not_said_is_as_usual() -> None:
    assert config_of(Namespace()) == Config()


def test_values_by_stone_are_gathered() -> None:
    said = Namespace(masses=[("A", 19.1), ("B", 18.0)], angles=[("A", "a.txt")], samples=None)
    settings = config_of(said)
    assert settings.stones.masses == {"A": 19.1, "B": 18.0}
    assert settings.tables.angles == {"A": Path("a.txt")}
    assert settings.physics.samples == 0


def test_a_stone_that_is_named_twice_is_refused() -> None:
    with pytest.raises(InputError, match="--names: A is given twice"):
        config_of(Namespace(names=[("A", "x"), ("A", "y")]))


@pytest.mark.parametrize(
    ("first", "folder"),
    [
        ("clips/shot.mp4", "shot-curlshot"),
        ("[a]*.csv", "a-curlshot"),
        ("*.csv", "out-curlshot"),
    ],
)
def test_the_folder_is_named_after_the_input(first: str, folder: str) -> None:
    assert out_folder(Namespace(out=None), first) == Path(folder)
    assert out_folder(Namespace(out="mine"), first) == Path("mine")


def test_a_folder_of_pictures_keeps_its_whole_name(tmp_path: Path) -> None:
    (tmp_path / "take.7").mkdir()
    assert out_folder(Namespace(out=None), tmp_path / "take.7") == Path("take.7-curlshot")


def test_what_ifs_stand_beside_their_run(tmp_path: Path) -> None:
    run = tmp_path / "shot-curlshot"
    run.mkdir()
    results = run / "results.json"
    results.write_text("{}")
    assert what_if_folder(Namespace(out=None), results) == Path("shot-whatif")
    assert what_if_folder(Namespace(out="x"), results) == Path("x")
    assert what_if_folder(Namespace(out=None), tmp_path / "a.toml") == Path("a-curlshot")
