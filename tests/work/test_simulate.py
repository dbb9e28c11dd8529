from __future__ import annotations

from pathlib import Path

import pytest

import pipeline


def test_a_run_is_simulated_by_the_name_of_its_folder(
    sample: pipeline.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert sample.out is not None
    monkeypatch.chdir(tmp_path)
    run = tmp_path / "semi.final-curlshot"
    run.mkdir()
    for name in ("results.json", "tracks.csv"):
        (run / name).write_bytes((sample.out / name).read_bytes())
    for shot in (run, run / "results.json"):
        assert pipeline.main(["simulate", str(shot), "--samples", "0"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {run.name, "semi.final-whatif"}


def test_a_folder_without_a_run_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert pipeline.main(["simulate", str(tmp_path)]) == 2
    assert "name a SHOT.toml or the folder of a run" in capsys.readouterr().err
