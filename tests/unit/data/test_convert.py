from __future__ import annotations

from pathlib import Path

from curlshot.pipeline import convert


def test_text_of_tracker_has_no_teams_and_it_is_said(tmp_path: Path) -> None:
    table = tmp_path / "shot.csv"
    table.write_text("stone,team,t,x,y\nA,red,0,0,0\nA,red,1,0,1\n", encoding="utf-8")
    assert any("teams" in text for text in convert([table], tmp_path / "a.txt").warnings)
    for name in ("a.csv", "a.trk"):
        assert not any("teams" in text for text in convert([table], tmp_path / name).warnings)
    assert not convert([tmp_path / "a.txt"], tmp_path / "b.txt").warnings
