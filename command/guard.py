"""What becomes of the work on the terminal: its text, or one line that says what is wrong."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable

from command.bars import Bars
from data.errors import CurlshotError


def guarded(work: Callable[[], str], bars: Bars) -> int:
    """Do some work and print its text; returns the exit code (0 well, 2 a person's mistake)."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without Greek letters gets "?"
    try:
        text = work()
    except CurlshotError as error:
        bars.close()
        print(f"curlshot: {one_line(str(error))}", file=sys.stderr)
        return 2
    except OSError as error:
        bars.close()
        where = f"{error.filename}: " if error.filename else ""
        print(f"curlshot: {where}{error.strerror or error}", file=sys.stderr)
        return 2
    except MemoryError:
        bars.close()
        print("curlshot: not enough memory; try fewer or smaller pictures", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        bars.close()
        print("curlshot: stopped; what was under way is not written", file=sys.stderr)
        return 130
    bars.close()
    try:
        print(text, flush=True)
    except BrokenPipeError:
        # The reader, such as head, has had enough; Python would complain again at its exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


def one_line(text: str) -> str:
    """Put a text on one line."""
    return " ".join(text.split())
