"""How fast stones were at the lines and beside the hits, and what each hit took.

SI units throughout. What a clip cannot tell is NaN, and the column ``note`` says why.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from curlshot.data.results import Hit, MeasuredState
from curlshot.data.sheet import SHEET, STONE
from curlshot.physics.prediction.throws import STILL, thrown
from curlshot.report.tables.shot import moving_stones
from curlshot.report.tables.states import magnitude


def speed_table(
    tracks: pd.DataFrame, collisions: Sequence[Hit], radius: float = STONE.radius
) -> pd.DataFrame:
    """Speed of the thrown stone at the lines, and of every stone before and after its hits.

    Returns
    -------
    DataFrame
        ``stone, at, t, speed, sd, note``, m/s and s.
    """
    rows: list[dict[str, object]] = []
    for name in moving_stones(tracks, collisions, radius):
        track = tracks[tracks["stone"] == name].sort_values("t")
        hits = [(rank, hit) for rank, hit in enumerate(collisions, 1) if name in hit.stones]
        if thrown(track):
            side = 1.0 if float(track["vy"].head(5).mean()) <= 0 else -1.0
            for at, y in (("hog line", SHEET.hog_line), ("tee line", 0.0)):
                rows.append({"stone": name, "at": at, **_crossing(track, side * y, side)})
        for rank, hit in hits:
            for when, states in (("before", hit.before), ("after", hit.after)):
                if name in states:
                    speed, sd = _speed(states[name])
                    at = f"{when} hit {rank}"
                    rows.append({"stone": name, "at": at, "t": hit.t, "speed": speed, "sd": sd})
    return pd.DataFrame(rows, columns=["stone", "at", "t", "speed", "sd", "note"])


def takeout_table(collisions: Sequence[Hit]) -> pd.DataFrame:
    """Tell what each hit took from the stone that came and gave to the one that was struck.

    Returns
    -------
    DataFrame
        ``hit, t, stones, arrived, sd_arrived, left, sd_left, lost, sd_lost, share, struck,
        sd_struck``: speeds, m/s; `share` is the part of its speed that the first stone lost.
    """
    rows = []
    for rank, hit in enumerate(collisions, 1):
        first, second = hit.stones
        row: dict[str, object] = {"hit": rank, "t": hit.t, "stones": f"{first} on {second}"}
        if first in hit.before and first in hit.after and second in hit.after:
            (came, sd_came), (left, sd_left), (struck, sd_struck) = (
                _speed(hit.before[first]),
                _speed(hit.after[first]),
                _speed(hit.after[second]),
            )
            row |= {"arrived": came, "sd_arrived": sd_came, "left": left, "sd_left": sd_left}
            row |= {"lost": came - left, "sd_lost": float(np.hypot(sd_came, sd_left))}
            row |= {"share": (came - left) / came if came > STILL else np.nan}
            row |= {"struck": struck, "sd_struck": sd_struck}
        rows.append(row)
    speeds = ("arrived", "left", "lost", "struck")
    columns = ["hit", "t", "stones", *(n for s in speeds for n in (s, f"sd_{s}")), "share"]
    return pd.DataFrame(rows, columns=columns)


def _speed(state: MeasuredState) -> tuple[float, float]:
    speed, sd = magnitude(*np.array([state.vx, state.vy, state.sd_vx, state.sd_vy], float))
    return float(speed), float(sd)


def _crossing(track: pd.DataFrame, line: float, side: float) -> dict[str, object]:
    """Time and speed at which a stone that comes from `side` passes a line across the sheet."""
    t, y, vx, vy, sx, sy = track[["t", "y", "vx", "vy", "sd_vx", "sd_vy"]].to_numpy(float).T
    ahead = side * (y - line)
    if ahead[0] < 0:
        return {"note": f"first detected {abs(y[0] - line):.1f} m past it"}
    past = np.flatnonzero(ahead <= 0)
    if not len(past):
        return {"note": f"came no closer than {ahead.min():.1f} m in the measured interval"}
    k = max(int(past[0]), 1)
    share = ahead[k - 1] / max(ahead[k - 1] - ahead[k], 1e-12)
    speed, sd = magnitude(vx, vy, sx, sy)
    between = [float(a[k - 1] + share * (a[k] - a[k - 1])) for a in (t, speed, sd)]
    return dict(zip(("t", "speed", "sd"), between, strict=True))
