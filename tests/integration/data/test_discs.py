from __future__ import annotations

from pathlib import Path

import pytest

from curlshot.cli.main import main
from curlshot.data.discs import refuse_no_discs
from curlshot.data.tracker import read_table
from curlshot.tests.helpers.data.discs import shot


def test_the_command_says_so_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shot()[["stone", "t", "x", "y"]].to_csv(tmp_path / "a.csv", index=False)
    given = ["estimate", str(tmp_path / "a.csv"), "-o", str(tmp_path / "out"), "-q"]
    assert main([*given, "--length-unit", "ft"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "another length unit" in line
    assert not (tmp_path / "out").exists()


def test_no_length_unit_is_advised_where_the_file_says_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = shot(0.01)[["stone", "t", "x", "y"]].rename(columns={"x": "x (m)", "y": "y (m)"})
    table.to_csv(tmp_path / "a.csv", index=False)
    assert main(["estimate", str(tmp_path / "a.csv"), "-o", str(tmp_path / "o"), "-q"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "calibration" in line and "--length-unit" not in line


def test_real_discs_pass(shared: Path) -> None:
    """Air tables and motion capture, whose discs touch for long."""
    pucks = read_table([shared / "tracks" / "airtable_two_pucks.csv"], length_unit="cm")
    refuse_no_discs(pucks.detections, 0.035, "pucks")
    for path in (shared / "tracks" / "discs_500hz").glob("hit_*.csv"):
        refuse_no_discs(read_table([path], fps=500).detections, 0.025, path.name)
