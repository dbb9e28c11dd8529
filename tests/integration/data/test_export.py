from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from curlshot.cli.main import main
from curlshot.data.export import write_csv, write_text
from curlshot.data.tracker import read_table
from curlshot.tests.helpers.data.export import SAME, shot


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("stones", ["A", "ABC", "BCX", "XYB"])
@pytest.mark.parametrize("ending", [".txt", ".csv"])
def test_what_is_written_is_read_again(
    tmp_path: Path, ending: str, stones: str, even: bool
) -> None:
    table = shot(1, stones, even)
    path = tmp_path / f"shot{ending}"
    (write_text if ending == ".txt" else write_csv)(table, path)
    found = read_table([path])
    pd.testing.assert_frame_equal(found.detections[SAME], table[SAME], check_exact=True)
    assert found.warnings == ()


def test_convert_there_and_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = shot()
    one, two, three = (str(tmp_path / name) for name in ("a.csv", "b.txt", "c.csv"))
    write_csv(table, Path(one))
    assert main(["convert", one, two]) == 0
    assert main(["convert", two, three]) == 0
    pd.testing.assert_frame_equal(read_table([Path(three)]).detections[SAME], table[SAME])
    assert "3 stones in" in capsys.readouterr().out
    for source, target in [(one, "d.docx"), (str(Path(__file__)), "d.csv")]:
        assert main(["convert", source, str(tmp_path / target)]) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
        assert not (tmp_path / target).exists()
