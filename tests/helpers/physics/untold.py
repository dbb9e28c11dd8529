"""What tests of untold share."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import estimate_locally

R, FPS, BRAKE, E = 0.1455, 30.0, 0.1, 0.8
Floats = NDArray[np.float64]


def glide(place: Floats, velocity: Floats, t: Floats) -> Floats:
    """Places of a stone that brakes evenly until it rests."""
    speed = float(np.hypot(*velocity))
    if not speed:
        return np.tile(place, (len(t), 1))
    tau = np.clip(t, None, speed / BRAKE)
    path = tau - 0.5 * BRAKE * tau**2 / speed
    return np.asarray(place + path[:, None] * velocity)


def hit(
    speed: float, *, at: float = 1.5, aside: float = 0.06, end: float = 4.0
) -> tuple[Floats, dict[str, Floats]]:
    """A hits B, which lies at the tee, at a time and a speed: times and places, by closed form."""
    t = np.arange(0.0, end, 1 / FPS)
    normal = np.array([-aside, -np.sqrt(4 * R * R - aside**2)]) / (2 * R)
    before = np.array([0.0, -speed])
    given = 0.5 * (1 + E) * float(before @ normal) * normal
    start = -2 * R * normal - before * (at + 0.5 * BRAKE * at**2 / speed)
    first = glide(start, before * (1 + BRAKE * at / speed), t)
    after = glide(-2 * R * normal, before - given, t - at)
    return t, {
        "A": np.where((t < at)[:, None], first, after),
        "B": np.where((t < at)[:, None], 0.0, glide(np.zeros(2), given, t - at)),
        "C": np.tile([1.0, 0.5], (len(t), 1)),
    }


def table(
    t: Floats, places: dict[str, Floats], hidden: dict[str, tuple[float, float]]
) -> pd.DataFrame:
    """Detections with 2 mm of noise; each stone is hidden between two times."""
    rng = np.random.default_rng(3)
    parts = []
    for name, xy in places.items():
        seen = xy + rng.normal(0, 0.002, xy.shape)
        part = pd.DataFrame({"stone": name, "frame": np.arange(len(t)), "t": t})
        part["x"], part["y"] = seen.T
        part["sd_x"] = part["sd_y"] = 0.002
        part["theta"] = part["sd_theta"] = np.nan
        start, end = hidden.get(name, (np.inf, np.inf))
        parts.append(part[(t < start) | (t > end)])
    return pd.concat(parts, ignore_index=True)


def said(detections: pd.DataFrame) -> list[str]:
    contacts = detect_hits(detections, R)
    warnings = estimate_locally(detections, contacts, radius=R).warnings
    return [text for text in warnings if not text.startswith(("restitution: no hit", "no stone"))]
