from __future__ import annotations

import errno

import pytest

from command.bars import Bars
from command.guard import guarded, one_line
from data.errors import InputError, SceneError


class Watched(Bars):
    """Bars that tell whether they were closed before anything was printed."""

    def __init__(self) -> None:
        super().__init__(quiet=True)
        self.closed = 0

    def close(self) -> None:
        self.closed += 1


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (InputError("a.mp4: not\na video"), 2, "curlshot: a.mp4: not a video\n"),
        (SceneError("no house"), 2, "curlshot: no house\n"),
        (OSError(errno.ENOSPC, "No space left", "out"), 2, "curlshot: out: No space left\n"),
        (MemoryError(), 2, "curlshot: not enough memory; try fewer or smaller pictures\n"),
        (KeyboardInterrupt(), 130, "curlshot: stopped; what was under way is not written\n"),
    ],
)
def test_a_failure_is_one_line(error, code: int, said: str, capsys) -> None:
    def fails() -> str:
        raise error

    bars = Watched()
    assert guarded(fails, bars) == code
    assert (capsys.readouterr().err, bars.closed) == (said, 1)


def test_a_bug_is_not_hidden() -> None:
    with pytest.raises(ZeroDivisionError):
        guarded(lambda: str(1 // 0), Watched())


def test_the_answer_is_printed(capsys) -> None:
    bars = Watched()
    assert guarded(lambda: "e 0.83 ± 0.01", bars) == 0
    assert (capsys.readouterr().out, bars.closed) == ("e 0.83 ± 0.01\n", 1)


def test_one_line() -> None:
    assert one_line(" a\n  b\tc ") == "a b c"
