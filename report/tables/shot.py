"""A shot in tables: its stones, hits, glides, the simulations' scores, what the fit leaves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from curlshot.data.results import Glide, Hit, Prediction, SimulationScore
from curlshot.data.sheet import STONE
from curlshot.physics.local_fit.off_centre import centred
from curlshot.physics.local_fit.traces import traces
from curlshot.physics.prediction.throws import thrown


def moving_stones(
    tracks: pd.DataFrame, collisions: Sequence[Hit] = (), radius: float = STONE.radius
) -> tuple[str, ...]:
    """Names of the stones that moved: in a hit, or by more than a third of the radius."""
    hit = {name for collision in collisions for name in collision.stones}
    moved = []
    for name, group in tracks.groupby("stone", sort=True):
        places = group[["x", "y"]].to_numpy(float)
        window = min(5, (len(places) + 1) // 2)
        # Means of a few rows: one wild row is no motion.
        kernel = np.ones(window) / window
        calm = np.stack([np.convolve(places[:, k], kernel, "valid") for k in (0, 1)], axis=1)
        if name in hit or np.ptp(calm, axis=0).max() > radius / 3:
            moved.append(str(name))
    return tuple(moved)


def play(tracks: pd.DataFrame, collisions: Sequence[Hit] = (), radius: float = STONE.radius) -> int:
    """Tell which way stones are thrown: 1 if up y, -1 if down or if none is seen to come."""
    for name in moving_stones(tracks, collisions, radius):
        track = tracks[tracks["stone"] == name].sort_values("t")
        if thrown(track):
            return 1 if float(track["vy"].head(5).mean()) > 0 else -1
    return -1


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


def hit_table(collisions: Sequence[Hit]) -> pd.DataFrame:
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
                "note_stone_friction": c.note_stone_friction,
            }
            for rank, c in enumerate(collisions, 1)
        ]
    )


def glide_table(glides: Sequence[Glide]) -> pd.DataFrame:
    """One row per free glide and its friction."""
    columns = ["stone", "t0", "t1", "friction", "stderr"]
    return pd.DataFrame([[getattr(g, name) for name in columns] for g in glides], columns=columns)


def score_table(scores: Mapping[str, SimulationScore] | Mapping[str, Prediction]) -> pd.DataFrame:
    """One row per model: root mean square distance, and per stone that of the last places, m.

    Returns
    -------
    DataFrame
        ``model, rmse``, a column for each stone, for each one ``sd_`` and its name, by how much its
        last place may be off as far as is known, and ``note``.
    """
    rows = [
        {"model": model, "rmse": score.rmse, **score.rest_error, "note": score.note}
        | {f"sd_{name}": sd for name, sd in score.rest_sd.items()}
        for model, score in scores.items()
    ]
    stones = scored_stones(scores)
    stated = [f"sd_{name}" for name in stones]
    return pd.DataFrame(rows, columns=["model", "rmse", *stones, *stated, "note"])


def scored_stones(scores: Mapping[str, SimulationScore] | Mapping[str, Prediction]) -> list[str]:
    """Names of the stones whose last places are compared."""
    return sorted({name for score in scores.values() for name in score.rest_error})


def residual_table(
    detections: pd.DataFrame,
    tracks: pd.DataFrame,
    collisions: Sequence[Hit] = (),
    radius: float = STONE.radius,
) -> pd.DataFrame:
    """Sighted less smoothed places, one row per detection.

    Parameters
    ----------
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`.
    tracks : DataFrame
        `curlshot.data.tracks.TRACK_COLUMNS`, smoothed from them.
    collisions : sequence of Hit
        The hits.
    radius : float
        Of the discs, m.

    Returns
    -------
    DataFrame
        ``stone, frame, t, dx, dy, sd_x, sd_y``: m and s; the standard deviations are those of
        the detections, from their scatter where the table has none. Where a cap shows to be beside
        its stone's centre that is taken out, as for the filter.
    """
    keys, sd = ["stone", "frame"], ["sd_x", "sd_y"]
    table = detections.sort_values(["stone", "t"]).reset_index(drop=True)
    known = centred(traces(table), collisions, radius)
    if known:
        table[sd] = np.concatenate([known[str(name)].sd for name in sorted(known)])
        table[["x", "y"]] = np.concatenate([known[str(name)].xy for name in sorted(known)])
    both = table.merge(tracks[[*keys, "x", "y"]], on=keys, suffixes=("", "_smooth"))
    both["dx"], both["dy"] = both["x"] - both["x_smooth"], both["y"] - both["y_smooth"]
    both = both[both[["dx", "dy"]].notna().all(axis=1)]
    return both[[*keys, "t", "dx", "dy", *sd]].reset_index(drop=True)
