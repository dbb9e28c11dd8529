"""How long it takes to get from sightings to e and mu, and how sharp and honest they are.

Run from the repository root: ``python -m benchmarks.estimate [--trials 40]``. The truth comes
from the small-step program in tests/synthetic, which shares no code with the library.
"""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np
import pandas as pd

from physics.contacts import find_contacts
from physics.estimate import estimate
from physics.kalman import smooth
from physics.predict import simulate_measured
from tests.synthetic.physics import Ice, Impact, Start, simulate

RADIUS = 0.1455
RESTITUTION, FRICTION = 0.83, 0.0109
CASES = (
    # closing speed m/s, seconds before and after, frames a second, noise m
    (0.5, 1.5, 25.0, 0.003),
    (1.0, 1.0, 25.0, 0.010),
    (2.0, 0.5, 30.0, 0.010),
    (1.5, 3.0, 60.0, 0.003),
)


def shot(
    speed: float, span: float, fps: float, sd: float, rng: np.random.Generator
) -> tuple[pd.DataFrame, object]:
    """Sightings of one shot with a random offset, and its hit."""
    offset = rng.uniform(-0.15, 0.15)
    reach = float(np.sqrt((2 * RADIUS) ** 2 - offset**2))
    up = speed * 2 * RADIUS / reach
    slow = FRICTION * 9.81
    way = up * span + 0.5 * slow * span**2
    motion = simulate(
        [Start(offset, -reach - way, 0, up + slow * span, 0, 1.0), Start(0, 0)],
        2 * span,
        ice=Ice(b=FRICTION),
        impact=Impact(restitution=RESTITUTION),
        step=5e-4,
        keep_every=4,
    )
    t = np.arange(0.003, motion.times[-1], 1 / fps)
    states = motion.at(t)
    tables = []
    for i, name in enumerate("AB"):
        table = pd.DataFrame({"stone": name, "frame": np.arange(len(t)), "t": t})
        for axis, column in enumerate("xy"):
            table[column] = states[:, i, axis] + rng.normal(0, sd, len(t))
        table["theta"] = states[:, i, 2] + rng.normal(0, 0.02, len(t))
        table["sd_x"], table["sd_y"], table["sd_theta"] = sd, sd, 0.02
        tables.append(table)
    return pd.concat(tables, ignore_index=True), motion.hits[0]


def accuracy(trials: int) -> None:
    rng = np.random.default_rng(1)
    print("closing  span fps  noise | e: bias   scatter stated  in 2 sd | mu: bias  scatter stated")
    for speed, span, fps, sd in CASES:
        rows = []
        for _ in range(trials):
            seen, _hit = shot(speed, span, fps, sd, rng)
            found = estimate(seen, find_contacts(seen, RADIUS), radius=RADIUS)
            e, mu = found.restitution, found.friction
            rows.append([e.value, e.stderr, mu.value, mu.stderr])
        e, se, mu, smu = np.array(rows, float).T
        within = np.nanmean(np.abs(e - RESTITUTION) < 2 * se)
        print(
            f"{speed:5.1f} {span:6.1f} {fps:4.0f} {sd:6.3f} |"
            f" {np.nanmean(e) - RESTITUTION:+8.4f} {np.nanstd(e):8.4f} {np.nanmedian(se):7.4f}"
            f" {within:7.2f}  |"
            f" {np.nanmean(mu) - FRICTION:+8.5f} {np.nanstd(mu):8.5f} {np.nanmedian(smu):7.5f}"
        )


def speed() -> None:
    """Ten stones over 200 frames, of which two meet."""
    rng = np.random.default_rng(2)
    seen, _ = shot(1.0, 4.0, 25.0, 0.005, rng)
    more = [seen]
    frames = seen[["frame", "t"]].drop_duplicates()
    for k in range(8):
        rest = frames.assign(stone=f"R{k}", theta=0.0, sd_x=0.005, sd_y=0.005, sd_theta=0.02)
        rest["x"] = 1.0 + 0.4 * k + rng.normal(0, 0.005, len(rest))
        rest["y"] = rng.normal(0, 0.005, len(rest))
        more.append(rest)
    table = pd.concat(more, ignore_index=True)
    start = time.perf_counter()
    hits = find_contacts(table, RADIUS)
    found = time.perf_counter()
    tracks = smooth(table, hits, radius=RADIUS)
    smoothed = time.perf_counter()
    estimates = estimate(table, hits, radius=RADIUS)
    estimated = time.perf_counter()
    simulate_measured(tracks, estimates, radius=RADIUS)
    done = time.perf_counter()
    print(f"10 stones, {len(frames)} frames: contacts {found - start:.2f} s,", end=" ")
    print(f"filter {smoothed - found:.2f} s, estimates {estimated - smoothed:.2f} s,", end=" ")
    print(f"three simulations {done - estimated:.2f} s")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=40)
    accuracy(parser.parse_args().trials)
    speed()
    return 0


if __name__ == "__main__":
    sys.exit(main())
