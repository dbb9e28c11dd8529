"""Where stones came to rest, how they got there, and who lies shot.

SI units throughout. What a clip cannot tell is NaN, and the column ``note`` says why.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from curlshot.data.results import Hit
from curlshot.data.sheet import HOUSE, STONE, House
from curlshot.physics.prediction.throws import STILL, thrown
from curlshot.report.tables.shot import moving_stones
from curlshot.report.tables.states import magnitude
from curlshot.report.tables.teams import team_names

LAST = 0.25
"""The last seconds of a track that tell whether its stone has stopped."""

UNSEEN = 0.5
"""Time by which a track may end before the clip does and still tell where its stone is, s."""

HEADING = 0.5
"""The first seconds of a track that tell where its stone was heading."""

POOR_CURL = 0.1
"""Standard error of a curl from which on it is not told, m."""


def rest_table(
    tracks: pd.DataFrame,
    collisions: Sequence[Hit] = (),
    house: House = HOUSE,
    radius: float = STONE.radius,
) -> pd.DataFrame:
    """Tell how each stone turned and curled, where it stopped, and how near to the tee.

    Returns
    -------
    DataFrame
        ``stone, team, turns, sd_turns, curl, sd_curl, x, y, sd_x, sd_y, to_tee, sd_to_tee,
        in_house, lies, beyond, note``: whole turns, counter-clockwise positive; `curl` to the left
        of where it was heading, until its first hit; places and distances of the centre from the
        tee, m; `in_house` 1 or 0, NaN where unknown; `lies` 1 for shot stone, 2 for the next, NaN
        outside of the house; `beyond` how far from the tee a stone was that still moved away from
        it when it was last seen, m, else NaN. ``team`` is None where the tracks do not have it.
    """
    end, reach = float(tracks["t"].max()), house.twelve_foot + radius
    moved, team = moving_stones(tracks, collisions, radius), team_names(tracks)
    rows = []
    for name, group in tracks.groupby("stone", sort=True):
        track = group.sort_values("t")
        notes: list[str] = []
        row: dict[str, object] = {"stone": str(name), "team": team[str(name)]}
        if name in moved:
            row |= _turns(track, notes)
            hits = [hit.t for hit in collisions if name in hit.stones]
            if thrown(track):
                row |= _curl(track[track["t"] < min(hits, default=np.inf)], notes)
        else:
            notes.append("did not move")
        why_not = _moving(track, end)
        if why_not is None:
            row |= _place(track)
            row["in_house"] = float(np.hypot(*track[["x", "y"]].iloc[-1]) < reach)
        else:
            notes.append(why_not)
            away = _away(track)
            row["beyond"] = away
            row["in_house"] = 0.0 if away > reach else np.nan
        row["note"] = "; ".join(notes) or None
        rows.append(row)
    columns = [
        *("stone", "team", "turns", "sd_turns", "curl", "sd_curl"),
        *("x", "y", "sd_x", "sd_y", "to_tee", "sd_to_tee", "in_house", "lies", "beyond", "note"),
    ]
    table = pd.DataFrame(rows, columns=columns)
    inside = table.loc[table["in_house"] == 1, "to_tee"]
    table["lies"] = inside.rank(method="first").reindex(table.index)
    return table


def distance_table(rest: pd.DataFrame) -> pd.DataFrame:
    """Distances of the centres of the stones from the tee and from each other, m.

    Parameters
    ----------
    rest : DataFrame
        As `rest_table` gives it.

    Returns
    -------
    DataFrame
        ``stone, tee`` and a column for each stone, then their standard errors, ``sd_`` before the
        name; only stones whose place is known.
    """
    known = rest[rest["x"].notna()]
    xy, sd = (known[list(names)].to_numpy(float) for names in (("x", "y"), ("sd_x", "sd_y")))
    # The tee is known exactly; it stands before the stones.
    xy, sd = (np.vstack([np.zeros(2), places]) for places in (xy, sd))
    apart, error = magnitude(
        *(xy[1:, None] - xy[None]).transpose(2, 0, 1),
        *np.hypot(sd[1:, None], sd[None]).transpose(2, 0, 1),
    )
    own = np.arange(len(known))
    apart[own, own + 1] = error[own, own + 1] = np.nan
    names = [str(name) for name in known["stone"]]
    columns = ["tee", *(f"to {name}" for name in names)]
    table = pd.DataFrame(apart, columns=columns)
    table[[f"sd_{name}" for name in columns]] = error
    table.insert(0, "stone", names)
    return table


def shot_stone(rest: pd.DataFrame) -> tuple[str | None, str]:
    """Tell who lies shot.

    Parameters
    ----------
    rest : DataFrame
        As `rest_table` gives it.

    Returns
    -------
    name : str or None
        The stone nearest to the tee, None where that cannot be told. One that still moves away from
        the tee, and is farther from it, does not matter.
    reason : str
        How many stones of its team count, where teams are known; else why it cannot be told.
    """
    inside = rest[rest["lies"].notna()].sort_values("lies")
    unknown = rest[rest["in_house"].isna()]
    names = ", ".join(unknown["stone"])
    nearest = inside["to_tee"].min() + 2 * inside["sd_to_tee"].max()
    if len(unknown) and not (unknown["beyond"] > nearest).all():
        return None, f"the last places of {names} are unknown"
    if inside.empty:
        return None, "no stone is in the house"
    if len(inside) > 1:
        near, far = inside.iloc[0], inside.iloc[1]
        error = float(np.hypot(near["sd_to_tee"], far["sd_to_tee"]))
        if far["to_tee"] - near["to_tee"] < 2 * error and _rivals(near["team"], far["team"]):
            return None, f"{near['stone']} and {far['stone']} are too close to separate"
    best = inside.iloc[0]
    if len(unknown):
        return str(best["stone"]), f"{names} still moved, farther from the tee and away from it"
    if best["team"] is None:
        return str(best["stone"]), "the teams are unknown"
    others = (inside["team"] != best["team"]).to_numpy()
    count = int(np.argmax(others)) if others.any() else len(others)
    return str(best["stone"]), f"{best['team']} lies {count}"


def _rivals(one: object, two: object) -> bool:
    return one is None or two is None or one != two


def _turns(track: pd.DataFrame, notes: list[str]) -> dict[str, object]:
    seen = track[track["theta"].notna()]
    if len(seen) < 2:
        notes.append("its rotation was not measured")
        return {}
    theta, sd = seen[["theta", "sd_theta"]].to_numpy(float).T
    error = float(np.hypot(sd[0], sd[-1])) / (2 * np.pi)
    return {"turns": float(theta[-1] - theta[0]) / (2 * np.pi), "sd_turns": error}


def _curl(track: pd.DataFrame, notes: list[str]) -> dict[str, object]:
    """Distance by which a stone came to lie left of the line on which it set out."""
    early = track[track["t"] <= track["t"].iloc[0] + HEADING] if len(track) else track
    if len(early) < 3:
        notes.append("curl: measured too briefly before its hit")
        return {}
    heading = early[["vx", "vy"]].to_numpy(float).mean(axis=0)
    speed = float(np.hypot(*heading))
    ux, uy = heading / speed
    dx, dy = (track[["x", "y"]].iloc[-1] - track[["x", "y"]].iloc[0]).to_numpy(float)
    # Neighbours in a smoothed track share their error: the mean is no better than one of them.
    turn = float(early[["sd_vx", "sd_vy"]].to_numpy(float).mean()) / speed
    place = float(track[["sd_x", "sd_y"]].iloc[[0, -1]].to_numpy(float).mean())
    error = float(np.hypot(turn * np.hypot(dx, dy), np.sqrt(2) * place))
    if not error < POOR_CURL:
        notes.append(f"curl: a path of {np.hypot(dx, dy):.1f} m is too short")
        return {}
    # The mean velocity of the first seconds is that of their middle.
    return {"curl": float(ux * dy - uy * dx), "sd_curl": error}


def last_speed(track: pd.DataFrame) -> float:
    """Speed at which a stone goes on where its track ends, m/s; 0 where it has stopped."""
    late = track[track["t"] >= track["t"].iloc[-1] - LAST]
    speed = float(np.hypot(late["vx"], late["vy"]).median())
    return speed if speed > STILL else 0.0


def _moving(track: pd.DataFrame, end: float) -> str | None:
    """Why it is not known where a stone stopped; None where it is."""
    speed = last_speed(track)
    if not speed:
        return None
    when = float(track["t"].iloc[-1])
    if end - when > UNSEEN:
        return f"out of sight after {when:.1f} s, at {speed:.2f} m/s"
    return f"still moving at {speed:.2f} m/s at the end of the clip"


def _away(track: pd.DataFrame) -> float:
    """How far from the tee a stone was last seen that moves away from it, m; NaN if it does not."""
    x, y, vx, vy = track[["x", "y", "vx", "vy"]].iloc[-1].to_numpy(float)
    return float(np.hypot(x, y)) if x * vx + y * vy > 0 else float("nan")


def _place(track: pd.DataFrame) -> dict[str, object]:
    place = track[["x", "y", "sd_x", "sd_y"]].iloc[-1].to_numpy(float)
    distance, error = magnitude(*place)
    names = ("x", "y", "sd_x", "sd_y", "to_tee", "sd_to_tee")
    return dict(zip(names, (*place.tolist(), float(distance), float(error)), strict=True))
