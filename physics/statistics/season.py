"""Many shots side by side: a table of shots, a table of hits, and what all of them say."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from curlshot.data.results import Hit, Results
from curlshot.physics.statistics.pool import FRICTION_SCATTER, RESTITUTION_SCATTER, Pooled, pool

SHOT_COLUMNS = (
    "shot", "hits", "restitution", "stderr_restitution", "friction", "stderr_friction", "law",
    "warnings", "note",
)  # fmt: skip
HIT_COLUMNS = (
    "shot", "t", "first", "second", "restitution", "stderr", "closing_speed",
    "momentum_residual", "stderr_momentum", "energy_lost", "note",
)  # fmt: skip

SCATTER = {"restitution": RESTITUTION_SCATTER, "friction": FRICTION_SCATTER}
"""Scales of the priors of what shots differ by."""

POSSIBLE = {"restitution": (0.0, 1.0), "friction": (0.0, np.inf)}
"""What e and μ of any shot lie between; a measured value may be off by its error."""


def repeated(season: Mapping[str, Results]) -> dict[str, str]:
    """Find shots that are another before them, to the last digit: name to that one's name."""
    first: list[tuple[str, Results]] = []
    found = {}
    for name, shot in season.items():
        same = next((other for other, known in first if _same(shot, known)), None)
        if same is None:
            first.append((name, shot))
        else:
            found[name] = same
    return found


def _same(one: Results, two: Results) -> bool:
    told = bool(one.collisions or one.glides)
    return told and all(
        getattr(one, name) == getattr(two, name)
        for name in ("collisions", "glides", "restitution", "friction")
    )


def shots_table(season: Mapping[str, Results]) -> pd.DataFrame:
    """One row per shot: e and μ with their errors (`SHOT_COLUMNS`).

    Where one is not known it is NaN, and ``note`` says why.
    """
    rows = [
        (
            name,
            len(shot.collisions),
            shot.restitution.value,
            shot.restitution.stderr,
            shot.friction.value,
            shot.friction.stderr,
            shot.friction.law,
            len(shot.warnings),
            why_unknown(shot, [name for name in SCATTER if getattr(shot, name).value is None]),
        )
        for name, shot in season.items()
    ]
    return _numbers(rows, SHOT_COLUMNS, texts=("shot", "law", "note"))


def why_unknown(shot: Results, names: Sequence[str]) -> str:
    """Return what the warnings of a shot have about ``restitution`` or ``friction``."""
    # What is said of the friction between stones is not of the ice.
    about = re.compile("|".join(rf"\b{name}\b(?! between)" for name in names) or "(?!)")
    return "; ".join(warning for warning in shot.warnings if about.search(warning))


def hits_table(season: Mapping[str, Results]) -> pd.DataFrame:
    """One row per hit (`HIT_COLUMNS`), speeds in m/s, NaN where not known."""
    rows = [
        (
            name,
            hit.t,
            *hit.stones,
            hit.restitution,
            hit.stderr,
            closing_speed(hit),
            hit.momentum_residual,
            hit.stderr_momentum,
            hit.energy_lost,
            hit.note or "",
        )
        for name, shot in season.items()
        for hit in shot.collisions
    ]
    return _numbers(rows, HIT_COLUMNS, texts=("shot", "first", "second", "note"))


def closing_speed(hit: Hit) -> float:
    """Speed at which the stones came together along the normal, m/s."""
    first, second = (hit.before[name] for name in hit.stones)
    return float(np.dot(hit.normal, (first.vx - second.vx, first.vy - second.vy)))


def pooled(shots: pd.DataFrame) -> dict[str, Pooled]:
    """Give the season's e and μ from the table of its shots; see `physics.statistics.pool`."""
    out = {}
    for name, scatter in SCATTER.items():
        known = shots[[name, f"stderr_{name}"]].dropna()
        known = known[known[f"stderr_{name}"] > 0]
        out[name] = pool(known[name].tolist(), known[f"stderr_{name}"].tolist(), scatter)
    return out


def _numbers(
    rows: Sequence[tuple[object, ...]], columns: tuple[str, ...], texts: tuple[str, ...]
) -> pd.DataFrame:
    table = pd.DataFrame(rows, columns=list(columns))
    return table.astype({name: float for name in columns if name not in texts})
