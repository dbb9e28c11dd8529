"""Restitution and friction of a shot beside those of the literature."""

from __future__ import annotations

import pandas as pd

from data.results import Results
from data.sheet import STONE

LITERATURE = {
    "restitution": (0.83, 0.06, None, None, "Barnes et al., Icarus (granite spheres)"),
    "friction": (None, None, 0.006, 0.016, "Li et al., 2022, Lubricants 10, 265"),
}
"""Value, its standard error or the range, and source of what others measured."""


def law_table(results: Results) -> pd.DataFrame:
    """Measured restitution and frictions beside those of the literature (the paper's Table 1).

    Only discs of a curling stone's size are compared.

    Returns
    -------
    DataFrame
        ``quantity, symbol, value, stderr, literature, stderr_literature, low, high, source``.
    """
    curling = abs(results.radius / STONE.radius - 1) < 0.1
    laws = results.laws
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
