from __future__ import annotations

import errno
import io
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from curlshot.cli.bars import Bars
from curlshot.cli.guard import NO_MEMORY, guarded, one_line, write_anywhere
from curlshot.data.errors import InputError, SceneError
from curlshot.data.files import staged


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
        (MemoryError(), 2, f"curlshot: {NO_MEMORY}\n"),
        (KeyboardInterrupt(), 130, "curlshot: stopped; unfinished output is not written\n"),
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


@contextmanager
def handling(number: int, handler: object) -> Iterator[None]:
    """Let a signal be handled so for a while."""
    before = signal.signal(number, handler)
    try:
        yield
    finally:
        signal.signal(number, before)


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_signal_to_end_leaves_nothing_behind(name: str, tmp_path: Path, capsys) -> None:
    number = getattr(signal, name, signal.SIGTERM)

    def work() -> str:
        with staged(tmp_path / "out") as stage:
            (stage / "tracks.csv").write_text("half")
            try:
                os.kill(os.getpid(), number)
                time.sleep(5)  # the signal is handled before it is over
            finally:
                os.kill(os.getpid(), number)  # as a shell does after its terminal
        return "done"

    bars = Watched()
    with handling(number, signal.SIG_DFL):
        assert guarded(work, bars) == 128 + number
        assert signal.getsignal(number) is signal.SIG_DFL
    assert list(tmp_path.iterdir()) == []
    said = "curlshot: stopped; unfinished output is not written\n"
    assert (capsys.readouterr().err, bars.closed) == (said, 1)


def test_signals_that_are_ignored_or_handled_stay_so() -> None:
    seen: list[int] = []
    for handler in (signal.SIG_IGN, lambda number, _: seen.append(number)):
        with handling(signal.SIGTERM, handler):
            assert guarded(lambda: str(os.kill(os.getpid(), signal.SIGTERM)), Watched()) == 0
    assert seen == [signal.SIGTERM]


def test_work_in_another_thread_takes_no_signals() -> None:
    codes: list[int] = []
    thread = threading.Thread(target=lambda: codes.append(guarded(lambda: "", Watched())))
    thread.start()
    thread.join()
    assert codes == [0]


def test_one_line() -> None:
    assert one_line(" a\n  b\tc ") == "a b c"


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_a_terminal_without_greek_letters_gets_them_spelled_out(
    encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a file does in Windows into which help or an answer goes."""
    for name in ("stdout", "stderr"):
        monkeypatch.setattr(sys, name, io.TextIOWrapper(io.BytesIO(), encoding=encoding))
    write_anywhere()
    print("μ = 0.0109 ± 0.0001, − 1 m, 日", flush=True)
    said = sys.stdout.buffer.getvalue().decode(encoding).strip()
    assert said.replace("±", "+-") == "mu = 0.0109 +- 0.0001, - 1 m, ?"
