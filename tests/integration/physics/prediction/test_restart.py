from __future__ import annotations

import json
from pathlib import Path

import pytest

from curlshot.cli.main import main
from curlshot.outcome import Run


@pytest.mark.slow
def test_a_run_is_simulated_by_the_name_of_its_folder(
    sample: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert sample.out is not None
    monkeypatch.chdir(tmp_path)
    run = tmp_path / "semi.final-curlshot"
    run.mkdir()
    for name in ("results.json", "tracks.csv", "ensemble.json"):
        (run / name).write_bytes((sample.out / name).read_bytes())
    for shot in (run, run / "results.json"):
        assert main(["simulate", str(shot), "--samples", "0"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {run.name, "semi.final-whatif"}


def test_a_folder_without_a_run_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["simulate", str(tmp_path)]) == 2
    assert "name a SHOT.toml or the folder of a run" in capsys.readouterr().err


def test_a_shot_that_is_not_there_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["simulate", str(tmp_path / "none.toml")]) == 2
    assert "none.toml: no such file; name a SHOT.toml" in capsys.readouterr().err


@pytest.mark.parametrize(("option", "said"), [("--speed", "20x"), ("--spin", "fast")])
def test_a_change_that_is_none_is_named_as_it_was_written(
    option: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["simulate", "shot.toml", option, said])
    assert f"{said!r} is not" in capsys.readouterr().err


def test_what_few_throws_and_pucks_do_not_tell_is_null_and_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shot = tmp_path / "SHOT.toml"
    shot.write_text(
        "[physics]\nradius = 0.037\n[[stone]]\nname = 'A'\nx = 0.0\ny = 1.0\nvy = -0.5\n"
        "[[stone]]\nname = 'B'\nx = 0.01\ny = 0.5\n",
        encoding="utf-8",
    )
    out = tmp_path / "out"
    assert main(["simulate", str(shot), "--samples", "1", "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "A thrown 1 time, at rest:\n" in said and "±" not in said
    assert "in the house" not in said and "shot stone" not in said.partition("warning")[0]
    told = json.loads((out / "whatif.json").read_text(encoding="utf-8"))
    assert {told["stones"]["A"][key] for key in ("sd_x", "in_house", "shot_stone")} == {None}
    assert all(f"warning     {text}" in said for text in told["warnings"])
    assert [text.partition(":")[0] for text in told["warnings"]] == [
        "discs of radius 0.037 m are not curling stones", "thrown once",
    ]  # fmt: skip
