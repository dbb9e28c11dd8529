"""What tests of tracker share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from curlshot.data.tracker import Imported, read_table
from curlshot.tests.helpers.data.dialects import put


def read(folder: Path, text: str | bytes, **options: object) -> Imported:
    return read_table([put(folder, text, "shot.txt")], **options)  # type: ignore[arg-type]


def assert_same(found: pd.DataFrame, wanted: pd.DataFrame, digits: float) -> None:
    wanted = wanted.sort_values(["stone", "t"]).reset_index(drop=True)
    assert list(found["stone"]) == list(wanted["stone"])
    np.testing.assert_array_equal(found["frame"], wanted["frame"])
    np.testing.assert_allclose(found[["x", "y"]], wanted[["x", "y"]], rtol=0, atol=digits)
    np.testing.assert_allclose(found["t"], wanted["t"], rtol=0, atol=5e-4)
