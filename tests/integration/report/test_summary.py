from __future__ import annotations

import pandas as pd
import pytest

from curlshot.cli.main import main
from curlshot.tests.helpers.report.glides import glide


@pytest.mark.parametrize(("unit", "said"), [("m", "m from the tee"), ("ft", "ft from the tee")])
def test_the_command_takes_the_unit(tmp_path, capsys, unit: str, said: str):
    tracks = pd.concat([glide("A", (0.3, 3.0), 1.0), glide("B", (0.6, 0.8))])
    tracks.to_csv(tmp_path / "glide.csv", index=False)
    words = ["estimate", "-q", str(tmp_path / "glide.csv"), "-o", str(tmp_path / "out")]
    assert main([*words, "--units", unit]) == 0
    (line,) = [k for k in capsys.readouterr().out.splitlines() if k.startswith("shot stone")]
    assert said in line
