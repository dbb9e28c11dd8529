from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from curlshot.cli.main import main
from curlshot.data.errors import InputError
from curlshot.data.export import write_csv, write_parquet, write_text
from curlshot.data.tracker import read_table
from curlshot.data.tracks import check_detections


def shot(seed: int = 0, stones: str = "ABC", even: bool = True) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    frame = np.arange(12, 52)
    t = frame / 30 if even else np.cumsum(rng.uniform(0.02, 0.06, len(frame)))
    rows = [
        pd.DataFrame(
            {
                "stone": stone,
                "frame": frame,
                "t": t,
                "x": np.sin(t) + rng.normal(0, 0.001, len(t)),
                "y": 2 * t,
                # The air moves pucks that turn six times a second.
                "theta": 31.0 + (40 * t if stone == "C" else t) if stone != "B" else np.nan,
                "sd_x": 0.002 if stone != "C" else np.nan,
                "sd_y": 0.003 if stone != "C" else np.nan,
                "sd_theta": 0.02 if stone == "A" else np.nan,
            }
        )[rng.uniform(size=len(t)) > 0.2]
        for stone in stones
    ]
    return check_detections(pd.concat(rows))


SAME = ["stone", "frame", "t", "x", "y", "theta", "sd_x", "sd_y", "sd_theta"]


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


@settings(
    deadline=None, max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    values=st.lists(st.floats(-2, 2, allow_subnormal=False), min_size=2, max_size=20),
    ending=st.sampled_from([".txt", ".csv"]),
)
def test_every_digit_survives(tmp_path: Path, values: list[float], ending: str) -> None:
    t = 0.3 * np.arange(len(values)) + 0.1
    table = check_detections(pd.DataFrame({"stone": "A", "t": t, "x": values, "y": values[::-1]}))
    path = tmp_path / f"a{ending}"
    (write_text if ending == ".txt" else write_csv)(table, path)
    found = read_table([path]).detections
    pd.testing.assert_frame_equal(found[["t", "x", "y"]], table[["t", "x", "y"]], check_exact=True)


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
