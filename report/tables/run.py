"""The hits, glides and stones of a run as tables for a notebook, with their units."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pandas as pd

from curlshot.data.column_units import with_units
from curlshot.data.results import Glide, Hit, Results
from curlshot.data.sheet import HOUSE, House
from curlshot.physics.statistics.season import closing_speed
from curlshot.report.tables.laws import ice_table
from curlshot.report.tables.rest import rest_table
from curlshot.report.tables.shot import hit_table, stone_table

_HIT = (
    "hit", "t", "stderr_t", "first", "second", "nx", "ny", "restitution", "stderr",
    "closing_speed", "momentum_residual", "stderr_momentum", "energy_lost", "stone_friction",
    "stderr_stone_friction", "note", "note_stone_friction",
)  # fmt: skip
_OF_TEE = ["to_tee", "sd_to_tee", "in_house", "lies", "beyond"]
_SEEN = ["stone", "t0", "t1", "frames", "seen", "path", "top_speed"]


def hits_of_run(results: Results) -> pd.DataFrame:
    """Return one row per hit, speeds along the normal in m/s; units in ``attrs``."""
    table = hit_table(results.collisions).reindex(columns=list(_HIT))
    table["closing_speed"] = [_closing(hit) for hit in results.collisions]
    texts = {"first", "second", "note", "note_stone_friction"}
    numbers = {name: float for name in _HIT if name not in texts | {"hit"}}
    return with_units(table.astype({"hit": int, **numbers}))


def _closing(hit: Hit) -> float:
    """Return the closing speed of a hit, m/s; NaN where a state before it is not known."""
    return closing_speed(hit) if set(hit.stones) <= set(hit.before) else np.nan


def glides_of_run(results: Results) -> pd.DataFrame:
    """Return one row per free glide: its friction, and how its path turned; units in ``attrs``."""
    columns = [item.name for item in fields(Glide)]
    table = pd.DataFrame([vars(glide) for glide in results.glides], columns=columns)
    return with_units(table.astype({name: float for name in columns if name != "stone"}))


def stones_of_run(results: Results, tracks: pd.DataFrame, house: House | None) -> pd.DataFrame:
    """Return one row per stone: when it was seen, where it rests and what its glides show.

    Without a house there is no distance from a tee. Units are in ``attrs``.
    """
    ice = ice_table(results).rename(columns={"speed": "mean_speed"})
    ice = ice.astype({name: float for name in ice.columns if name != "stone"})
    if tracks.empty:
        return with_units(ice)
    rest = rest_table(tracks, results.collisions, house or HOUSE, results.radius)
    if house is None:
        rest[_OF_TEE] = np.nan
    table = stone_table(tracks)[_SEEN].merge(rest, on="stone").merge(ice, on="stone", how="left")
    return with_units(table)
