from __future__ import annotations

from curlshot.cli.bars import Bars


def test_each_work_has_its_bar_and_its_total(capsys) -> None:
    bars = Bars(quiet=False)
    for done in (1, 2):
        bars("reading", done, None)
    bars("reading", 3, 3)
    bars("report", 1, 1)
    assert [(name, bar.n, bar.total) for name, bar in bars.bars.items()] == [
        ("reading", 3, 3),
        ("report", 1, 1),
    ]
    bars.close()
    said = capsys.readouterr().err
    assert "reading" in said and "3/3" in said and "report" in said


def test_quiet_bars_say_nothing(capsys) -> None:
    bars = Bars(quiet=True)
    bars("reading", 1, 2)
    bars.close()
    assert capsys.readouterr().err == ""
