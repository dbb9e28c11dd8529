"""What is told of how well the ice of a clip is measured: a row of a table, and all in one line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from curlshot.benchmarks.views import Clip

Array = NDArray[np.float64]

FOLLOWING, FINDING = 4.0, 150.0
"""Bars of CPU time, ms, at 1080p."""

COVERED = 0.92, 0.98
"""Bars of the share of errors within two standard errors."""


@dataclass
class Score:
    """Errors of one clip, m; `scaled` in stated standard errors."""

    clip: Clip
    frames: int
    due: int = 0
    lost: int = 0
    only_carried: int = 0
    false: int = 0
    house: list[Array] = field(default_factory=list)
    carried: list[Array] = field(default_factory=list)
    high: list[Array] = field(default_factory=list)
    guards: list[Array] = field(default_factory=list)
    scaled: list[Array] = field(default_factory=list)
    parts: list[Array] = field(default_factory=list)
    first: float = float("nan")
    following: float = float("nan")
    finding: float = float("nan")
    decoding: float = float("nan")


def rms(errors: Sequence[Array]) -> float:
    """Root of the mean squared distance, NaN for none."""
    if not errors:
        return float("nan")
    return float(np.sqrt((np.concatenate(errors) ** 2).sum(-1).mean()))


def percentile(errors: Sequence[Array], q: float) -> float:
    if not errors:
        return float("nan")
    return float(np.percentile(np.linalg.norm(np.concatenate(errors), axis=-1), q))


HEAD = (
    f"{'clip':<18} {'bar':>4} {'rms':>6} {'95 %':>5} {'max':>6}  {'high':>6} {'guards':>6}"
    f" {'carried':>7} {'first':>6} {'lost':>12}  {'in 2 sd':>10}  {'ms':>5} {'read':>4} {'find':>5}"
)


def flag(value: float, bar: float) -> str:
    return "!" if not value <= bar else " "


def line(score: Score, with_parts: bool) -> str:
    bar = score.clip.bar
    house, high = 1e3 * rms(score.house), 1e3 * rms(score.high)
    lost = f"{score.lost}+{score.only_carried}/{score.due}"
    if score.false:
        lost += f" false {score.false}"
    within, ratio = coverage(score.scaled)
    text = (
        f"{score.clip.name:<18} {bar:>4.1f} {house:>5.1f}{flag(house, bar)}"
        f" {1e3 * percentile(score.house, 95):>5.1f} {1e3 * percentile(score.house, 100):>6.1f} "
        f" {high:>5.1f}{flag(high, 2 * bar)} {1e3 * rms(score.guards):>6.1f}"
        f" {1e3 * rms(score.carried):>7.1f} {1e3 * score.first:>6.1f}"
        f" {lost:>11}{flag(score.lost, 0)}  {within:>5.2f} {ratio:>4.1f}"
        f"  {1e3 * score.following:>4.1f}{flag(1e3 * score.following, FOLLOWING)}"
        f" {1e3 * score.decoding:>4.1f}"
        f" {1e3 * score.finding:>4.0f}{flag(1e3 * score.finding, FINDING)}"
    )
    if with_parts and score.parts:
        shift, turn, scale, rest = 1e3 * np.sqrt(np.mean(np.square(score.parts), axis=0))
        text += f"  shift {shift:.1f} turn {turn:.1f} scale {scale:.1f} rest {rest:.1f}"
    return text


def coverage(scaled: Sequence[Array]) -> tuple[float, float]:
    """Share of scaled errors within two, and their rms."""
    if not scaled:
        return float("nan"), float("nan")
    every = np.concatenate(scaled)
    return float((np.abs(every) < 2).mean()), float(np.sqrt((every**2).mean()))


def summary(scores: Sequence[Score]) -> str:
    """Bars met over all clips; every clip has the same say in the coverage."""
    shares = [coverage(s.scaled) for s in scores if s.scaled]
    share, ratio = (float(v) for v in np.mean(shares, axis=0)) if shares else (np.nan, np.nan)
    met = sum(1e3 * rms(s.house) <= s.clip.bar for s in scores)
    high = sum(1e3 * rms(s.high) <= 2 * s.clip.bar for s in scores)
    lost, carried, due = (
        sum(values)
        for values in zip(*((s.lost, s.only_carried, s.due) for s in scores), strict=True)
    )
    ms = 1e3 * float(np.mean([s.following for s in scores]))
    find = 1e3 * float(np.mean([s.finding for s in scores]))
    covered = " " if COVERED[0] <= share <= COVERED[1] else "!"
    return (
        f"clips within the bar {met} of {len(scores)}, high points {high} of {len(scores)};"
        f" frames lost {lost} and only carried {carried} of {due};"
        f" within two sd {share:.3f}{covered}, errors over stated {ratio:.2f};"
        f" following {ms:.1f} ms, finding {find:.0f} ms"
    )
