"""What each stone tells by itself: friction, the turn of its path, its spin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from curlshot.data.results import Estimate, Glide, Hit, StoneResult
from curlshot.physics.statistics.random_effects import random_effects


def results_by_stone(glides: Sequence[Glide], collisions: Sequence[Hit]) -> dict[str, StoneResult]:
    """Gather glides and spins by stone.

    Parameters
    ----------
    glides : sequence of Glide
        Of all stones.
    collisions : sequence of Hit
        In order of time.

    Returns
    -------
    dict of str to StoneResult
        Of the stones that glide or take part in a hit, in the order of their names.
    """
    stones = sorted({g.stone for g in glides} | {name for hit in collisions for name in hit.stones})
    return {stone: _result(stone, glides, collisions) for stone in stones}


def _result(stone: str, glides: Sequence[Glide], collisions: Sequence[Hit]) -> StoneResult:
    own = [glide for glide in glides if glide.stone == stone]
    speeds = [glide.speed for glide in own if glide.speed is not None]
    return StoneResult(
        _mean([(glide.friction, glide.stderr) for glide in own]),
        _mean([(glide.turn_rate, glide.stderr_turn_rate) for glide in own]),
        float(np.mean(speeds)) if speeds else None,
        _spin(stone, collisions),
    )


def _mean(found: Sequence[tuple[float | None, float | None]]) -> Estimate:
    """Mean over the glides of a stone, which differ as those of all stones do."""
    known = [(value, sd) for value, sd in found if value is not None and sd]
    values, errors = np.array(known, float).reshape(-1, 2).T
    return random_effects(values, np.diag(errors**2)).mean


def _spin(stone: str, collisions: Sequence[Hit]) -> Estimate:
    """Spin before the first hit of a stone that moves then, else after it."""
    for hit in collisions:
        if stone in hit.stones:
            before, after = hit.before[stone], hit.after[stone]
            state = before if np.hypot(before.vx, before.vy) > 0.01 else after
            return Estimate(state.omega, state.sd_omega)
    return Estimate()
