"""Whether the estimates are as sharp, as honest and as fast as they should be: one table.

Run from the repository root: ``python -m benchmarks.estimate [--draws 200] [--local 300]
[--first 0]``. Shots are drawn at random over noise (3 mm, 1 cm), frames a second (25, 30, 60),
closing speeds (0.3 to 3 m/s), time in view on either side of a hit (0.5 to 3 s), one to three
hits, restitution, friction between the stones, and ice, every other time as FCV1 has it, else of
constant friction without curl. They are moved by the small-step program in tests/synthetic, which
shares no code with the library.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.benchmarks.simulate import house, peer_rates, seconds, single, thrown_often
from curlshot.data.tracks import check_detections
from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import Local, estimate_locally
from curlshot.physics.simulator.many import simulate_many
from curlshot.physics.simulator.simulate import simulate
from curlshot.synthetic.detections import hit_motion, noisy_detections
from curlshot.synthetic.physics import Ice, Impact, Motion, Start
from curlshot.synthetic.physics import simulate as move

Floats = NDArray[np.float64]

RADIUS = 0.1455
SLOWEST = 0.3
"""Least closing speed of a hit, m/s."""


@dataclass(frozen=True)
class Draw:
    """A shot whose truth is known, and what was seen of it."""

    restitution: float
    friction: float
    hits: int
    seen: pd.DataFrame


@dataclass(frozen=True)
class Row:
    """One line of the table: what is asked, and what was found."""

    what: str
    asked: str
    found: str
    kept: bool | None


def draws(count: int, first: int = 0) -> Iterable[Draw]:
    """Random shots, each from a seed of its own."""
    for seed in range(first, first + count):
        rng = np.random.default_rng(seed)
        motion = None
        while motion is None:
            hits = int(rng.integers(1, 4))
            span = float(np.exp(rng.uniform(np.log(0.5), np.log(3.0))))
            friction = rng.uniform(0.007, 0.014)
            ice = like_fcv1(friction) if seed % 2 else Ice(b=friction)
            impact = Impact(rng.uniform(0.7, 0.95), rng.uniform(0.0, 0.15))
            motion = chain(hits, span, ice, impact, rng)
        noise, rate = float(rng.choice([0.003, 0.01])), float(rng.choice([25.0, 30.0, 60.0]))
        seen = _watch(motion, rng, fps=rate, sd=noise)
        yield Draw(impact.restitution, friction, hits, seen)


def like_fcv1(friction: float) -> Ice:
    """Ice whose friction and curl depend on the speed as FCV1's, with that friction at 1 m/s."""
    v_c, share = 0.0639, 0.232  # of the friction at 1 m/s, what falls with the speed
    return Ice(b=(1 - share) * friction, a=share * friction * (1 + v_c), v_c=v_c, curl=0.0082)


def chain(
    hits: int, span: float, ice: Ice, impact: Impact, rng: np.random.Generator
) -> Motion | None:
    """Move stones that each hit the next after `span` seconds; None where one is too slow."""
    two, slow = 2 * RADIUS, ice.friction(1.0) * 9.81
    speed = float(np.exp(rng.uniform(np.log(SLOWEST), np.log(3.0))))
    off = rng.uniform(-0.15, 0.15)
    ahead = float(np.sqrt(two**2 - off**2))
    up = speed * two / ahead
    way = up * span + 0.5 * slow * span**2
    stones = [
        Start(off, -ahead - way, 0.0, up + slow * span, 0.0, rng.uniform(-1.5, 1.5)),
        Start(0.0, 0.0),
    ]
    place, normal = np.zeros(2), np.array([-off, ahead]) / two
    for _ in range(hits - 1):
        speed *= (1 + impact.restitution) / 2
        if speed - slow * span < SLOWEST:
            return None
        off = rng.uniform(-0.1, 0.1)
        ahead = float(np.sqrt(two**2 - off**2))
        left = np.array([-normal[1], normal[0]])
        place = place + normal * (speed * span - 0.5 * slow * span**2 + ahead) + left * off
        stones.append(Start(float(place[0]), float(place[1])))
        normal = (normal * ahead + left * off) / two
        speed = (speed - slow * span) * ahead / two
    motion = move(stones, (hits + 1) * span, ice=ice, impact=impact, step=5e-4, keep_every=4)
    closing = [
        float(np.dot(np.subtract(hit.before[0][:2], hit.before[1][:2]), hit.normal))
        for hit in motion.hits
    ]
    return motion if len(closing) == hits and min(closing) >= SLOWEST else None


