"""A shot in closed form: A hits B, B hits C, all slowed at one rate; D never moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.results import (
    Estimate,
    Friction,
    Glide,
    Hit,
    Input,
    JointEstimate,
    Law,
    MeasuredState,
    Method,
    NotedEstimate,
    Results,
    SimulatedHit,
    SimulationScore,
    StoneResult,
)
from curlshot.data.tracks import TRACK_COLUMNS
from curlshot.physics.curl import FCV1Curl
from curlshot.physics.ice import Constant
from curlshot.physics.impact import Frictional
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.physics.simulator.simulation import Shot as Throw
from curlshot.physics.simulator.simulation import StoneStart

RADIUS = 0.1455
SLOWING = 0.0109 * 9.81
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Shot:
    tracks: pd.DataFrame
    simulations: dict[str, pd.DataFrame]
    results: Results
    ensemble: Ensemble


@dataclass(frozen=True)
class Piece:
    """One stone's motion from `t`: a straight glide that ends in rest, at a steady spin."""

    t: float
    place: Vector
    velocity: Vector
    omega: float

    def at(self, when: float) -> tuple[Vector, Vector]:
        speed = float(np.hypot(*self.velocity))
        if speed == 0:
            return self.place, self.velocity
        gone = min(when - self.t, speed / SLOWING)
        way = self.velocity / speed
        return self.place + way * (speed * gone - SLOWING * gone**2 / 2), way * (
            speed - SLOWING * gone
        )


def shot_pieces(e: float) -> tuple[dict[str, list[Piece]], list[tuple[float, str, str, Vector]]]:
    """Pieces of motion per stone, and the hits (time, first, second, normal)."""
    start = Piece(0.0, np.array([0.2, 1.9]), np.array([-0.05, -1.5]), 0.66)
    pieces = {"A": [start], "B": [], "C": []}
    hits = []
    t, turns = 0.0, (("A", "B", 0.35), ("B", "C", -0.25))
    for gap, (first, second, angle) in zip((0.8, 0.7), turns, strict=True):
        t += gap
        place, velocity = pieces[first][-1].at(t)
        along = velocity / np.hypot(*velocity)
        c, s = np.cos(angle), np.sin(angle)
        n = np.array([c * along[0] - s * along[1], s * along[0] + c * along[1]])
        target = place + 2 * RADIUS * n
        impulse = (1 + e) / 2 * float(velocity @ n)
        pieces[first].append(Piece(t, place, velocity - impulse * n, 0.4))
        pieces[second] = [
            Piece(0.0, target, np.zeros(2), 0.0),
            Piece(t, target, impulse * n, 0.3),
        ]
        hits.append((t, first, second, n))
    pieces["D"] = [Piece(0.0, np.array([-1.1, 0.5]), np.zeros(2), 0.0)]
    return pieces, hits


def sample(pieces: dict[str, list[Piece]], times: Vector) -> pd.DataFrame:
    rows = []
    for stone, parts in pieces.items():
        theta, before = 0.0, 0.0
        for frame, t in enumerate(times):
            piece = [p for p in parts if p.t <= t][-1]
            place, velocity = piece.at(t)
            theta, before = theta + piece.omega * (t - before), t
            rows.append([stone, frame, t, *place, theta, *velocity, piece.omega])
    return pd.DataFrame(
        rows, columns=["stone", "frame", "t", "x", "y", "theta", "vx", "vy", "omega"]
    )


