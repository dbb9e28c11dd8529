from __future__ import annotations

import importlib.util
from pathlib import Path

import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.export import write_parquet, write_text
from curlshot.data.tracker import read_table
from curlshot.tests.helpers.data.export import SAME, shot


def test_names_for_tracker_have_no_blanks(tmp_path: Path) -> None:
    table = shot().replace({"stone": {"A": "mass A", "B": "mass B"}})
    write_text(table, tmp_path / "a.txt")
    assert set(read_table([tmp_path / "a.txt"]).detections["stone"]) == {"mass_A", "mass_B", "C"}
    with pytest.raises(InputError, match="without blanks"):
        write_text(table.replace({"stone": {"C": "mass_A"}}), tmp_path / "b.txt")
    assert not (tmp_path / "b.txt").exists()


def test_parquet_needs_its_library(tmp_path: Path) -> None:
    table, path = shot(), tmp_path / "a.parquet"
    if importlib.util.find_spec("pyarrow") is None:
        with pytest.raises(InputError, match="pip install pyarrow"):
            write_parquet(table, path)
        path.write_bytes(b"PAR1")
        with pytest.raises(InputError, match="pip install pyarrow"):
            read_table([path])
        return
    write_parquet(table, path)
    pd.testing.assert_frame_equal(read_table([path]).detections[SAME], table[SAME])
    path.write_bytes(b"no table")
    with pytest.raises(InputError, match="no Parquet"):
        read_table([path])
