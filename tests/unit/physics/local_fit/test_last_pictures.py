"""Stones that hit each other so late that no picture tells it, as the filter has them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import pytest

from curlshot.data.sheet import STONE
from curlshot.data.tracks import Columns
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import HitCandidate, detect_hits
from curlshot.physics.local_fit.last_pictures import widen_last

RADIUS, SD, SPEED, HIT = STONE.radius, 0.0006, 0.3, 2.0
RESTITUTION = 0.84


def paths(t: np.ndarray, aside: float) -> tuple[np.ndarray, np.ndarray]:
    """Places along y, m, of one that comes down at 0.3 m/s and hits one at rest at 2 s, or none."""
    since = np.maximum(t - HIT, 0.0) if aside < 2 * RADIUS else 0 * t
    y = 2 * RADIUS + SPEED * (HIT - t) + 0.5 * (1 + RESTITUTION) * SPEED * since
    return y, -0.5 * (1 + RESTITUTION) * SPEED * since


def tracks(
    end: float,
    *,
    aside: float = 0.0,
    hits: tuple[HitCandidate, ...] | None = None,
    seed: int = 0,
    masses: Mapping[str, float] | None = None,
) -> pd.DataFrame:
    """What the filter makes of detections up to so many seconds after the hit; true `y` beside."""
    rng, t = np.random.default_rng(seed), HIT + end - np.arange(50)[::-1] / 25
    parts = []
    for name, x, y in zip("AB", (aside, 0.0), paths(t, aside), strict=True):
        noise = rng.normal(0, SD, (2, len(t)))
        seen = {"stone": name, "frame": np.arange(50), "t": t, "x": x + noise[0], "y": y + noise[1]}
        seen |= {"theta": 0.4 * (t if name == "A" else 0 * t), "sd_theta": 0.01}
        parts.append(pd.DataFrame({**seen, "sd_x": SD, "sd_y": SD, "true": y}))
    table = pd.concat(parts, ignore_index=True)
    found = detect_hits(table, RADIUS) if hits is None else hits
    return smooth(table, found, radius=RADIUS, masses=masses).assign(true=table["true"])


@pytest.mark.parametrize("end", [0.006, 0.02, 0.035])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_what_a_hit_in_the_last_two_pictures_may_have_changed_is_in_their_errors(
    end: float, seed: int
) -> None:
    """The stone that was hit is said to rest, with the errors of one that does, else."""
    both = tracks(end, hits=(), seed=seed)
    after = SPEED * np.array([1 - RESTITUTION, 1 + RESTITUTION]) / 2
    for name, speed in zip("AB", after, strict=True):
        last = both[both["stone"] == name].iloc[-1]
        assert abs(last["vy"] + speed) < 2 * last["sd_vy"]
        assert abs(last["y"] - last["true"]) < 2.5 * last["sd_y"]
    rows = both[both["stone"] == "B"]
    assert rows["sd_vy"].iloc[-1] > 0.1 and rows["sd_omega"].iloc[-1] > 0.3
    assert rows["sd_vy"].iloc[-3] < 0.01


def test_neither_a_hit_to_come_nor_one_that_is_told_nor_a_miss_widens_them() -> None:
    for end, aside in ((-0.06, 0.0), (0.02, 2 * RADIUS + 0.01)):
        both = tracks(end, aside=aside, hits=())
        assert both[both["stone"] == "B"]["sd_vy"].max() < 0.01
    told = tracks(0.075)
    assert told[told["stone"] == "B"]["sd_vy"].iloc[-1] < 0.05


def test_of_stones_of_unlike_masses_the_light_one_may_have_changed_the_more() -> None:
    """Beside one three times as heavy it gains three times what that loses, three halves of usual.

    All that counts is their ratio.
    """
    usual = tracks(0.035, hits=())
    for masses in ({"A": 3.0}, {"A": 57.0, "B": 19.0}):
        table = tracks(0.035, hits=(), masses=masses)
        for name, share in (("A", 0.5), ("B", 1.5)):
            own, known = (rows[rows["stone"] == name].iloc[-1] for rows in (table, usual))
            for column in ("sd_vy", "sd_omega"):
                assert own[column] == pytest.approx(share * known[column], rel=0.05)


def column(speed: float, place: float, steps: int = 5) -> Columns:
    """Rows of a stone that goes on along y as it has come, well known."""
    t = np.arange(steps) / 25
    zero, small = np.zeros(steps), np.full(steps, 0.0001)
    rows = {"t": t, "x": zero, "y": place + speed * t, "vx": zero, "vy": zero + speed}
    return rows | {f"sd_{name}": small.copy() for name in ("x", "y", "vx", "vy", "omega")}


@pytest.mark.parametrize(("hit", "wide"), [(0.17, 0), (0.13, 1), (0.09, 2), (0.07, 2)])
def test_what_is_widened_are_the_rows_after_the_hit_but_the_last_two_at_most(
    hit: float, wide: int
) -> None:
    both = {"A": column(-1.0, 2 * RADIUS + hit), "B": column(0.0, 0.0)}
    widen_last(both, (), RADIUS)
    for rows in both.values():
        assert ((rows["sd_vy"] > 0.5).sum(), (rows["sd_vx"] > 0.001).sum()) == (wide, 0)


def test_one_that_is_gone_before_the_other_is_hit_by_nobody() -> None:
    both = {"A": column(-1.0, 2 * RADIUS + 0.09), "B": column(0.0, 0.0, 6)}
    widen_last(both, (), RADIUS)
    assert max(rows["sd_vy"].max() for rows in both.values()) < 0.001
