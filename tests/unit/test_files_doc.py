"""The page on files names what is written, and nothing else."""

from __future__ import annotations

import dataclasses
import re
import typing
from pathlib import Path

import pytest

from curlshot.data import results
from curlshot.data.tracks import MEASURED_AS, TRACK_COLUMNS
from curlshot.physics.prediction.what_if import Odds
from curlshot.physics.simulator.simulation import Shot
from curlshot.physics.statistics.pool import Pooled
from curlshot.physics.statistics.season import HIT_COLUMNS, SHOT_COLUMNS
from curlshot.vision.optics.camera import CAMERA_COLUMNS

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "files.md").read_text("utf-8")
OTHERS = {
    "schema", "model", "sample", "hits", "start", "shots", "input", "thrown", "changes", "samples",
    "throw_sd", "direction", "warnings", "size", "inertia", "loss", "local", "shot_fit",
    "finite-differences", "constant", "fit", "sd_", "--samples", "--fps", "curlshot.load",
    "--config", "#rrggbb", "curlshot simulate", "SHOT.toml",
}  # fmt: skip
"""What else the page names."""


def fields_of(kind: object) -> set[str]:
    """Names of the fields of a dataclass, and of those within it."""
    found: set[str] = set()
    waiting, known = [kind], set()
    while waiting:
        one = waiting.pop()
        if id(one) in known:
            continue
        known.add(id(one))
        if dataclasses.is_dataclass(one) and isinstance(one, type):
            found |= {field.name for field in dataclasses.fields(one)}
            waiting += typing.get_type_hints(one).values()
        waiting += typing.get_args(one)
    return found


WRITTEN = {
    "tracks.csv": {*TRACK_COLUMNS, *MEASURED_AS},
    "camera.csv": {*CAMERA_COLUMNS},
    "results.json": fields_of(results.Results),
    "ensemble.json": {field.name for field in dataclasses.fields(Shot)},
    "outcomes.csv": {"sample", "stone", "x", "y", "hits", "in_play"},
    "whatif.json": fields_of(Odds)
    | {"schema", "input", "thrown", "changes", "samples", "throw_sd", "stones", "warnings"},
    "shots.csv": {*SHOT_COLUMNS},
    "hits.csv": {*HIT_COLUMNS},
    "season.json": fields_of(Pooled),
}  # fmt: skip


@pytest.mark.parametrize("name", WRITTEN)
def test_each_column_and_key_is_told(name: str) -> None:
    section = next(part for part in PAGE.split("\n## ") if f"`{name}`" in part)
    missing = {key for key in WRITTEN[name] if f"`{key}`" not in section}
    assert not missing


def test_nothing_else_is_told() -> None:
    names = re.findall(r"`([^`]+)`", PAGE)
    files = {name for name in names if re.search(r"\.(csv|json|png|toml)$", name)}
    known = set().union(*WRITTEN.values()) | OTHERS | files
    assert set(names) <= known
