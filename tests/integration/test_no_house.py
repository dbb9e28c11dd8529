"""The origin of tables is the tee, unless a person says that it is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from curlshot import pipeline
from curlshot.cli.main import main


def glide(path: Path) -> Path:
    rows = [
        f"A,{k / 25:.2f},0.1,{2.0 - 1.2 * k / 25 + 0.05 * (k / 25) ** 2:.4f}" for k in range(50)
    ]
    path.write_text("stone,t,x,y\n" + "\n".join(rows) + "\n")
    return path


def test_what_is_taken_for_the_tee_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, out = str(glide(tmp_path / "a.csv")), str(tmp_path / "out")
    assert main(["run", table, "-q", "-o", out]) == 0
    said = capsys.readouterr().out
    assert "house       the origin is assumed to be its tee (--no-house if it is not)" in said
    assert "shot stone" in said
    assert main(["run", table, "-q", "-o", out, "--no-house"]) == 0
    said = capsys.readouterr().out
    assert "house" not in said and "shot stone" not in said
    assert main(["simulate", out, "--samples", "5", "-o", str(tmp_path / "w")]) == 0
    assert "in the house" not in capsys.readouterr().out


def test_of_a_clip_there_is_nothing_to_say(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(pipeline.sample_clip()), "--no-house"]) == 2
    assert "only tables take --no-house" in capsys.readouterr().err
