"""What becomes of the work on the terminal: its text, or one line that says what is wrong."""

from __future__ import annotations

import codecs
import io
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from curlshot.cli.bars import Bars
from curlshot.data.errors import CurlshotError
from curlshot.data.messages import as_options

_ENDS = ("SIGTERM", "SIGHUP")
"""Signals that ask to end, where the platform has them."""

_SPELLED = {
    "μ": "mu",
    "ω": "omega",
    "σ": "sigma",
    "±": "+-",
    "−": "-",
    "—": "-",
    "×": "x",
    "…": "...",
}
"""What a terminal gets that lacks such letters, and files in the encodings of Windows."""


def write_anywhere() -> None:
    """Spell out on the terminal what its encoding lacks, or put "?" for it, instead of failing."""
    codecs.register_error("curlshot", _spelled)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="curlshot")


def _spelled(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    return "".join(_SPELLED.get(letter, "?") for letter in letters), error.end


NO_MEMORY = "not enough memory; try fewer or smaller frames, or fewer clips at once"


def guarded(work: Callable[[], str], bars: Bars) -> int:
    """Do some work and print its text.

    Returns
    -------
    int
        The exit code: 0 well, 2 a person's mistake, 128 + n stopped by the signal n.
    """
    try:
        with _ends_as_an_interrupt():
            text = work()
    except CurlshotError as error:
        bars.close()
        print(f"curlshot: {one_line(as_options(str(error)))}", file=sys.stderr)
        return 2
    except OSError as error:
        bars.close()
        where = f"{error.filename}: " if error.filename else ""
        print(f"curlshot: {where}{error.strerror or error}", file=sys.stderr)
        return 2
    except MemoryError:
        bars.close()
        print(f"curlshot: {NO_MEMORY}", file=sys.stderr)
        return 2
    except KeyboardInterrupt as stop:
        with suppress(OSError):  # a terminal that was closed takes no more
            bars.close()
            print("curlshot: stopped; unfinished output is not written", file=sys.stderr)
        return 128 + (stop.number if isinstance(stop, _Stopped) else signal.SIGINT)
    bars.close()
    try:
        print(as_options(text), flush=True)
    except BrokenPipeError:
        # The reader, such as head, has had enough; Python would complain again at its exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


class _Stopped(KeyboardInterrupt):
    """Stopped by a signal other than that of Ctrl-C."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


@contextmanager
def _ends_as_an_interrupt() -> Iterator[None]:
    """Let signals that ask to end unwind the work as Ctrl-C does, so that it is cleaned up.

    Those that are ignored, as under nohup, or that somebody else handles stay so.
    """
    taken = []
    if threading.current_thread() is threading.main_thread():
        numbers = [getattr(signal, name) for name in _ENDS if hasattr(signal, name)]
        taken = [n for n in numbers if signal.getsignal(n) is signal.SIG_DFL]

    def stop(number: int, _: FrameType | None) -> None:
        # A shell and its terminal both tell that they end; the second must not stop the cleaning.
        for n in taken:
            signal.signal(n, signal.SIG_IGN)
        raise _Stopped(number)

    for n in taken:
        signal.signal(n, stop)
    try:
        yield
    finally:
        for n in taken:
            signal.signal(n, signal.SIG_DFL)


def one_line(text: str) -> str:
    """Put a text on one line."""
    return " ".join(text.split())
