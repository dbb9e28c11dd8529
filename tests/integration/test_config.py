from __future__ import annotations

from pathlib import Path

import pytest

from curlshot import pipeline
from curlshot.cli.main import main


def test_check_refuses_them_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["check", str(pipeline.sample_clip()), "-o", str(tmp_path / "o"), "-q", "--tab", "x"]
    assert main(words) == 2
    assert "only tables take --tab" in capsys.readouterr().err
