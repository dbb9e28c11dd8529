"""How well tracks agree with truth: found, missed, false and switched stones, and metres."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import linear_sum_assignment

GATE = 0.15
"""Farther than this from every true stone, m, a detection is false."""

LONGEST = 5
"""Frames for which a track may be false."""


@dataclass(frozen=True)
class TrackScore:
    """Counts are of stones or of stone-frames; distances in m, spins in rad/s.

    ``within_two_sd`` is of x and y each, as stated errors are.
    """

    recall: float
    missed: tuple[str, ...]
    switches: int
    false_frames: int
    false_tracks: tuple[str, ...]
    rmse: float
    bias: tuple[float, float]
    within_two_sd: float
    names: dict[str, str]


@dataclass(frozen=True)
class Truth:
    """The stones of a clip as they were: ``stone, frame, t, x, y, …, visible``; e and μ.

    Where places are known to so much alone, a column ``sd`` says to how much, m, x and y each.
    """

    stones: pd.DataFrame
    restitution: float
    friction: float


def read_truth(clip: Path) -> Truth:
    """Truth beside `clip`: one .truth.json of this project's, or .truth.csv and .truth.json."""
    facts = json.loads(clip.with_suffix(".truth.json").read_text())
    if clip.with_suffix(".truth.csv").exists():
        stones = pd.read_csv(clip.with_suffix(".truth.csv"))
        # Stones that rest in the picture the clip was made of were measured there by hand.
        by_hand = stones["stone"].map(facts.get("real_stones", {})).fillna(0.0)
        stones["sd"] = by_hand / np.sqrt(2)
        return Truth(stones, float(facts["e"]), float(facts["mu"]))
    tables = [
        pd.DataFrame({"stone": name, "frame": range(len(facts["t"])), "t": facts["t"], **columns})
        for name, columns in facts["stones"].items()
    ]
    restitution = float(facts["hits"][0]["restitution"])
    return Truth(pd.concat(tables, ignore_index=True), restitution, float(facts["friction"]))


def score_tracks(
    tracks: pd.DataFrame, truth: pd.DataFrame, *, visible: float = 0.5, seen_only: bool = True
) -> TrackScore:
    """Match tracks to truth frame by frame, by the least total distance.

    Parameters
    ----------
    tracks : DataFrame
        ``stone, frame, x, y, sd_x, sd_y, seen``.
    truth : DataFrame
        ``stone, frame, x, y, visible``; rows seen less than `visible` need not be found, but
        a track there is not false.
    seen_only : bool
        Leave out what the filter carried.
    """
    rows = tracks[tracks["seen"] == 1] if seen_only else tracks
    by_frame = {frame: group for frame, group in rows.groupby("frame")}  # noqa: C416
    truth = truth.assign(sd=truth.get("sd", 0.0))
    pairs: list[tuple[str, str, float, float, bool, bool]] = []
    wanted = found = false = 0
    false_by_name: dict[str, int] = {}
    for frame, there in truth.groupby("frame"):
        here = by_frame.get(frame)
        must = there["visible"].to_numpy(float) >= visible
        wanted += int(must.sum())
        if here is None:
            continue
        apart = here[["x", "y"]].to_numpy(float)[:, None] - there[["x", "y"]].to_numpy(float)[None]
        distance = np.hypot(apart[..., 0], apart[..., 1])
        first, second = linear_sum_assignment(np.minimum(distance, 10 * GATE))
        good = distance[first, second] < GATE
        for i, j in zip(first[good], second[good], strict=True):
            if must[j]:
                found += 1
                sd = np.hypot(here[["sd_x", "sd_y"]].iloc[i], there["sd"].iloc[j])
                inside = np.abs(apart[i, j]) < 2 * sd.to_numpy(float)
                pairs.append((there["stone"].iloc[j], here["stone"].iloc[i], *apart[i, j], *inside))
        for i in set(range(len(here))) - set(first[good].tolist()):
            false += 1
            name = str(here["stone"].iloc[i])
            false_by_name[name] = false_by_name.get(name, 0) + 1
    table = pd.DataFrame(pairs, columns=["true", "name", "dx", "dy", "in_x", "in_y"])
    switches = sum(
        int((group["name"] != group["name"].shift()).sum()) - 1
        for _, group in table.groupby("true")
    )
    must_find = truth[truth["visible"] >= visible]["stone"].unique()
    error = np.hypot(table["dx"], table["dy"])
    return TrackScore(
        recall=found / max(wanted, 1),
        missed=tuple(sorted(set(must_find) - set(table["true"]))),
        switches=switches,
        false_frames=false,
        false_tracks=tuple(name for name, count in false_by_name.items() if count > LONGEST),
        rmse=float(np.sqrt((error**2).mean())) if len(table) else float("nan"),
        bias=(float(table["dx"].mean()), float(table["dy"].mean())),
        within_two_sd=float(table[["in_x", "in_y"]].to_numpy(float).mean())
        if len(table)
        else float("nan"),
        names={
            str(true): str(group["name"].mode().iloc[0]) for true, group in table.groupby("true")
        },
    )
