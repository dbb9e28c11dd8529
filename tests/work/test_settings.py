from __future__ import annotations

from pathlib import Path

import pytest

import pipeline
from data.errors import InputError
from work.settings import Settings, refuse_table_options


def test_a_tab_is_refused_where_nothing_has_tabs() -> None:
    with pytest.raises(InputError, match="only tables take --tab, --length-unit"):
        refuse_table_options(Path("shot.mp4"), Settings(tab="a", length_unit="cm"))
    with pytest.raises(InputError, match="only tables take --names"):
        refuse_table_options(Path("shot.trz"), Settings(names={"A": "mass A"}, tab="a"))


def test_a_project_has_tabs_as_a_clip_and_as_a_camera() -> None:
    refuse_table_options(Path("shot.trz"), Settings(tab="a"))
    refuse_table_options(
        Path("shot.mp4"), Settings(tab="a", length_unit="cm", camera=Path("shot.trk"))
    )


def test_check_refuses_them_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["check", str(pipeline.sample_clip()), "-o", str(tmp_path / "o"), "-q", "--tab", "x"]
    assert pipeline.main(words) == 2
    assert "only tables take --tab" in capsys.readouterr().err
