"""Stones that come into view under way, and throws that follow one another in one clip."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import pandas as pd

from curlshot.data.results import Hit
from curlshot.data.sheet import SHEET
from curlshot.physics.simulator.bounds import Bounds

STILL = 0.03
"""Speed below which a stone has stopped, m/s: ice of μ = 0.008 stops it within 6 mm."""

FIRST = 0.25
"""The first seconds of a track that tell whether its stone comes into view under way."""

LOST = 5.0
"""Time, s, after which a stone that went out of sight under way is not the next one that comes in:
people cover stones for seconds."""


def thrown(track: pd.DataFrame) -> bool:
    """Tell whether a stone moves as it comes into view."""
    early = track[track["t"] < track["t"].iloc[0] + FIRST]
    return bool(np.hypot(early["vx"], early["vy"]).median() > 3 * STILL)


def come_in(tracks: pd.DataFrame, time: float) -> dict[str, float]:
    """Stones that come into view under way after a time, s, and when."""
    return {
        str(name): float(track["t"].iloc[0])
        for name, track in tracks.sort_values("t").groupby("stone", sort=True)
        if track["t"].iloc[0] > time and thrown(track)
    }


def later_throws(tracks: pd.DataFrame) -> dict[str, float]:
    """Stones that come into view under way when all others have stopped, and when, s.

    One stone at least has moved before for certain, and none that went out of sight just before
    may be the one that comes in.
    """
    speed = np.hypot(tracks["vx"], tracks["vy"])
    least = speed - 2 * np.hypot(tracks["sd_vx"], tracks["sd_vy"])
    out = {}
    for name, when in come_in(tracks, float(tracks["t"].min())).items():
        before = (tracks["t"] < when) & (tracks["stone"] != name)
        last = tracks[before].assign(speed=speed[before]).sort_values("t").groupby("stone").last()
        goes = (last["speed"] > STILL) & (when - last["t"] < LOST)
        if least[before].max() > 3 * STILL and not goes.any():
            out[name] = when
    return out


def newcomers(tracks: pd.DataFrame, time: float) -> dict[str, float]:
    """Stones that may not have lain there at a time, s, and when they are first seen.

    They come into view under way, or lie there when all has stopped and another is thrown then:
    between two throws people move stones, and a clip may be cut.
    """
    under_way, stop = come_in(tracks, time), np.inf
    later = [when for when in later_throws(tracks).values() if when > time]
    if later:
        goes = (np.hypot(tracks["vx"], tracks["vy"]) > STILL) & (tracks["t"] < min(later))
        stop = max(float(tracks["t"][goes].max()), time)
    first = tracks.groupby("stone", sort=True)["t"].min()
    return {
        str(name): float(when)
        for name, when in first.items()
        if str(name) in under_way or when > stop
    }


def first_hit(collisions: Sequence[Hit]) -> float:
    """Time, s, before which no stones have met for certain; infinity without a hit."""
    return min((hit.earliest for hit in collisions), default=np.inf)


def along_sheet(tracks: pd.DataFrame, hit: float, radius: float) -> bool:
    """Whether the first throw is one on a sheet with the origin at its tee and y along it.

    It is, as far as can be told, if the stone that is fastest before the first hit, at the time
    `hit`, s, comes from within the side lines and goes along rather than across.
    """
    ways = [track for _, track in tracks[tracks["t"] < hit].sort_values("t").groupby("stone")]
    velocities = [track[["vx", "vy"]].median().fillna(0.0).to_numpy(float) for track in ways]
    speeds = [float(np.hypot(*velocity)) for velocity in velocities]
    if not speeds or max(speeds) <= STILL:
        return True
    fastest = int(np.argmax(speeds))
    begin, (vx, vy) = ways[fastest].iloc[0], velocities[fastest]
    bounds = Bounds(1 if vy > 0 else -1, half_width=SHEET.half_width_max)
    inside = float(bounds.beyond(begin["x"], begin["y"], radius)) <= 0
    return inside and bool(abs(vx) < abs(vy))


def foreseen_until(
    ends: Mapping[str, float], collisions: Sequence[Hit], known: Collection[str]
) -> dict[str, float]:
    """Tell until when, s, stones go as they would without those that are not `known`.

    Until `ends`, and until one that is not known hits them, or one that it has hit.
    """
    out = dict(ends)
    moved: set[str] = set()
    for hit in sorted(collisions, key=lambda hit: hit.t):
        if any(stone in moved or stone not in known for stone in hit.stones):
            moved.update(hit.stones)
            out |= {stone: min(out.get(stone, np.inf), hit.t) for stone in hit.stones}
    return out
