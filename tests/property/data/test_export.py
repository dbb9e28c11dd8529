from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from curlshot.data.export import write_csv, write_text
from curlshot.data.tracker import read_table
from curlshot.data.tracks import check_detections


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
