"""States of the stones at the hits, measured and simulated, and in the axes of a hit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.results import Hit, MeasuredState, SimulatedHit, SimulationScore

Array = NDArray[np.float64]

STATE_COLUMNS = ("x", "y", "vx", "vy", "omega")
COLUMNS = (
    *("hit", "t", "stderr_t", "stone", "when"),
    *STATE_COLUMNS,
    *(f"sd_{name}" for name in STATE_COLUMNS),
)


def in_axes(
    state: MeasuredState, normal: tuple[float, float]
) -> tuple[tuple[float, float | None], tuple[float, float | None]]:
    """Velocity along a hit's normal and its tangent, each with its standard error, m/s.

    The tangent is the normal turned a quarter to the left. Errors of vx and vy are taken as
    independent; that of the normal is left out.
    """
    nx, ny = normal
    along = state.vx * nx + state.vy * ny
    across = state.vy * nx - state.vx * ny
    if state.sd_vx is None or state.sd_vy is None:
        return (along, None), (across, None)
    errors = (
        np.hypot(state.sd_vx * nx, state.sd_vy * ny),
        np.hypot(state.sd_vx * ny, state.sd_vy * nx),
    )
    return (along, float(errors[0])), (across, float(errors[1]))


def magnitude(x: Array, y: Array, sd_x: Array, sd_y: Array) -> tuple[Array, Array]:
    """Lengths of vectors and their standard deviations from those of their parts."""
    length = np.hypot(x, y)
    short = length < 1e-9
    along = np.hypot(x * sd_x, y * sd_y) / np.where(short, 1.0, length)
    return length, np.where(short, np.fmax(sd_x, sd_y), along)


def measured_table(collisions: Sequence[Hit]) -> pd.DataFrame:
    """Place, velocity and spin of both stones before and after each hit (the paper's Table 2).

    Returns
    -------
    DataFrame
        ``hit, t, stderr_t, stone, when, x, y, vx, vy, omega``, and ``sd_x`` to ``sd_omega``.
    """
    rows = [
        row for rank, hit in enumerate(collisions, 1) for row in _state_rows(rank, hit.stones, hit)
    ]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def simulated_table(score: SimulationScore, collisions: Sequence[Hit]) -> pd.DataFrame:
    """Return the same hits in a simulation (the paper's Tables 3 and 4).

    The k-th hit of two stones is the k-th measured one of them. A hit that the simulation does
    not have leaves NaN; one that only the simulation has comes last and has no number.

    Parameters
    ----------
    score : SimulationScore
        Of one model, with its hits.
    collisions : sequence of Hit
        The measured hits, which say what to look for.

    Returns
    -------
    DataFrame
        As `measured_table`.
    """
    left = list(score.hits)
    rows: list[dict[str, object]] = []
    for rank, collision in enumerate(collisions, 1):
        same = next((hit for hit in left if set(hit.stones) == set(collision.stones)), None)
        if same is not None:
            left.remove(same)
        rows += _state_rows(rank, collision.stones, same)
    for hit in left:
        rows += _state_rows(None, hit.stones, hit)
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _state_rows(
    rank: int | None, stones: tuple[str, str], hit: Hit | SimulatedHit | None
) -> list[dict[str, object]]:
    rows = []
    for stone in stones:
        for when in ("before", "after"):
            row: dict[str, object] = {"hit": rank, "stone": stone, "when": when}
            if hit is not None:
                row |= {"t": hit.t, "stderr_t": hit.stderr_t}
                state = (hit.before if when == "before" else hit.after).get(stone)
                row |= {} if state is None else asdict(state)
            rows.append(row)
    return rows
