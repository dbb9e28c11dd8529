"""What was said on the command line, as settings and folders."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from curlshot.data.errors import InputError
from curlshot.data.files import check_folder
from curlshot.data.sheet import STONE
from curlshot.work.settings import Settings
from curlshot.work.simulate import measured_shot

T = TypeVar("T")


def settings_of(arguments: argparse.Namespace) -> Settings:
    """Gather what was said of the input; a command takes some of the options only."""
    known = vars(arguments)
    return Settings(
        fps=known.get("fps"),
        frames=known.get("frames"),
        stick=known.get("stick"),
        house=known.get("house"),
        camera=known.get("camera"),
        camera_height=known.get("camera_height"),
        radius=known.get("radius", STONE.radius),
        masses=_by_stone("--mass", known.get("mass", ())),
        length_unit=known.get("length_unit"),
        angle_unit=known.get("angle_unit"),
        no_house=known.get("no_house", False),
        clip=known.get("clip", False),
        tab=known.get("tab"),
        names=_by_stone("--names", known.get("names", [])),
        angles={s: Path(p) for s, p in _by_stone("--angles", known.get("angles", [])).items()},
        overlay=not known.get("no_overlay", False),
        restitution=known.get("restitution"),
        friction=known.get("friction"),
        samples=known.get("samples") or 0,
        units=known.get("units", "m"),
    )


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
    if arguments.out is not None or not measured_shot(shot):
        return out_folder(arguments, shot)
    return check_folder(f"{shot.resolve().parent.name.removesuffix('-curlshot')}-whatif")


def _by_stone(option: str, pairs: Sequence[tuple[str, T]]) -> dict[str, T]:
    stones = [stone for stone, _ in pairs]
    doubled = [stone for stone in stones if stones.count(stone) > 1]
    if doubled:
        raise InputError(f"{option}: {doubled[0]} is given twice")
    return dict(pairs)
