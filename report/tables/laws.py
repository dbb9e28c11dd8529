"""Restitution and friction of a shot: beside the literature, by method, by law, by stone."""

from __future__ import annotations

import pandas as pd

from curlshot.data.results import Results
from curlshot.data.sheet import curling_size

LITERATURE = {
    "restitution": (0.83, 0.06, None, None, "Barnes et al., Icarus (granite spheres)"),
    "friction": (None, None, 0.006, 0.016, "Li et al., 2022, Lubricants 10, 265"),
}
"""Value, its standard error or the range, and source of what others measured."""

_ICE = (
    "stone", "friction", "sd_friction", "turn_rate", "sd_turn_rate", "speed", "spin", "sd_spin",
)  # fmt: skip


def law_table(results: Results) -> pd.DataFrame:
    """Measured restitution and frictions beside those of the literature (the paper's Table 1).

    Only discs of a curling stone's size are compared.

    Returns
    -------
    DataFrame
        ``quantity, symbol, value, stderr, literature, stderr_literature, low, high, source``.
    """
    curling = curling_size(results.radius)
    laws = results.joint_estimate
    rows: list[dict[str, object]] = [
        {"quantity": "coefficient of restitution", "symbol": "e", **vars(results.restitution)},
        {
            "quantity": "coefficient of friction of the ice",
            "symbol": "μ",
            "value": results.friction.value,
            "stderr": results.friction.stderr,
        },
    ]
    if laws is not None and "stone_friction" in laws.names:
        k = laws.names.index("stone_friction")
        rows.append(
            {
                "quantity": "coefficient of friction between stones",
                "symbol": "μₛ",
                "value": laws.values[k],
                "stderr": laws.cov[k][k] ** 0.5,
            }
        )
    keys = ("literature", "stderr_literature", "low", "high", "source")
    for row, name in zip(rows, LITERATURE, strict=False):
        if curling:
            row |= dict(zip(keys, LITERATURE[name], strict=True))
    return pd.DataFrame(rows, columns=["quantity", "symbol", "value", "stderr", *keys])


def method_table(results: Results) -> pd.DataFrame:
    """Give restitution and frictions as each method has them, one row a method.

    Returns
    -------
    DataFrame
        ``method, restitution, sd_restitution, friction, sd_friction, stone_friction,
        sd_stone_friction, note``, and ``hit 1, sd_hit 1`` and so on with the restitution of each
        hit.
    """
    rows = []
    for name, method in results.methods.items():
        rub = method.stone_friction
        row: dict[str, object] = {"method": name}
        told = {
            "restitution": method.restitution,
            "friction": method.friction,
            "stone_friction": rub,
            **{f"hit {rank}": hit for rank, hit in enumerate(method.hits, 1)},
        }
        for key, value in told.items():
            row |= {key: value.value, f"sd_{key}": value.stderr}
        row["note"] = "; ".join(note for note in (method.note, rub.note) if note) or None
        rows.append(row)
    keys = ["restitution", "friction", "stone_friction"]
    keys += [f"hit {rank}" for rank in range(1, len(results.collisions) + 1)]
    columns = ["method", *(name for key in keys for name in (key, f"sd_{key}")), "note"]
    return pd.DataFrame(rows, columns=columns)


def choice_table(results: Results) -> pd.DataFrame:
    """Give the laws that the whole shot was fitted with, the best first.

    Returns
    -------
    DataFrame
        ``laws, weight, criterion, friction, stderr``: `weight` is the probability of a choice,
        `criterion` minus twice the log probability of the detections, less that of the best.
    """
    rows = [
        {
            "laws": law.name,
            "weight": law.weight,
            "criterion": law.criterion,
            "friction": law.friction.value,
            "stderr": law.friction.stderr,
        }
        for law in sorted(results.model_selection, key=lambda law: law.criterion)
    ]
    return pd.DataFrame(rows, columns=["laws", "weight", "criterion", "friction", "stderr"])


def ice_table(results: Results) -> pd.DataFrame:
    """Give what each stone tells of the ice by itself.

    Returns
    -------
    DataFrame
        ``stone, friction, sd_friction, turn_rate, sd_turn_rate, speed, spin, sd_spin``:
        `turn_rate` of its path to the left, rad/s, at its mean `speed`, m/s; `spin` as it is
        first seen to move, rad/s.
    """
    rows = [
        {
            "stone": name,
            "friction": stone.friction.value,
            "sd_friction": stone.friction.stderr,
            "turn_rate": stone.turn_rate.value,
            "sd_turn_rate": stone.turn_rate.stderr,
            "speed": stone.speed,
            "spin": stone.spin.value,
            "sd_spin": stone.spin.stderr,
        }
        for name, stone in results.stones.items()
    ]
    return pd.DataFrame(rows, columns=list(_ICE))