def honesty(name: str, values: Floats, errors: Floats, truth: Floats) -> list[Row]:
    """Bias, stated errors and coverage of an estimate over many shots."""
    known = np.isfinite(values) & np.isfinite(errors)
    z = (values - truth)[known] / errors[known]
    bias, ratio, inside = float(z.mean()), 1 / float(z.std()), float(np.mean(np.abs(z) < 2))
    # What these figures may be off by chance, twice the standard error of each.
    by_mean, by_sd, by_share = 2 / np.sqrt(len(z)), 2 / np.sqrt(2 * len(z)), 0.44 / np.sqrt(len(z))
    return [
        Row(
            f"{name}: mean error / its standard error",
            "-0.10..0.10",
            f"{bias:+.2f} ± {by_mean:.2f}",
            abs(bias) <= 0.1 + by_mean,
        ),
        Row(
            f"{name}: stated error / true scatter",
            "0.75..1.25",
            f"{ratio:.2f} ± {by_sd:.2f} ({len(z)} shots)",
            0.75 - by_sd <= ratio <= 1.25 + by_sd,
        ),
        Row(
            f"{name}: truth within two errors",
            "92..98 %",
            f"{100 * inside:.0f} % ± {100 * by_share:.0f} %",
            0.92 - by_share <= inside <= 0.98 + by_share,
        ),
    ]


def estimates(whole: int, local: int, first: int) -> list[Row]:
    """Estimates of many random shots: `whole` of them by both ways, further ones locally."""
    found: list[tuple[Draw, Estimates]] = [
        (shot, estimate(shot.seen, detect_hits(shot.seen, RADIUS), radius=RADIUS))
        for shot in draws(whole, first)
    ]
    beside: list[tuple[Draw, Local]] = [(shot, done.local) for shot, done in found] + [
        (shot, estimate_locally(shot.seen, detect_hits(shot.seen, RADIUS), radius=RADIUS))
        for shot in draws(local - whole, first + whole)
    ]
    hits = [len(done.collisions) == shot.hits for shot, done in beside]

    def columns(rows: list[tuple[float | None, float | None, float]]) -> tuple[Floats, ...]:
        return tuple(np.array(rows, float).reshape(-1, 3).T)

    e_local = columns(
        [(d.restitution.value, d.restitution.stderr, s.restitution) for s, d in beside]
    )
    e_whole = columns(
        [(d.restitution.value, d.restitution.stderr, s.restitution) for s, d in found if d.shot_fit]
    )
    e_told = columns([(d.restitution.value, d.restitution.stderr, s.restitution) for s, d in found])
    mu = columns(
        [(d.friction.value, d.friction.stderr, s.friction) for s, d in found if d.shot_fit]
    )
    both = [
        (d.restitution.stderr or np.nan) / (d.local.restitution.stderr or np.nan)
        for _, d in found
        if d.shot_fit
    ]
    sharper = float(np.nanmedian(both))
    return [
        Row("hits found, none too many", "all", f"{sum(hits)} of {len(hits)}", all(hits)),
        *honesty("e beside the hits", *e_local),
        *honesty("e of the whole shot", *e_whole),
        *honesty("e of either, as reported", *e_told),
        *honesty("friction of the whole shot", *mu),
        Row("error of e, whole / beside the hits", "<= 1", f"{sharper:.2f} (median)", sharper <= 1),
    ]


