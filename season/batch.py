"""Runs of many clips, a folder for each; one that fails does not stop the others."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from curlshot.config import Config, with_settings
from curlshot.data.arguments import checked_path, checked_paths
from curlshot.data.errors import CurlshotError
from curlshot.data.files import check_folder
from curlshot.data.limits import JOBS
from curlshot.data.progress import Progress, no_progress
from curlshot.data.run_folders import apart
from curlshot.outcome import Run
from curlshot.pipeline import run


def run_each(
    clips: str | Path | Sequence[str | Path],
    out: str | Path,
    config: Config = Config(),
    progress: Progress = no_progress,
    jobs: int = 1,
    **settings: Any,
) -> tuple[dict[str, Run], dict[str, CurlshotError]]:
    """Run many clips, one folder of `out` for each.

    Parameters
    ----------
    clips : str or Path, or sequence of them
        Videos.
    out : str or Path
        Folder for their folders.
    config, **settings
        What is known of all of them, as for `curlshot.run`.
    progress : callable
        Called as the work goes on; with more than one job, after each clip.
    jobs : int
        Clips at once. With more than one, each has a process of its own. A script that asks for
        it must not do so where it is imported (``if __name__ == "__main__":``).

    Returns
    -------
    done : dict of str to Run
        By the names of their folders.
    failed : dict of str to CurlshotError
        Why the others could not be used.

    Examples
    --------
    >>> import curlshot
    >>> stones = (curlshot.StoneStart("A", 0.5, 1.0), curlshot.StoneStart("B", 0.0, 0.0))
    >>> table = curlshot.simulate(curlshot.Shot(stones)).sample([0.0, 0.1, 0.2, 0.3])
    >>> table.to_csv("still.csv")
    >>> done, failed = curlshot.run_each(["still.csv", "gone.mp4"], "season", overlay=False)
    >>> list(done), list(failed)
    (['still'], ['gone'])
    >>> print(failed["gone"])
    gone.mp4: no such file
    """
    config = with_settings(config, settings)
    JOBS.check("`jobs`", jobs)
    folder = check_folder(checked_path("out", out))
    once = {path.resolve(): path for path in map(Path, checked_paths("clips", clips))}
    tasks = {name: (clip, folder / name) for name, clip in apart([*once.values()]).items()}
    if min(jobs, len(tasks)) > 1:
        from curlshot.season.parallel import in_processes

        outcomes = in_processes(partial(_attempt, config), tasks, jobs, "clips", progress)
    else:
        outcomes = {
            name: _attempt(config, task, _numbered(progress, f"{number}/{len(tasks)} "))
            for number, (name, task) in enumerate(tasks.items(), 1)
        }
    done = {name: one for name, one in outcomes.items() if isinstance(one, Run)}
    failed = {name: one for name, one in outcomes.items() if isinstance(one, CurlshotError)}
    return done, failed


def _attempt(
    config: Config, task: tuple[Path, Path], progress: Progress = no_progress
) -> Run | CurlshotError:
    """Run a clip into a folder, or return why it could not be used."""
    clip, folder = task
    try:
        return run([clip], folder, config, progress)
    except CurlshotError as error:
        return error


def _numbered(progress: Progress, number: str) -> Progress:
    """Return a progress that names which of many clips it is."""

    def numbered(what: str, at: int, total: int | None) -> None:
        progress(number + what, at, total)

    return numbered
