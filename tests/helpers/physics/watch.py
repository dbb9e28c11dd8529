"""Detections whose truth is known: small-step motion seen with noise, and real tracks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.tracks import check_detections
from curlshot.synthetic.detections import NAMES, RADIUS, hit_motion, noisy_detections
from curlshot.synthetic.physics import Motion

Floats = NDArray[np.float64]

__all__ = [
    "NAMES",
    "RADIUS",
    "airtable",
    "discs",
    "hit_motion",
    "lasting",
    "semireal",
    "uncut",
    "watch",
]


def watch(motion: Motion, rng: np.random.Generator, **how: float) -> pd.DataFrame:
    """Return checked detections of a motion (see `noisy_detections`)."""
    return check_detections(noisy_detections(motion, rng, **how))  # type: ignore[arg-type]


def uncut(
    motion: Motion,
    rests: tuple[float, float],
    *,
    sd: float,
    at_rest: float,
    given: bool = True,
    fps: float = 25.0,
) -> pd.DataFrame:
    """What a camera sees of two stones, and so long, s, before and after, when they rest.

    The first comes with the motion. What is seen is the same however long stones rest, but
    for more of it.
    """
    count = int(motion.times[-1] * fps)
    before, after = (round(rest * fps) for rest in rests)
    frames = np.arange(-before, count + after)
    states = motion.at(np.clip(frames / fps, 0.0, motion.times[-1]))
    each = zip((before, count + after), (3, 4), strict=True)
    back, on = (np.random.default_rng(seed).normal(0, 1, (n, 2, 2)) for n, seed in each)
    noise = np.concatenate([back[::-1], on])
    tables = []
    for i in range(2):
        size = np.where(np.hypot(*states[:, i, 3:5].T) > 0.01, sd, at_rest)
        table = pd.DataFrame({"stone": NAMES[i], "frame": frames, "t": frames / fps})
        table[["x", "y"]] = states[:, i, :2] + size[:, None] * noise[:, i]
        table[["theta", "sd_x", "sd_y"]] = np.nan
        if given:
            table["sd_x"] = table["sd_y"] = size
        tables.append(table[(frames >= 0) | (i > 0)])
    return check_detections(pd.concat(tables))


def lasting(rng: np.random.Generator, t: Floats, sd: float, memory: float) -> Floats:
    """Errors of one size that last for a while."""
    out = [rng.normal(0, sd)]
    for fade in np.exp(-np.diff(t) / memory):
        out.append(fade * out[-1] + rng.normal(0, sd * np.sqrt(1 - fade**2)))
    return np.array(out)


def semireal(
    shared: Path, name: str, rng: np.random.Generator, *, sd: float, slow: float = 0.0
) -> pd.DataFrame:
    """Truth of a semi-real clip where a stone is in view, with white and slowly varying noise."""
    truth = pd.read_csv(shared / "clips" / f"semireal_{name}.truth.csv")
    seen = truth[truth["visible"] >= 0.5].reset_index(drop=True)
    keep = float(np.exp(-1 / 12))
    for column in ("x", "y"):
        for _, group in seen.groupby("stone"):
            drift = np.zeros(len(group))
            for k in range(1, len(group)):
                drift[k] = keep * drift[k - 1] + np.sqrt(1 - keep**2) * rng.normal(0, slow)
            noise = drift + rng.normal(0, sd, len(group))
            seen.loc[group.index, column] = group[column] + noise
    return check_detections(seen[["stone", "frame", "t", "x", "y", "theta"]])


def airtable(shared: Path) -> pd.DataFrame:
    """Two pucks on an air table, from Tracker, 100 frames a second."""
    rows = np.loadtxt(shared / "tracks" / "airtable_two_pucks.csv", delimiter=";")
    t, cm = rows[:, 0], rows[:, 1:] / 100
    pucks = [
        pd.DataFrame({"stone": name, "t": t, "x": cm[:, 2 * k], "y": cm[:, 2 * k + 1]})
        for k, name in enumerate(("1", "2"))
    ]
    return check_detections(pd.concat(pucks))


def discs(shared: Path, number: int) -> pd.DataFrame:
    """Two discs on a table, motion capture at 500 Hz."""
    table = pd.read_csv(shared / "tracks" / "discs_500hz" / f"hit_{number}.csv")
    t = np.arange(len(table)) / 500
    both = [
        pd.DataFrame(
            {
                "stone": name,
                "t": t,
                "x": table[f"c_{name}_x"],
                "y": table[f"c_{name}_y"],
                "theta": table[f"ang_{name}"],
            }
        )
        for name in "ab"
    ]
    return check_detections(pd.concat(both))
