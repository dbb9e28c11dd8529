"""The tables of a report, as DataFrames: SI units, one fact a column, NaN or None where unknown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from data.results import Collision, Glide, SimulationScore, StoneState
from data.sheet import STONE

Array = NDArray[np.float64]

STATE_COLUMNS = ("x", "y", "vx", "vy", "omega")

_LEAST_KICK = 0.02  # m/s between two samples; the ice alone takes 0.004 m/s at 25 per second


def moving_stones(
    tracks: pd.DataFrame, collisions: Sequence[Collision] = (), radius: float = STONE.radius
) -> tuple[str, ...]:
    """Names of the stones that moved: in a hit, or by more than a third of the radius."""
    hit = {name for collision in collisions for name in collision.stones}
    moved = []
    for name, group in tracks.groupby("stone", sort=True):
        places = group[["x", "y"]].to_numpy(float)
        window = min(5, len(places))
        # Means of a few rows: one wild row is no motion.
        kernel = np.ones(window) / window
        calm = np.stack([np.convolve(places[:, k], kernel, "valid") for k in (0, 1)], axis=1)
        if name in hit or np.ptp(calm, axis=0).max() > radius / 3:
            moved.append(str(name))
    return tuple(moved)


def stone_table(tracks: pd.DataFrame) -> pd.DataFrame:
    """One row per stone: when and where it was seen, how fast it went, how far it turned.

    Returns
    -------
    DataFrame
        ``stone, t0, t1, frames, seen, x0, y0, x1, y1, path, top_speed, turned, sd``; `seen`
        is the fraction of its frames that showed it, `path` the length of its way, `turned`
        the angle from first to last, `sd` the median standard deviation of its place.
    """
    rows = []
    for name, group in tracks.sort_values("t").groupby("stone", sort=True):
        x, y, vx, vy = group[["x", "y", "vx", "vy"]].to_numpy(float).T
        theta = group["theta"].dropna().to_numpy(float)
        sd = np.hypot(group["sd_x"].to_numpy(float), group["sd_y"].to_numpy(float)) / np.sqrt(2)
        known = sd[np.isfinite(sd)]
        speed = np.hypot(vx, vy)
        rows.append(
            {
                "stone": str(name),
                "t0": group["t"].iloc[0],
                "t1": group["t"].iloc[-1],
                "frames": len(group),
                "seen": float((group["seen"] == 1).mean()),
                "x0": x[0],
                "y0": y[0],
                "x1": x[-1],
                "y1": y[-1],
                "path": float(np.hypot(np.diff(x), np.diff(y)).sum()),
                "top_speed": float(np.nanmax(speed)) if np.isfinite(speed).any() else np.nan,
                "turned": float(theta[-1] - theta[0]) if len(theta) > 1 else np.nan,
                "sd": float(np.median(known)) if len(known) else np.nan,
            }
        )
    return pd.DataFrame(rows)


def hit_table(collisions: Sequence[Collision]) -> pd.DataFrame:
    """One row per hit with all that was derived from it."""
    return pd.DataFrame(
        [
            {
                "hit": rank,
                "t": c.t,
                "stderr_t": c.stderr_t,
                "first": c.stones[0],
                "second": c.stones[1],
                "nx": c.normal[0],
                "ny": c.normal[1],
                "restitution": c.restitution,
                "stderr": c.stderr,
                "momentum_residual": c.momentum_residual,
                "stderr_momentum": c.stderr_momentum,
                "energy_lost": c.energy_lost,
                "stone_friction": c.stone_friction,
                "stderr_stone_friction": c.stderr_stone_friction,
                "note": c.note,
            }
            for rank, c in enumerate(collisions, 1)
        ]
    )


def measured_table(collisions: Sequence[Collision]) -> pd.DataFrame:
    """Place, velocity and spin of both stones before and after each hit (the paper's Table 2).

    Returns
    -------
    DataFrame
        ``hit, stone, when, x, y, vx, vy, omega``.
    """
    rows = []
    for rank, collision in enumerate(collisions, 1):
        for stone in collision.stones:
            for when, side in (("before", collision.before), ("after", collision.after)):
                rows.append(_state_row(rank, stone, when, side.get(stone)))
    return pd.DataFrame(rows, columns=["hit", "stone", "when", *STATE_COLUMNS])


def simulated_table(
    simulation: pd.DataFrame, collisions: Sequence[Collision], radius: float = STONE.radius
) -> pd.DataFrame:
    """Return the same hits in a sampled simulation (the paper's Tables 3 and 4).

    A hit of two stones shows as both velocities changing between two samples while the
    stones are close; the samples on either side are the states before and after. A hit that
    the simulation does not have leaves NaN.

    Parameters
    ----------
    simulation : DataFrame
        ``stone, frame, t, x, y, theta, vx, vy, omega`` of one model.
    collisions : sequence of Collision
        The measured hits, which say what to look for.
    radius : float
        Radius of the stones, m.

    Returns
    -------
    DataFrame
        ``hit, stone, when, t, x, y, vx, vy, omega``; `t` is that of the sample.
    """
    rows = []
    for rank, collision in enumerate(collisions, 1):
        tracks = [_states(simulation, name) for name in collision.stones]
        common = tracks[0].index.intersection(tracks[1].index)
        tracks = [track.loc[common] for track in tracks]
        place = _hit_between(tracks[0], tracks[1], collision.t, radius)
        for stone, track in zip(collision.stones, tracks, strict=True):
            for when, offset in (("before", 0), ("after", 1)):
                row: dict[str, object] = {"hit": rank, "stone": stone, "when": when}
                if place is not None:
                    row["t"] = common[place + offset]
                    row |= {name: track[name].iloc[place + offset] for name in STATE_COLUMNS}
                rows.append(row)
    return pd.DataFrame(rows, columns=["hit", "stone", "when", "t", *STATE_COLUMNS])


def glide_table(glides: Sequence[Glide]) -> pd.DataFrame:
    """One row per free glide and its friction."""
    columns = ["stone", "t0", "t1", "friction", "stderr"]
    return pd.DataFrame([[getattr(g, name) for name in columns] for g in glides], columns=columns)


def score_table(simulations: Mapping[str, SimulationScore]) -> pd.DataFrame:
    """One row per model: root mean square distance, and per stone that of the last places, m."""
    rows = [
        {"model": model, "rmse": score.rmse, **score.rest_error, "note": score.note}
        for model, score in simulations.items()
    ]
    stones = sorted({name for score in simulations.values() for name in score.rest_error})
    return pd.DataFrame(rows, columns=["model", "rmse", *stones, "note"])


def _state_row(rank: int, stone: str, when: str, state: StoneState | None) -> dict[str, object]:
    values = {name: None if state is None else getattr(state, name) for name in STATE_COLUMNS}
    return {"hit": rank, "stone": stone, "when": when, **values}


def _states(simulation: pd.DataFrame, stone: str) -> pd.DataFrame:
    rows = simulation[simulation["stone"] == stone].sort_values("t")
    return rows.set_index("t")[list(STATE_COLUMNS)]


def _hit_between(one: pd.DataFrame, two: pd.DataFrame, t: float, radius: float) -> int | None:
    """Index of the sample just before the two stones hit each other, None if they do not."""
    if len(one) < 2:
        return None
    times = one.index.to_numpy(float)
    velocities = [table[["vx", "vy"]].to_numpy(float) for table in (one, two)]
    kick = np.minimum(*(np.hypot(*np.diff(v, axis=0).T) for v in velocities))
    apart = np.hypot(*(one[["x", "y"]].to_numpy(float) - two[["x", "y"]].to_numpy(float)).T)
    apart = np.minimum(apart[:-1], apart[1:])
    relative = np.hypot(*(velocities[0] - velocities[1]).T)
    reach = 2 * radius + np.maximum(relative[:-1], relative[1:]) * np.diff(times)
    found = np.flatnonzero((kick > _LEAST_KICK) & (apart <= reach * 1.001))
    if len(found) == 0:
        return None
    return int(found[np.argmin(np.abs(times[found] - t))])
