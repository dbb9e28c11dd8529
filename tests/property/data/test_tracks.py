from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from curlshot.data.errors import InputError
from curlshot.data.tracker import read_table


@settings(
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    cells=st.lists(
        st.sampled_from(
            [
                *("stone", "t", "x", "y", "seen", "frame", "A", "0", "1", "-1e308", "1e999"),
                *("nan", "1e30", "1_0", "True", '"', "", ",", ",", "\n", "stone,t,x,y\n"),
            ]
        ),
        max_size=40,
    )
)
def test_any_text_is_read_or_refused(tmp_path: Path, cells: list[str]) -> None:
    path = tmp_path / "tracks.csv"
    path.write_text("".join(cells))
    try:
        table = read_table([path]).detections
    except InputError:
        return
    assert np.isfinite(table[["t", "x", "y"]].to_numpy()).all()
    assert (table.groupby("stone")["t"].diff().dropna() > 0).all()