def sharpness(count: int = 12) -> list[Row]:
    """Precision of a short clip and of a long glide."""
    short = hit_motion(2.0, 0.0, before=0.5, after=0.5)
    glide = move([Start(0, 0, 0, 1.2, 0, 0.5)], 5.0, ice=Ice(b=0.0109), step=5e-4, keep_every=4)
    rng = np.random.default_rng(3)
    errors, off = [], []
    for _ in range(count):
        seen = _watch(short, rng, sd=0.01)
        done = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
        errors.append((done.local.restitution.stderr, done.restitution.stderr))
        long = estimate_locally(_watch(glide, rng, sd=0.01), (), radius=RADIUS)
        off.append(abs((long.friction.value or np.nan) / 0.0109 - 1))
    local, whole = np.nanmedian(np.array(errors, float), axis=0)
    worst = 100 * float(np.max(off))
    where = "1 cm, 30 fps, 2 m/s, 0.5 s"
    return [
        Row(f"e ± beside the hits at {where}", "<= 0.020", f"{local:.4f}", local <= 0.02),
        Row(f"e ± of the whole shot at {where}", "<= 0.020", f"{whole:.4f}", whole <= 0.02),
        Row("friction from 5 s of glide at 1 cm", "<= 3 %", f"{worst:.1f} % (worst of {count})",
            worst <= 3),
    ]  # fmt: skip


def speed() -> list[Row]:
    """Processor time, least of some repeats."""
    seen = _watch(hit_motion(1.5, 0.06, others=[Start(0.02, 0.8)]), np.random.default_rng(2))
    contacts = detect_hits(seen, RADIUS)
    fit = seconds(lambda: estimate(seen, contacts, radius=RADIUS), 2)
    houses = [house(seed) for seed in range(10)]
    one = float(np.mean([seconds(lambda s=shot: simulate(s), 10) for shot in houses]))  # type: ignore[misc]
    alone = rate(lambda: simulate_many(single(), thrown_often(single(), 10_000)), 10_000)
    crowd = houses[0]
    many = rate(lambda: simulate_many(crowd, thrown_often(crowd, 2000)), 2000)
    peer = [
        Row(f"peer: {name}", "", f"{1 / spent:,.0f} shots/s", None)
        for name, spent in peer_rates(3).items()
    ] or [Row("peer: pooltool-billiards", "", "not installed", None)]
    return [
        Row("single stones, fcv1", ">= 10 000 shots/s", f"{alone:,.0f}", alone >= 1e4),
        Row("16 stones with hits, many at once", ">= 1000 shots/s", f"{many:,.0f}", many >= 1e3),
        Row("one shot of 16 stones", "<= 5 ms", f"{1e3 * one:.1f} ms", one <= 5e-3),
        Row("estimates of a three-stone shot", "<= 2 s", f"{fit:.2f} s", fit <= 2),
        *peer,
    ]


def rate(call: Callable[[], object], shots: int) -> float:
    """Shots per second of processor time."""
    return shots / seconds(call, 3)


def table(rows: Iterable[Row]) -> str:
    """Lay the rows out in columns."""
    marks = {True: "yes", False: "NO", None: ""}
    lines = [("", "asked", "found", "kept")]
    lines += [(row.what, row.asked, row.found, marks[row.kept]) for row in rows]
    wide = [max(len(line[k]) for line in lines) for k in range(4)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, wide, strict=True)).rstrip()
        for line in lines
    )


def _watch(motion: Motion, rng: np.random.Generator, **how: float) -> pd.DataFrame:
    return check_detections(noisy_detections(motion, rng, **how))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=200, help="shots fitted as a whole")
    parser.add_argument("--local", type=int, default=300, help="shots in all")
    parser.add_argument("--first", type=int, default=0, help="seed of the first shot")
    arguments = parser.parse_args()
    begin = time.process_time()
    rows = [
        *estimates(arguments.draws, max(arguments.local, arguments.draws), arguments.first),
        *sharpness(),
        *speed(),
    ]
    print(table(rows))
    print(f"{time.process_time() - begin:.0f} s of processor time")
    return 0 if all(row.kept is not False for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
