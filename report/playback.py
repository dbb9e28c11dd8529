"""What the page's player and what-if are made of: plain values, compact enough to embed.

Lists of numbers are rounded to whole steps and given by their differences, which are small.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from curlshot.data.results import Results
from curlshot.data.sheet import SHEET, House
from curlshot.report.style import stone_colours, team_colour
from curlshot.report.tables import play

STEPS: Mapping[str, float] = {
    "t": 1e-5, "x": 1e-4, "y": 1e-4, "theta": 1e-3, "speed": 1e-4, "omega": 1e-3,
}  # fmt: skip
"""What a column is rounded to: s, m, rad, m/s and rad/s."""

AT_REST = 1e-3
"""m; a simulated stone that stays this close to where it was needs one row only."""


def playback(
    results: Results,
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
    house: House | None,
) -> dict[str, Any]:
    """Give what the player shows, as values that JSON knows.

    Parameters
    ----------
    results : Results
        What the run found out.
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`.
    simulations : mapping of str to DataFrame
        Sampled simulation of each model.
    house : House or None
        Rings and lines of the plan view.

    Returns
    -------
    dict
        ``radius, rings, lines, steps, frame, t, stones, hits, simulations``: `frame` and `t`
        of all frames, and per stone the rank of its rows among them, and its columns in
        whole `steps`, each by the differences of one row to the next.
    """
    clock = tracks.groupby("frame", sort=True)["t"].first()
    ranks = {int(frame): rank for rank, frame in enumerate(clock.index)}
    colours = stone_colours(tracks["stone"].unique())
    stones = [
        {
            "name": str(name),
            "colour": colours[str(name)],
            "team": team_colour(group["team"].iloc[0]),
            **_columns(group, ranks),
        }
        for name, group in tracks.sort_values("frame").groupby("stone", sort=True)
    ]
    way = play(tracks, results.collisions, results.radius)
    return {
        "radius": results.radius,
        "rings": [] if house is None else list(asdict(house).values()),
        "lines": {} if house is None else asdict(SHEET) | {"play": way},
        "steps": dict(STEPS),
        "frame": _differences(clock.index),
        "t": differences(clock, "t"),
        "stones": stones,
        "hits": [
            {"t": hit.t, "stones": list(hit.stones), **_contact(results, rank)}
            for rank, hit in enumerate(results.collisions)
        ],
        "simulations": {
            model: [
                {"name": str(name), **_columns(_moving(group), ranks)}
                for name, group in table.sort_values("frame").groupby("stone", sort=True)
            ]
            for model, table in simulations.items()
        },
    }


def differences(values: ArrayLike, column: str) -> list[int]:
    """Give a column in whole steps: the first value, then from each to the next.

    What is not known counts as the value before it, at first as 0.
    """
    known = pd.Series(np.asarray(values, float)).ffill().fillna(0.0)
    return _differences(np.round(known / STEPS[column]))


def _differences(values: ArrayLike) -> list[int]:
    whole = np.asarray(values).astype(np.int64)
    return np.diff(whole, prepend=0).tolist()  # type: ignore[no-any-return]


def _columns(rows: pd.DataFrame, ranks: Mapping[int, int]) -> dict[str, Any]:
    speed = np.hypot(rows["vx"], rows["vy"])
    out: dict[str, Any] = {"at": _differences([ranks[int(frame)] for frame in rows["frame"]])}
    for name in ("x", "y", "theta", "omega"):
        out[name] = differences(rows[name], name)
    out["speed"] = differences(speed, "speed")
    out["turns"] = bool(rows["theta"].notna().any())
    return out


def _moving(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of a simulated stone; the first alone if it never moves."""
    places = rows[["x", "y"]].to_numpy(float)
    return rows if np.ptp(places, axis=0).max() > AT_REST else rows.iloc[:1]


def _contact(results: Results, rank: int) -> dict[str, float | None]:
    hit = results.collisions[rank]
    state = hit.before.get(hit.stones[0])
    if state is None:
        return {"x": None, "y": None}
    nx, ny = hit.normal
    return {"x": state.x + results.radius * nx, "y": state.y + results.radius * ny}
