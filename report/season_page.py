"""The page of a season: what all shots say together, and each of them to look at."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from markupsafe import escape

from curlshot.physics.statistics.pool import Pooled
from curlshot.physics.statistics.season import SCATTER
from curlshot.report.columns import Column, Table
from curlshot.report.summary import impossible
from curlshot.report.template import environment, source

_SHOTS = (
    Column("shot", "shot", kind="word"),
    Column("hits", "hits", decimals=0),
    Column("e", "restitution", stderr="stderr_restitution"),
    Column("μ", "friction", stderr="stderr_friction"),
    Column("law of the ice", "law", kind="word"),
    Column("warnings", "warnings", decimals=0),
    Column("why not", "note", kind="note"),
)
_HITS = (
    Column("shot", "shot", kind="word"),
    Column("time", "t", "s", decimals=2),
    Column("stones", "stones", kind="word"),
    Column("closing speed", "closing_speed", "m/s", decimals=3),
    Column("e", "restitution", stderr="stderr"),
    Column("momentum missing", "momentum_residual", stderr="stderr_momentum"),
    Column("energy lost", "energy_lost", "%", decimals=0, factor=100),
    Column("note", "note", kind="note"),
)


def season_page(
    title: str,
    shots: pd.DataFrame,
    hits: pd.DataFrame,
    pooled: Mapping[str, Pooled],
    pages: Mapping[str, str],
    left_out: Mapping[str, str],
    version: str,
) -> str:
    """Write the page of a season.

    Parameters
    ----------
    title : str
        Its heading.
    shots, hits : DataFrame
        From `curlshot.physics.statistics.season.shots_table` and `hits_table`.
    pooled : mapping
        From `curlshot.physics.statistics.season.pooled`.
    pages : mapping of str to str
        Addresses of the shots' own reports, of those that have one.
    left_out : mapping of str to str
        Shots that do not count, and why.
    version : str
        Of this program.
    """
    stones = hits["first"].astype(str) + " on " + hits["second"].astype(str)
    tables = (
        Table("shots", "Shots", "Click on a column head to sort.", _SHOTS, shots),
        Table("hits", "Hits", "", _HITS, hits.assign(stones=stones)),
    )
    return (
        environment()
        .get_template("season.html")
        .render(
            title=title,
            shots=len(shots),
            hits=len(hits),
            pooled=pooled,
            assumed_scatter=SCATTER,
            cautions=[*impossible(shots), *(f"{name}: {why}" for name, why in left_out.items())],
            tables=[table for table in tables if len(table.frame)],
            # A cell of the table is escaped.
            links={escape(name): address for name, address in pages.items()},
            version=version,
            css=source("page.css"),
            script=source("sort.js"),
        )
    )
