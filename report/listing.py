"""Which tables a report shows, and how each cell is written."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from markupsafe import Markup

from data.results import Results
from report import tables
from report.cells import data, data_pair, data_significant


@dataclass(frozen=True)
class Column:
    """One column of a table in the page: head, unit, and how a row's cell is written.

    `kind` is number, word or note: how the page sets it.
    """

    head: str
    cell: Callable[[Mapping[str, object]], str]
    unit: str = ""
    kind: str = "number"


@dataclass(frozen=True)
class Table:
    """One table of the page: heads and cells, ready to print."""

    title: str
    note: str
    head: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]


def page_tables(
    results: Results, tracks: pd.DataFrame, simulations: Mapping[str, pd.DataFrame]
) -> list[Table]:
    """Give the page's tables in their order; those without a row are left out."""
    collisions, radius = results.collisions, results.radius
    stones = [
        _text("stone"),
        _number("from", "t0", 2, "s"),
        _number("to", "t1", 2, "s"),
        _number("frames", "frames", 0),
        _number("seen", "seen", 0, "%", 100),
        _place("first at x, y", "x0", "y0"),
        _place("last at x, y", "x1", "y1"),
        _number("way", "path", 3, "m"),
        _number("top speed", "top_speed", 3, "m/s"),
        _number("turned", "turned", 2, "rad"),
        _millimetres("sd", "sd"),
    ]
    hits = [
        _text("hit"),
        _pair("time", "t", "stderr_t", "s"),
        Column("stones", lambda row: f"{row['first']} on {row['second']}", kind="word"),
        _number(Markup("n<sub>x</sub>"), "nx", 3),
        _number(Markup("n<sub>y</sub>"), "ny", 3),
        _pair("e", "restitution", "stderr"),
        _pair("momentum missing", "momentum_residual", "stderr_momentum"),
        _number("energy lost", "energy_lost", 0, "%", 100),
        _pair("stone on stone friction", "stone_friction", "stderr_stone_friction"),
        _text("note"),
    ]
    states = [
        _text("hit"),
        _text("stone"),
        _text("when", ""),
        *(_number(name, name, 3, "m") for name in ("x", "y")),
        _number(Markup("v<sub>x</sub>"), "vx", 4, "m/s"),
        _number(Markup("v<sub>y</sub>"), "vy", 4, "m/s"),
        _number("ω", "omega", 4, "rad/s"),
    ]
    glides = [
        _text("stone"),
        _number("from", "t0", 2, "s"),
        _number("to", "t1", 2, "s"),
        _pair("μ", "friction", "stderr"),
    ]
    scores = tables.score_table(results.simulations)
    last_places = [
        _millimetres(f"last place of {name}", str(name))
        for name in scores.columns
        if name not in ("model", "rmse", "note")
    ]
    made = [
        _table("Stones", "", tables.stone_table(tracks), stones),
        _table(
            "Hits",
            "The normal n points from the first stone to the second. Momentum missing is"
            " |Σv′ − Σv| / |Σv|, zero for a perfect measurement.",
            tables.hit_table(collisions),
            hits,
        ),
        _table(
            "Measured before and after each hit",
            "Places and velocities of the centres at the instant of contact, from fits to either"
            " side of it.",
            tables.measured_table(collisions),
            states,
        ),
        *(
            _table(
                f"Simulated before and after each hit: {model}",
                "At the samples on either side of the hit; — where the simulation has no such hit.",
                tables.simulated_table(table, collisions, radius),
                states,
            )
            for model, table in simulations.items()
        ),
        _table(
            "Glides", "Friction of each free glide.", tables.glide_table(results.glides), glides
        ),
        _table(
            "Simulated against measured",
            "Root mean square distance over all stones and times after the first hit, and the"
            " distance of the last places.",
            scores,
            [_text("model"), _millimetres("rms", "rmse"), *last_places, _text("note")],
        ),
    ]
    return [table for table in made if table.rows]


def _table(title: str, note: str, frame: pd.DataFrame, columns: Sequence[Column]) -> Table:
    records = frame.to_dict("records")
    cells = tuple(
        tuple(c.cell({str(k): v for k, v in r.items()}) for c in columns) for r in records
    )
    # A column of notes that has none to say would only take room.
    kept = [k for k, c in enumerate(columns) if c.kind != "note" or any(row[k] for row in cells)]
    return Table(
        title,
        note,
        tuple(columns[k] for k in kept),
        tuple(tuple(row[k] for k in kept) for row in cells),
    )


def _text(key: str, head: str | None = None) -> Column:
    def cell(row: Mapping[str, object]) -> str:
        value = row[key]
        return "" if value is None or value != value else str(value)

    return Column(key if head is None else head, cell, kind="note" if key == "note" else "word")


def _number(head: str, key: str, decimals: int, unit: str = "", factor: float = 1.0) -> Column:
    return Column(head, lambda row: data(_value(row[key]), decimals, factor), unit)


def _millimetres(head: str, key: str) -> Column:
    return Column(head, lambda row: data_significant(_value(row[key]), 3, 1000), "mm")


def _pair(head: str, key: str, stderr: str, unit: str = "") -> Column:
    return Column(head, lambda row: data_pair(_value(row[key]), _value(row[stderr])), unit)


def _place(head: str, x: str, y: str) -> Column:
    def cell(row: Mapping[str, object]) -> str:
        return Markup("{}, {}").format(data(_value(row[x])), data(_value(row[y])))

    return Column(head, cell, "m")


def _value(cell: object) -> float | None:
    if isinstance(cell, (int, float, np.integer, np.floating)) and np.isfinite(cell):
        return float(cell)
    return None
