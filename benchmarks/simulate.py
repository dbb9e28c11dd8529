"""How fast and how exact the simulator is, on one core.

Run ``python -m benchmarks.simulate [REPEATS]``. It prints, for shots of one to sixteen stones,
the least processor time of one simulation with its number of hits, and of one of many variants
that go forward together; the time that a new ice law costs; and the difference of the places of
rest from an ODE solver at its tightest and from a curve of twice as many cells. Where the
package pooltool-billiards is installed, two balls and a break by it stand beside these.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable
from importlib import import_module

import numpy as np
from scipy.integrate import solve_ivp

from curlshot.physics.curl import FCV1Curl
from curlshot.physics.ice import FCV1
from curlshot.physics.impact import Frictional
from curlshot.physics.simulator.curve import CELLS, curve
from curlshot.physics.simulator.many import simulate_many
from curlshot.physics.simulator.motion import Motion, Path
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, States, StoneStart


def single() -> Shot:
    return Shot((StoneStart("A", 0, 0, 0, 2.4, math.pi / 2),))


def two_hits() -> Shot:
    stones = (
        StoneStart("A", -0.02, -3, 0, 2.0, 0.8),
        StoneStart("B", 0.1, 0),
        StoneStart("C", 0.7, 1.2),
    )
    return Shot(stones, Frictional(0.83, 0.2))


def house(seed: int) -> Shot:
    """Sixteen stones: a fast one thrown into fifteen that lie about the house."""
    rng = np.random.default_rng(seed)
    cells = rng.permutation(25)[:15]
    places = 0.55 * np.stack([cells % 5 - 2, cells // 5 - 2], 1) + rng.uniform(-0.1, 0.1, (15, 2))
    lying = tuple(StoneStart(f"S{k:02d}", x, y) for k, (x, y) in enumerate(places.tolist()))
    thrown = StoneStart("A", rng.uniform(-1, 1), -8, 0, 3.0, 1.5)
    return Shot((thrown, *lying), Frictional(0.83, 0.2))


def rack() -> Shot:
    """Fifteen stones that almost touch, broken by a sixteenth."""
    lying = tuple(
        StoneStart(f"S{row}{k}", (k - row / 2) * 0.2912, 2 + row * 0.2912 * math.sqrt(3) / 2)
        for row in range(5)
        for k in range(row + 1)
    )
    return Shot((StoneStart("A", 0.01, 0, 0, 3.0, 1.0), *lying), Frictional(0.83, 0.2))


def seconds(call: Callable[[], object], repeats: int) -> float:
    """Least processor time of one call, s."""
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        call()
        times.append(time.process_time() - begin)
    return min(times)


def thrown_often(shot: Shot, variants: int) -> States:
    """Variants of a shot: the first stone off by what players are off by."""
    rng = np.random.default_rng(0)
    states = States.of(shot, variants)
    speed = states.vy[:, 0].copy()
    states.vy[:, 0] += 0.0076 * rng.standard_normal(variants)
    states.vx[:, 0] += 0.0018 * speed * rng.standard_normal(variants)
    return states


def peer_rates(repeats: int) -> dict[str, float]:
    """Seconds of two balls and of a break in pooltool; empty where it is not installed."""
    try:
        pooltool = import_module("pooltool")
    except ImportError:
        return {}
    two = {
        "cue": pooltool.Ball.create("cue", xy=(0.5, 0.5)),
        "1": pooltool.Ball.create("1", xy=(0.5, 1.2)),
    }
    table = pooltool.Table.default()
    rack = pooltool.get_rack(pooltool.GameType.NINEBALL, table)
    out = {}
    for name, balls in (("pooltool, 2 balls", two), ("pooltool, break of 9", rack)):
        system = pooltool.System(
            cue=pooltool.Cue(cue_ball_id="cue"), table=pooltool.Table.default(), balls=balls
        )
        system.cue.set_state(V0=3.0, phi=pooltool.aim.at_ball(system, "1"))
        pooltool.simulate(system)
        out[name] = seconds(lambda s=system: pooltool.simulate(s), repeats)  # type: ignore[misc]
    return out


def error_against_ode(speed: float) -> float:
    """Distance from the place of rest that a general ODE solver finds, m."""
    ice, curl = FCV1(), FCV1Curl()

    def rates(v: float, state: np.ndarray) -> list[float]:
        per_speed = -1 / float(ice.deceleration(v))
        heading = state[0]
        return [
            per_speed * float(curl.turn_rate(v)),
            per_speed * v * math.cos(heading),
            per_speed * v * math.sin(heading),
        ]

    run = solve_ivp(rates, (speed, 1e-12), [math.pi / 2, 0, 0], rtol=1e-12, atol=1e-13)
    last = Path(0.0, Motion(0, 0, 0, 0, speed, 2.0), ice, curl).at(math.inf)
    return math.dist((last.x, last.y), run.y[1:, -1])


def error_of_curve() -> float:
    """Largest difference of the distance to rest between two densities of cells, m."""
    coarse, fine = curve(FCV1(), FCV1Curl()), curve(FCV1(), FCV1Curl(), cells=2 * CELLS)
    apart = coarse.coefficients[:, 1, 0] - fine.coefficients[::2, 1, 0]
    return float(np.abs(apart).max())


def main(repeats: int) -> None:
    shots = {
        "1 stone": [single()],
        "3 stones, 2 hits": [two_hits()],
        "16 stones in the house": [house(seed) for seed in range(10)],
        "16 stones, rack": [rack()],
    }
    for name, group in shots.items():
        hits = statistics.mean(len(simulate(shot).hits) for shot in group)
        spent = statistics.mean(seconds(lambda s=shot: simulate(s), repeats) for shot in group)  # type: ignore[misc]
        print(f"{name:24} {1e3 * spent:8.3f} ms {1 / spent:8.0f} shots/s {hits:6.1f} hits")
    for name, shot, variants in (
        ("many, 1 stone", single(), 10_000),
        ("many, 3 stones", two_hits(), 4000),
        ("many, 16 in the house", house(0), 2000),
        ("many, 16 stones, rack", rack(), 1000),
    ):
        states = thrown_often(shot, variants)
        hits = simulate_many(shot, states).hits.sum() / 2 / variants
        spent = seconds(lambda a=shot, b=states: simulate_many(a, b), 3) / variants  # type: ignore[misc]
        print(f"{name:24} {1e3 * spent:8.3f} ms {1 / spent:8.0f} shots/s {hits:6.1f} hits")
    for name, spent in peer_rates(min(repeats, 3)).items():
        print(f"{name:24} {1e3 * spent:8.3f} ms {1 / spent:8.0f} shots/s")
    build = seconds(lambda: curve.__wrapped__(FCV1(), FCV1Curl(), 4.0), repeats)
    print(f"{'a new ice law':24} {1e3 * build:8.3f} ms")
    for speed in (0.5, 2.0, 3.5):
        print(f"rest from {speed} m/s, against an ODE solver {error_against_ode(speed):.1e} m")
    print(f"distance to rest, twice as many cells {error_of_curve():.1e} m")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument(
        "repeats", nargs="?", type=int, default=20, help="of which the least counts"
    )
    main(parser.parse_args().repeats)
