"""The tables for coaches, in metres or feet."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from curlshot.data.coach_units import METRES, Unit
from curlshot.data.results import Results
from curlshot.data.sheet import House
from curlshot.report import tables
from curlshot.report.columns import Column, Table


def coach_tables(
    results: Results, tracks: pd.DataFrame, house: House, unit: Unit = METRES
) -> list[Table]:
    """Give the tables for coaches: who lies shot and how stones got there, in m or feet."""
    hits, radius = results.collisions, results.radius
    rest = tables.rest_table(tracks, hits, house, radius)
    return [
        _stones(rest, unit),
        _speeds(tables.speed_table(tracks, hits, radius), unit),
        _hits(tables.takeout_table(hits), unit),
        _distances(tables.distance_table(rest), unit),
    ]


def _stones(rest: pd.DataFrame, unit: Unit) -> Table:
    shot, why = tables.shot_stone(rest)
    lies = f"Shot stone: {shot} ({why})." if shot else f"Shot stone: not known, {why}."
    length: dict[str, Any] = {"unit": unit.symbol, "factor": unit.per_metre, "decimals": 3}
    return Table(
        "coach_stones",
        "Where the stones stopped",
        f"{lies} Centres of the stones, from the tee; rotations counter-clockwise; curl of the"
        " thrown stone, to the left of its initial heading.",
        (
            Column("stone", "stone", kind="word"),
            Column("team", "team", kind="note"),
            Column("lies", "lies", decimals=0),
            Column("from the tee", "to_tee", stderr="sd_to_tee", **length),
            Column("x", "x", stderr="sd_x", **length),
            Column("y", "y", stderr="sd_y", **length),
            Column("turns", "turns", stderr="sd_turns", decimals=3),
            Column("curl", "curl", stderr="sd_curl", **length),
            Column("note", "note", kind="note", lengths=unit),
        ),
        rest,
    )


def _speeds(speeds: pd.DataFrame, unit: Unit) -> Table:
    return Table(
        "coach_speeds",
        "Speeds at the hog lines and the tee",
        "",
        (
            Column("stone", "stone", kind="word"),
            Column("at", "at", kind="word"),
            Column("time", "t", "s", decimals=2),
            Column("speed", "speed", stderr="sd", **_speed(unit)),
            Column("note", "note", kind="note", lengths=unit),
        ),
        speeds,
    )


def _hits(takeouts: pd.DataFrame, unit: Unit) -> Table:
    speed = _speed(unit)
    return Table(
        "coach_hits",
        "Speeds before and after each hit",
        "The first stone arrives and goes on, the second one is hit.",
        (
            Column("hit", "hit", kind="word"),
            Column("stones", "stones", kind="word"),
            Column("arrives at", "arrived", stderr="sd_arrived", **speed),
            Column("goes on at", "left", stderr="sd_left", **speed),
            Column("loses", "lost", stderr="sd_lost", **speed),
            Column("of its speed", "share", "%", decimals=0, factor=100),
            Column("hit stone leaves at", "struck", stderr="sd_struck", **speed),
        ),
        takeouts,
    )


def _distances(apart: pd.DataFrame, unit: Unit) -> Table:
    errors = [str(name) for name in apart.columns if str(name).startswith("sd_")]
    worst = apart[errors].to_numpy(float)
    worst = worst[np.isfinite(worst)]
    within = f", each ± {unit.little(float(worst.max()))} or less" if len(worst) else ""
    names = {name.removeprefix("sd_"): name.removeprefix("sd_") for name in errors}
    names |= {"tee": "to the tee"}
    return Table(
        "coach_distances",
        "Distances between stones",
        f"From centre to centre{within}.",
        (
            Column("stone", "stone", kind="word"),
            *(
                Column(head, name, unit.symbol, decimals=unit.decimals, factor=unit.per_metre)
                for name, head in names.items()
            ),
        ),
        apart,
    )


def _speed(unit: Unit) -> dict[str, Any]:
    """How a column of speeds is written."""
    return {"unit": f"{unit.symbol}/s", "factor": unit.per_metre, "decimals": 3}
