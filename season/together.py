"""Many shots side by side, and the mean of their e and μ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.data.arguments import check_type, checked_path, checked_paths
from curlshot.data.files import staged
from curlshot.data.messages import as_options
from curlshot.data.results import Results
from curlshot.data.run_folders import apart, find_results, read_runs, season_folder
from curlshot.data.version import VERSION
from curlshot.outcome import Run

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.physics.statistics.pool import Pooled


@dataclass(frozen=True, repr=False, eq=False)
class Season:
    """What many shots show together; it prints a line per shot, then e and μ of all.

    Attributes
    ----------
    shots : DataFrame
        One row per shot; see `curlshot.physics.statistics.season.shots_table`.
    hits : DataFrame
        One row per hit; see `curlshot.physics.statistics.season.hits_table`.
    means : dict
        ``restitution`` and ``friction``; see `curlshot.physics.statistics.pool.Pooled`.
    left_out : dict of str to str
        Shots that do not count, and why.

    Examples
    --------
    >>> import curlshot
    >>> stones = (curlshot.StoneStart("A", 0.5, 1.0), curlshot.StoneStart("B", 0.0, 0.0))
    >>> table = curlshot.simulate(curlshot.Shot(stones)).sample([0.0, 0.1, 0.2, 0.3])
    >>> table.to_csv("still.csv")
    >>> run = curlshot.run("still.csv")
    >>> season = curlshot.combine({"first": run})
    >>> season.shots["shot"].tolist(), season.means["friction"].shots
    (['first'], 0)
    """

    shots: pd.DataFrame
    hits: pd.DataFrame
    means: dict[str, Pooled]
    left_out: dict[str, str]

    def summary(self) -> str:
        """Return what the command prints: a line per shot, then e and μ of all together."""
        from curlshot.report.summary import season_text

        lines = season_text(self.shots, self.means)
        return "\n".join([*lines, *(f"{name}   {why}" for name, why in self.left_out.items())])

    def __repr__(self) -> str:
        return self.summary()


def combine(
    runs: str | Path | Run | Sequence[str | Path] | Sequence[Run] | Mapping[str, Run | Results],
    out: str | Path | None = None,
    left_out: Mapping[str, str] | None = None,
) -> Season:
    """Put many shots side by side, and combine their e and μ.

    A shot that is there twice, as in a copied run, counts once
    (`curlshot.physics.statistics.season.repeated`).

    Parameters
    ----------
    runs : str, Path or Run, sequence of them, or mapping of str to Run or Results
        Folders of runs, or folders of such folders; or the runs, also by name, as `run_each` has
        them. Runs without a name are named by their folders, else by their inputs.
    out : str or Path, optional
        Folder for the page, the tables and the figure; nothing is written without it.
    left_out : mapping of str to str, optional
        Shots that are not among them, and why, for the page to list.

    Returns
    -------
    Season

    Raises
    ------
    curlshot.data.errors.InputError
        Where there is no run, or `out` cannot be written or holds a run itself.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import curlshot
    >>> stones = (curlshot.StoneStart("A", 0.5, 1.0), curlshot.StoneStart("B", 0.0, 0.0))
    >>> table = curlshot.simulate(curlshot.Shot(stones)).sample([0.0, 0.1, 0.2, 0.3])
    >>> table.to_csv("still.csv")
    >>> run = curlshot.run("still.csv")
    >>> measured = [curlshot.Estimate(0.82, 0.02), curlshot.Estimate(0.85, 0.01)]
    >>> one, two = (replace(run.results, restitution=e, glides=(0,)) for e in measured)
    >>> e = curlshot.combine({"one": one, "two": two}).means["restitution"]
    >>> f"{e.value:.3f} of {e.shots} shots"
    '0.838 of 2 shots'
    """
    from curlshot.physics.statistics.season import hits_table, pooled, repeated, shots_table

    folder = None if out is None else season_folder(checked_path("out", out))
    if isinstance(runs, Run):
        runs = [runs]
    if isinstance(runs, Sequence) and runs and all(isinstance(one, Run) for one in runs):
        runs = _by_name([one for one in runs if isinstance(one, Run)])
    if isinstance(runs, Mapping):
        for one in runs.values():
            check_type("`runs`", one, (Run, Results), "a Run or its Results")
        shots = {name: one.results if isinstance(one, Run) else one for name, one in runs.items()}
        places = {n: one.out for n, one in runs.items() if isinstance(one, Run) and one.out}
    else:
        files = find_results(checked_paths("runs", runs))
        shots, places = read_runs(files), {name: file.parent for name, file in files.items()}
    again = repeated(shots)
    unused = {name: f"the same shot as {one}: counted once" for name, one in again.items()}
    unused |= left_out or {}
    shots = {name: one for name, one in shots.items() if name not in again}
    table = shots_table(shots)
    together = Season(table, hits_table(shots), pooled(table), unused)
    if folder is not None:
        pages = {name: path / "report.html" for name, path in places.items() if name in shots}
        _write(together, folder, pages)
    return together


def _by_name(runs: Sequence[Run]) -> dict[str, Run]:
    """Return runs by the names of their folders, or of their inputs where nothing is written."""
    places = [
        Path(next(iter(run.results.input.files), "shot"))
        if run.out is None
        else run.out.resolve().with_name(f"{run.out.resolve().name}.run")
        for run in runs
    ]
    return dict(zip(apart(places), runs, strict=True))


def _write(together: Season, folder: Path, pages: Mapping[str, Path]) -> None:
    from curlshot.report.season import write_season
    from curlshot.report.season_page import season_page
    from curlshot.report.template import link

    shots, hits = (
        table.assign(note=table["note"].map(as_options, na_action="ignore"))
        for table in (together.shots, together.hits)
    )
    page = season_page(
        folder.resolve().name,
        shots,
        hits,
        together.means,
        {name: link(path, folder) for name, path in pages.items() if path.exists()},
        {name: as_options(why) for name, why in together.left_out.items()},
        VERSION,
    )
    with staged(folder) as stage:
        write_season(stage, shots, hits, together.means, page)
