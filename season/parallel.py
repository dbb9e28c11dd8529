"""Work that is done for many things at once, each in a process of its own."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from types import FrameType
from typing import Any, TypeVar

from curlshot.data.garbage import collect_seldom
from curlshot.data.progress import Progress, no_progress

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")

_OF_A_TERMINAL = ("SIGINT", "SIGHUP")
"""Signals of a terminal that ask to end, where the platform has them."""

_KILLED = 9
"""The signal by which a system ends a process when memory runs out."""

_MOST = 61 if sys.platform == "win32" else sys.maxsize
"""Processes at once: for so many Windows can wait."""


def processors() -> int:
    """Tell how many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def in_processes(
    work: Callable[[Item], Outcome],
    items: Mapping[str, Item],
    jobs: int,
    what: str,
    progress: Progress = no_progress,
) -> dict[str, Outcome]:
    """Do some work for each of many items, so many at once.

    Parameters
    ----------
    work : callable
        Takes an item; like the items and what becomes of them it can be pickled.
    items : mapping of str to object
        By name.
    jobs : int
        Processes at most.
    what : str
        What the items are, for `progress`.
    progress : callable
        Called when one more is done.

    Returns
    -------
    dict
        What became of each item, in their order.

    Raises
    ------
    MemoryError
        Where a process was killed, as systems do that run out of memory.
    RuntimeError
        Where a process ended by itself, as where a script has no ``__main__`` guard.
    Exception
        Whatever `work` raises; the others are stopped, and have cleaned up.
    """
    # A forked process may hang in libraries that had threads; a new one begins afresh.
    fresh = multiprocessing.get_context("spawn")
    waiting, heeded, most = deque(items), _heeded(), min(jobs, _MOST)
    running: dict[Connection, tuple[str, SpawnProcess]] = {}
    done: dict[str, Outcome] = {}
    progress(what, 0, len(items))
    try:
        while waiting or running:
            while waiting and len(running) < most:
                name = waiting.popleft()
                end, its_end = fresh.Pipe(duplex=False)
                process = fresh.Process(target=_begin, args=(its_end, heeded, work, items[name]))
                with _deaf():
                    process.start()
                    running[end] = name, process
                its_end.close()  # its process has the only one, whose death is an end of file
            ready = wait(list(running))
            for end in [one for one in running if one in ready]:
                name, process = running.pop(end)
                done[name] = _outcome(end, process)
                progress(what, len(done), len(items))
    finally:
        for end, (_, process) in running.items():
            process.terminate()
            end.close()  # nobody waits for its outcome any more
        for _, process in running.values():
            process.join()
    return {name: done[name] for name in items}


def _outcome(end: Connection, process: SpawnProcess) -> Any:
    """Return what became of an item, or raise what its work raised."""
    try:
        failed, outcome = end.recv()
    except (EOFError, OSError):
        process.join()
        if process.exitcode == -_KILLED:
            raise MemoryError from None
        raise RuntimeError("a process ended before its work was complete") from None
    finally:
        end.close()
    process.join()
    if failed:
        raise outcome
    return outcome


def _heeded() -> list[int]:
    """Signals that end the work: of those of a terminal not what is ignored, as under nohup."""
    numbers = [getattr(signal, name) for name in _OF_A_TERMINAL if hasattr(signal, name)]
    return [signal.SIGTERM, *(n for n in numbers if signal.getsignal(n) != signal.SIG_IGN)]


class _Here:
    """Of this process: whether it was told to end."""

    stopped = False


def _begin(
    end: Connection, heeded: Iterable[int], work: Callable[[Item], object], item: Item
) -> None:
    """Work on an item and send what becomes of it, in a process that signals unwind."""
    for number in heeded:
        signal.signal(number, _stop)
    collect_seldom()
    threading.Thread(target=_end_with_the_first, daemon=True).start()
    try:
        try:
            outcome = False, work(item)
        except BaseException as error:
            error.add_note(traceback.format_exc())
            outcome = True, error
        end.send(outcome)
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(1)  # nobody waits for it any more


def _end_with_the_first() -> None:
    """End this process if the first one was killed, which tells nobody."""
    first = multiprocessing.parent_process()
    if first is not None:
        first.join()
    os.kill(os.getpid(), signal.SIGTERM)


def _stop(_: int, __: FrameType | None) -> None:
    """Stop the work, once: a terminal and the first process both tell, and cleaning goes on."""
    again, _Here.stopped = _Here.stopped, True
    if not again:
        raise KeyboardInterrupt


@contextmanager
def _deaf() -> Iterator[None]:
    """Begin processes to which Ctrl-C means nothing, until `_begin` says what it does."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
