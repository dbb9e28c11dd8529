"""Many shots side by side, and the mean of their e and μ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.data.files import check_folder, staged
from curlshot.data.version import VERSION

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.data.results import Results
    from curlshot.physics.statistics.pool import Pooled


@dataclass(frozen=True)
class Season:
    """What many shots show together.

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
    """

    shots: pd.DataFrame
    hits: pd.DataFrame
    means: dict[str, Pooled]
    left_out: dict[str, str]


def season(
    runs: Mapping[str, Results],
    out: str | Path | None = None,
    folders: Mapping[str, Path] | None = None,
    left_out: Mapping[str, str] | None = None,
) -> Season:
    """Put many shots side by side, and combine their e and μ.

    A shot that is there twice, as in a copied run, counts once
    (`curlshot.physics.statistics.season.repeated`).

    Parameters
    ----------
    runs : mapping of str to Results
        The shots by name.
    out : str or Path, optional
        Folder for the page, the tables and the figure; nothing is written without it.
    folders : mapping of str to Path, optional
        Where the reports of the shots are, for links from the page.
    left_out : mapping of str to str, optional
        Shots that are not among them, and why, for the page to list.

    Returns
    -------
    Season
    """
    from curlshot.physics.statistics.season import hits_table, pooled, repeated, shots_table

    folder = None if out is None else check_folder(out)
    again = repeated(runs)
    unused = {name: f"the same shot as {one}: counted once" for name, one in again.items()}
    unused |= left_out or {}
    runs = {name: run for name, run in runs.items() if name not in again}
    shots = shots_table(runs)
    together = Season(shots, hits_table(runs), pooled(shots), unused)
    if folder is not None:
        pages = {name: path / "report.html" for name, path in (folders or {}).items()}
        _write(together, folder, {name: page for name, page in pages.items() if name in runs})
    return together


def _write(together: Season, folder: Path, pages: Mapping[str, Path]) -> None:
    from curlshot.report.season import write_season
    from curlshot.report.season_page import season_page
    from curlshot.report.template import link

    page = season_page(
        folder.resolve().name,
        together.shots,
        together.hits,
        together.means,
        {name: link(path, folder) for name, path in pages.items() if path.exists()},
        together.left_out,
        VERSION,
    )
    with staged(folder) as stage:
        write_season(stage, together.shots, together.hits, together.means, page)