def make_shot(frames: int = 170) -> Shot:
    times = np.arange(frames) / 25
    pieces, hits = shot_pieces(0.83)
    tracks = sample(pieces, times)
    for name in ("x", "y", "theta", "vx", "vy", "omega"):
        tracks[f"sd_{name}"] = 0.004 if name in ("x", "y") else 0.02
    tracks["seen"] = 1
    tracks["team"] = tracks["stone"].map({"A": "#d8c020", "B": "#b02030"}).fillna("")
    tracks.loc[(tracks["stone"] == "B") & tracks["frame"].between(60, 70), "seen"] = 0
    collisions = tuple(collision(hit, pieces) for hit in hits)
    simulations = {
        "point-mass": sample(shot_pieces(0.80)[0], times),
        "rigid-body": sample(shot_pieces(0.5)[0], times),
        "frictional": sample(shot_pieces(0.84)[0], times),
    }
    results = Results(
        input=Input(('clips/take 7 <best> & "last".mp4',), 25.0, frames, float(times[-1])),
        restitution=Estimate(0.8312345, 0.0123456),
        friction=Friction(0.01093456, 0.00041234),
        collisions=collisions,
        glides=(
            Glide("A", 0.04, 0.76, 0.0112, 0.0011),
            Glide("C", 1.52, 6.76, 0.01091, 0.00012),
            Glide("B", 1.52, 1.6, None, None),
        ),
        simulations={
            "point-mass": SimulationScore(
                0.0312, {"A": 0.0213, "B": 0.0411, "C": 0.0987}, None, simulated_hits(0.80)
            ),
            "rigid-body": SimulationScore(None, {}, "no spins after the hit could be measured"),
            "frictional": SimulationScore(0.0123, {"A": 0.011, "B": None, "C": 0.0219}),
        },
        methods={
            "local": Method(
                Estimate(0.83, 0.02),
                Estimate(0.0109, 4e-4),
                NotedEstimate(),
                (Estimate(0.83, 0.02),),
            ),
            "shot_fit": Method(Estimate(0.831, 0.012), note="one fit"),
        },
        model_selection=(
            Law("ice fit", 4.7, 0.087, Estimate(0.0111, 6e-4)),
            Law("ice constant", 0.0, 0.913, Estimate(0.0109, 4e-4)),
        ),
        curl=NotedEstimate(None, None, "no curl shows"),
        stones={"A": StoneResult(Estimate(0.0112, 0.0011), Estimate(), 1.1, Estimate(0.66, 0.01))},
        joint_estimate=JointEstimate(
            ("restitution", "friction", "stone_friction"),
            (0.8312345, 0.01093456, 0.05),
            ((1.5e-4, 1e-7, 2e-6), (1e-7, 1.7e-7, 0.0), (2e-6, 0.0, 1e-4)),
        ),
        warnings=("clip ends after 170 of 175 frames <used as far as it goes>",),
    )
    stones = tuple(
        StoneStart(name, *map(float, (*p.place, *p.velocity)), p.omega)
        for name, (p, *_) in pieces.items()
    )
    laws = Frictional(0.8312345, 0.05), Constant(0.01093456), FCV1Curl(0.006, 0.0125)
    ensemble = Ensemble(0.0, Throw(stones, *laws, RADIUS), ())
    return Shot(tracks[list(TRACK_COLUMNS)], simulations, results, ensemble)


def simulated_hits(e: float) -> tuple[SimulatedHit, ...]:
    pieces, hits = shot_pieces(e)
    states = [collision(hit, pieces) for hit in hits]
    return tuple(SimulatedHit(c.t, 0.003, c.stones, c.before, c.after) for c in states)


def collision(hit: tuple[float, str, str, Vector], pieces: dict[str, list[Piece]]) -> Hit:
    t, first, second, n = hit
    before, after = {}, {}
    for name in (first, second):
        late = next(p for p in pieces[name] if p.t == t)
        early = pieces[name][pieces[name].index(late) - 1]
        place, velocity = early.at(t)
        sd = (0.002, 0.003, 0.012, 0.015, 0.021)
        before[name] = MeasuredState(*map(float, (*place, *velocity)), early.omega, *sd)
        after[name] = MeasuredState(*map(float, (*place, *late.velocity)), late.omega, *sd)
    return Hit(
        t=t, stderr_t=0.0021, stones=(first, second), normal=(float(n[0]), float(n[1])),
        restitution=0.83, stderr=0.02, before=before, after=after, momentum_residual=0.013,
        stderr_momentum=0.006, energy_lost=0.15, stone_friction=None,
        note=None if first == "A" else "the angle of the hit is known to 8° only",
    )  # fmt: skip
