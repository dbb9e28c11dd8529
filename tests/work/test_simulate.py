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


def test_a_shot_that_is_not_there_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert pipeline.main(["simulate", str(tmp_path / "none.toml")]) == 2
    assert "none.toml: no such file; name a SHOT.toml" in capsys.readouterr().err


@pytest.mark.parametrize(("option", "said"), [("--speed", "20x"), ("--spin", "fast")])
def test_a_change_that_is_none_is_named_as_it_was_written(
    option: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        pipeline.main(["simulate", "shot.toml", option, said])
    assert f"{said!r} is not" in capsys.readouterr().err
