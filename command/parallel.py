"""Work that is done for many things at once, each in a process of its own."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from threading import Event
from typing import TypeVar

from command.garbage import collect_seldom
from data.progress import Progress, no_progress

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")


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
    Exception
        Whatever `work` raises; the others are stopped.
    """
    # A forked process may hang in libraries that had threads; a new one begins afresh.
    fresh = multiprocessing.get_context("spawn")
    workers = min(jobs, len(items))
    with ProcessPoolExecutor(workers, mp_context=fresh, initializer=_begin) as pool:
        running: dict[Future[Outcome], str] = {
            pool.submit(partial(_interruptible, work), item): name for name, item in items.items()
        }
        progress(what, 0, len(items))
        done: dict[str, Outcome] = {}
        try:
            for future in as_completed(running):
                done[running[future]] = future.result()
                progress(what, len(done), len(items))
        except BaseException as stopped:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in multiprocessing.active_children():
                process.terminate()
            if isinstance(stopped, BrokenProcessPool):
                raise MemoryError from stopped
            raise
    return {name: done[name] for name in items}


def _begin() -> None:
    """Leave it to the first process what becomes of Ctrl-C while there is no work."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    collect_seldom()


_STOPPED = Event()
"""Whether this process was told to end: there may be more work in its queue."""


def _interruptible(work: Callable[[Item], Outcome], item: Item) -> Outcome:
    """Do some work that Ctrl-C, or being told to end, unwinds, so that it is cleaned up."""
    if _STOPPED.is_set():
        raise KeyboardInterrupt
    handled = signal.SIGINT, signal.SIGTERM
    before = [signal.signal(number, signal.default_int_handler) for number in handled]
    try:
        return work(item)
    except KeyboardInterrupt:
        _STOPPED.set()
        raise
    finally:
        for number, handler in zip(handled, before, strict=True):
            signal.signal(number, handler)
