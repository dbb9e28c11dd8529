from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.config import Config
from curlshot.data.errors import InputError
from curlshot.data.importers import import_tracks, refuse_clips
from curlshot.pipeline import measure


def table(path: Path, radius: float = 0.1455) -> Path:
    t = np.arange(40) / 25
    place = {"t": t, "x": 0.3 * t, "y": 10 * radius - 0.8 * t}
    pd.DataFrame(place).to_csv(path, index=False)
    return path


def test_a_table_has_no_clip_and_no_cameras(tmp_path: Path) -> None:
    found = measure([table(tmp_path / "A.csv")])
    assert (found.clip, found.cameras) == (None, ())
    assert (found.frames, found.fps) == (40, pytest.approx(25.0))
    assert found.house is not None
    assert found.detections["stone"].unique().tolist() == ["A"]


def test_pucks_have_no_house(tmp_path: Path) -> None:
    path = table(tmp_path / "A.csv", 0.0465)
    assert measure([path], Config().replace(radius=0.0465)).house is None
    assert measure([path], Config().replace(radius=0.145)).house is not None


def test_the_unit_of_the_table_is_taken(tmp_path: Path) -> None:
    path = table(tmp_path / "A.csv")
    metres = import_tracks([path]).detections
    inches = import_tracks([path], length_unit="in").detections
    np.testing.assert_allclose(inches[["x", "y"]], 0.0254 * metres[["x", "y"]])


@pytest.mark.parametrize(
    ("names", "settings", "said"),
    [
        (("A.csv", "a.mp4"), Config(), "do not mix"),
        (("A.csv",), Config().replace(house=(0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0)), "A.csv"),
        (("no.csv",), Config(), "no such file"),
    ],
)
def test_what_does_not_go_together_is_refused(
    tmp_path: Path, names: tuple[str, ...], settings: Config, said: str
) -> None:
    table(tmp_path / "A.csv")
    (tmp_path / "a.mp4").touch()
    with pytest.raises(InputError, match=said):
        measure([tmp_path / name for name in names], settings)


def test_clips_are_sent_to_the_command_that_takes_them(tmp_path: Path) -> None:
    refuse_clips([tmp_path / "A.csv", tmp_path / "b.trk"], "run")
    with pytest.raises(InputError, match=r"a.mp4: not a table of tracks; try `run`"):
        refuse_clips([tmp_path / "A.csv", tmp_path / "a.mp4"], "run")
    with pytest.raises(InputError, match=r"a.xlsx: a spreadsheet; save it as CSV"):
        refuse_clips([tmp_path / "a.xlsx"], "run")
