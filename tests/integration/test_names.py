"""Files whose names are no text in the encoding of today."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from curlshot import pipeline
from curlshot.report.check import check_figure
from curlshot.report.looks import Look
from curlshot.report.style import plain_text
from curlshot.tests.helpers.report import looking
from curlshot.tests.helpers.report.looking import SIZE, camera
from curlshot.vision.video.frame import Frame


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """Tracks without a header, named after a file with a name in Latin-1."""
    if sys.platform != "linux":
        pytest.skip("only here names are bytes")
    path = tmp_path / os.fsdecode(b"schu\xdf$1.txt")
    t = np.arange(40) / 25
    np.savetxt(path, np.column_stack([t, 0.01 * np.sin(t), 2 - t]), "%.4f")
    return path


def test_a_run_of_such_a_file_is_written_whole(table: Path, tmp_path: Path) -> None:
    done = pipeline.run([table], tmp_path / "out")
    assert done.out is not None
    for name in ("results.json", "tracks.csv", "report.html"):
        text = (done.out / name).read_text(encoding="utf-8")
        assert "schu?$1" in text


@pytest.mark.parametrize("ending", [".txt", ".csv", ".trk"])
def test_such_tracks_are_converted(table: Path, tmp_path: Path, ending: str) -> None:
    out = tmp_path / f"out{ending}"
    pipeline.convert([table], out)
    out.read_text(encoding="utf-8")


def test_such_names_are_drawn_and_formulas_are_not() -> None:
    assert plain_text(os.fsdecode(b"a\xdf$b$")) == r"a?\$b\$"
    look = Look(Frame(5, 0.2, np.full((SIZE[1], SIZE[0], 3), 230, np.uint8)), camera(5), ())
    figure = check_figure([look], looking.table(1, 0), (), title=os.fsdecode(b"a\xdf$b$.mp4"))
    figure.draw_without_rendering()
    assert figure.get_suptitle() == r"a?\$b\$.mp4"
