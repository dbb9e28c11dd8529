"""Runs of many kinds of clips and tables come to what is stored of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from curlshot.tests.golden import stored
from curlshot.tests.golden.cases import SHARED_TABLES, case_of, shared_tables

SUBSET = (
    "clip_lines_360", "clip_lines_480_letterboxed", "clip_moving",
    "table_tracker_project_moving_axes", "table_tracks_measured",
)  # fmt: skip
"""Quick cases that stand for the others."""


@pytest.mark.golden
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.golden_subset) if name in SUBSET else name
        for name in stored.names()
    ],
)
def test_a_run_comes_to_what_is_stored(name: str, tmp_path: Path) -> None:
    found = stored.differences(name, stored.read(name), stored.measured(name, tmp_path))
    assert not found, "\n".join(found)


@pytest.mark.golden
@pytest.mark.parametrize("name", [case_of(path) for path in SHARED_TABLES])
def test_tables_of_others_come_to_what_is_stored(name: str, tmp_path: Path) -> None:
    if name not in shared_tables():
        pytest.skip("the folder ../shared with tables of others is not here")
    found = stored.differences(name, stored.read(name), stored.measured(name, tmp_path))
    assert not found, "\n".join(found)


@pytest.mark.golden
@pytest.mark.golden_subset
def test_every_stored_run_has_a_case() -> None:
    files = {path.name.removesuffix(".json.gz") for path in stored.EXPECTED.glob("*")}
    assert files == {*stored.names(), *map(case_of, SHARED_TABLES)}
