"""What was said on the command line, as settings and folders."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from curlshot.config import Config
from curlshot.data.errors import InputError
from curlshot.data.files import check_folder
from curlshot.data.messages import option

T = TypeVar("T")


def config_of(arguments: argparse.Namespace) -> Config:
    """Return the configuration: the file of ``--config``, then what stands on the command line."""
    known = vars(arguments)
    path = known.get("config")
    config = Config() if path is None else Config.from_file(path)
    given = {name: known[name] for name in config.values() if known.get(name) is not None}
    for name in given.keys() & {"masses", "names", "angles"}:
        given[name] = _by_stone(option(name), given[name])
    return config.replace(**given)


def out_folder(arguments: argparse.Namespace, first: str | Path) -> Path:
    """Folder for the files: as given, else NAME-curlshot in the current folder; checked."""
    if arguments.out is not None:
        return check_folder(arguments.out)
    path = Path(first)
    name = path.name if path.is_dir() else path.stem
    plain = re.sub(r"[*?\[\]]", "", name)  # a glob's signs do not belong in a name
    return check_folder(f"{plain or 'out'}-curlshot")


def what_if_folder(arguments: argparse.Namespace, shot: Path) -> Path:
    """Folder for the simulation of a shot; of a measured one by default NAME-whatif."""
    from curlshot.physics.prediction.restart import measured_shot

    if arguments.out is not None or not measured_shot(shot):
        folder = out_folder(arguments, shot)
        if measured_shot(shot) and folder.resolve() == shot.parent.resolve():
            raise InputError(f"{folder}: holds the run itself; name another folder with `out`")
        return folder
    return check_folder(f"{shot.resolve().parent.name.removesuffix('-curlshot')}-whatif")


def _by_stone(option: str, pairs: Sequence[tuple[str, T]]) -> dict[str, T]:
    stones = [stone for stone, _ in pairs]
    doubled = [stone for stone in stones if stones.count(stone) > 1]
    if doubled:
        raise InputError(f"{option}: {doubled[0]} is given twice")
    return dict(pairs)
