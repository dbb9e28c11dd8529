"""Tables that a run wrote, read again: what was measured, not what a filter made of it."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.data.tracks import LENGTHS, MEASURED_AS

MOVED, FAR, SCATTERS = 0.02, 0.1, 6.0
"""How far from what was measured a filter leaves no stone's places on the whole, m, and none by
itself, m and in units of how far they usually are; who has changed them means them."""

FEW = 10
"""Places of a stone that say nothing on the whole."""


def as_measured(tracks: pd.DataFrame, source: str) -> tuple[pd.DataFrame, list[str]]:
    """Take what was measured for what a filter made of it, where a run has written both.

    The filter's places are alike from row to row, and what is estimated from them is less sure
    than it says. Where somebody has moved, turned or added places, these count.

    Parameters
    ----------
    tracks : DataFrame
        ``stone, x, y`` (m), and what else there is of `curlshot.data.tracks.TRACK_COLUMNS` and
        `MEASURED_AS` (m, rad); all with a place.
    source : str
        What to call the table in warnings.

    Returns
    -------
    tracks : DataFrame
        Without ``seen`` and the columns of `MEASURED_AS`, and without rows that a filter carried.
    warnings : list of str
    """
    told = {name: column for name, column in MEASURED_AS.items() if name in tracks}
    filtered = tracks.drop(columns=["seen", *told], errors="ignore")
    if "seen" not in tracks:
        tracks = tracks.assign(seen=tracks.get("meas_x", tracks["x"]).notna())
    shown = tracks["seen"] != 0
    if "meas_x" not in told or "meas_y" not in told:
        return filtered[shown], []
    off = tracks[["x", "y"]] - tracks[["meas_x", "meas_y"]].to_numpy()
    stones = off[shown & off.notna().all(axis=1)].groupby(tracks["stone"])
    if (stones.median()[stones.size() >= FEW].abs() > MOVED).any(axis=None):
        return filtered[shown], [
            f"{source}: x and y differ from meas_x and meas_y; read as edited, and meas_x and"
            " meas_y are left out"
        ]
    away = pd.Series(np.hypot(off["x"], off["y"]), off.index)
    alone = away.isna()
    edited = away > max(FAR, SCATTERS * float(np.nan_to_num(away[shown].median())))
    own = shown & (alone | edited)
    measured = tracks[list(told)].rename(columns=told)
    for name in filtered.columns.intersection(measured.columns):
        measured.loc[own, name] = filtered.loc[own, name]
    kept = filtered.drop(columns=[*LENGTHS, *told.values()], errors="ignore").assign(**measured)
    count = int((shown & edited).sum())
    notes = [f"{source}: {count} places differ from the measured ones; read as edited"]
    return kept[own | ~alone], notes if count else []
