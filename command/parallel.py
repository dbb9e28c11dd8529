"""Work that is done for many things at once, each in a process of its own."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing.process import BaseProcess
from types import FrameType
from typing import TypeVar

from command.garbage import collect_seldom
from data.progress import Progress, no_progress

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
    BrokenProcessPool
        Where a process ended by itself, as where a script has no ``__main__`` guard.
    Exception
        Whatever `work` raises; the others are stopped.
    """
    # A forked process may hang in libraries that had threads; a new one begins afresh.
    fresh = multiprocessing.get_context("spawn")
    workers = min(jobs, len(items), _MOST)
    others, own = {*multiprocessing.active_children()}, set[BaseProcess]()
    done: dict[str, Outcome] = {}
    pool = ProcessPoolExecutor(workers, mp_context=fresh, initializer=_begin, initargs=(_heeded(),))
    try:
        with _deaf():
            running: dict[Future[Outcome], str] = {
                pool.submit(partial(_interruptible, work), item): name
                for name, item in items.items()
            }
        own |= {*multiprocessing.active_children()} - others
        progress(what, 0, len(items))
        for future in as_completed(running):
            done[running[future]] = future.result()
            progress(what, len(done), len(items))
    except BaseException as stopped:
        for process in {*multiprocessing.active_children()} - others:
            process.terminate()
        pool.shutdown(cancel_futures=True)
        if isinstance(stopped, BrokenProcessPool) and _killed(own):
            raise MemoryError from stopped
        raise
    pool.shutdown()
    return {name: done[name] for name in items}


class _Here:
    """Of this process: whether it works on an item, was told to end, and lost the first one."""

    working = stopped = alone = False


def _killed(processes: Iterable[BaseProcess]) -> bool:
    """Tell whether one was killed, and did not fail by itself."""
    return any(process.exitcode == -_KILLED for process in processes)


def _heeded() -> list[int]:
    """Signals that end the work: of those of a terminal not what is ignored, as under nohup."""
    numbers = [getattr(signal, name) for name in _OF_A_TERMINAL if hasattr(signal, name)]
    return [signal.SIGTERM, *(n for n in numbers if signal.getsignal(n) != signal.SIG_IGN)]


def _begin(heeded: Iterable[int]) -> None:
    """Let signals that ask to end unwind the work, so that it is cleaned up."""
    for number in heeded:
        signal.signal(number, _stop)
    collect_seldom()
    threading.Thread(target=_end_with_the_first, daemon=True).start()


def _end_with_the_first() -> None:
    """End this process if the first one was killed, which tells nobody."""
    first = multiprocessing.parent_process()
    if first is not None:
        first.join()
    _Here.alone = True
    while True:  # once for the work, once for the process
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(1)


def _stop(_: int, __: FrameType | None) -> None:
    """Stop the work, once: a terminal and the first process both tell, and cleaning goes on.

    A process without work waits until the first one lets it go: it may hold the lock of the
    queue, without which no other ever ends.
    """
    again, _Here.stopped = _Here.stopped, True
    if _Here.working and not again:
        raise KeyboardInterrupt
    if _Here.alone and not _Here.working:
        raise SystemExit


def _interruptible(work: Callable[[Item], Outcome], item: Item) -> Outcome:
    """Do some work, unless this process was told to end: there may be more in its queue."""
    _Here.working = True
    try:
        if _Here.stopped:
            raise KeyboardInterrupt
        return work(item)
    finally:
        _Here.working = False


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
