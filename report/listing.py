"""Which tables a report shows, and which of their columns."""

from __future__ import annotations

import re
from collections.abc import Mapping

import pandas as pd

from curlshot.data.coach_units import METRES, Unit
from curlshot.data.results import Prediction, Results, SimulationScore
from curlshot.data.sheet import House
from curlshot.physics.local_fit.glides import WORST
from curlshot.report import tables
from curlshot.report.coach_listing import coach_tables
from curlshot.report.columns import Column, Table
from curlshot.report.numbers import assumed

_STATES = (
    Column("hit", "hit", kind="word"),
    Column("time", "t", "s", stderr="stderr_t", decimals=4),
    Column("stone", "stone", kind="word"),
    Column("", "when", kind="word"),
    *(Column(n, n, "m", stderr=f"sd_{n}", decimals=4) for n in ("x", "y")),
    Column("v_x", "vx", "m/s", stderr="sd_vx", decimals=4),
    Column("v_y", "vy", "m/s", stderr="sd_vy", decimals=4),
    Column("ω", "omega", "rad/s", stderr="sd_omega", decimals=4),
)
_LAWS = (
    Column("", "quantity", kind="word"),
    Column("", "symbol", kind="word"),
    Column("this shot", "value", stderr="stderr"),
    Column("literature", "literature", stderr="stderr_literature"),
    Column("from", "low", digits=2),
    Column("to", "high", digits=2),
    Column("source", "source", kind="note"),
)
_STONES = (
    Column("stone", "stone", kind="word"),
    Column("from", "t0", "s", decimals=2),
    Column("to", "t1", "s", decimals=2),
    Column("frames", "frames", decimals=0),
    Column("seen", "seen", "%", decimals=0, factor=100),
    Column("first x", "x0", "m", decimals=3),
    Column("first y", "y0", "m", decimals=3),
    Column("last x", "x1", "m", decimals=3),
    Column("last y", "y1", "m", decimals=3),
    Column("way", "path", "m", decimals=3),
    Column("top speed", "top_speed", "m/s", decimals=3),
    Column("turned", "turned", "rad", decimals=2),
    Column("sd", "sd", "mm", factor=1000),
)
_HITS = (
    Column("hit", "hit", kind="word"),
    Column("time", "t", "s", stderr="stderr_t", decimals=4),
    Column("stones", "stones", kind="word"),
    Column("n_x", "nx", decimals=3),
    Column("n_y", "ny", decimals=3),
    Column("e", "restitution", stderr="stderr"),
    Column("momentum missing", "momentum_residual", stderr="stderr_momentum"),
    Column("energy lost", "energy_lost", "%", decimals=0, factor=100),
    Column("friction between stones", "stone_friction", stderr="stderr_stone_friction"),
    Column("note", "note", kind="note"),
    Column("note on that friction", "note_stone_friction", kind="note"),
)
_GLIDES = (
    Column("stone", "stone", kind="word"),
    Column("from", "t0", "s", decimals=2),
    Column("to", "t1", "s", decimals=2),
    Column("μ", "friction", stderr="stderr"),
)
_CHOICES = (
    Column("laws", "laws", kind="word"),
    Column("weight", "weight", "%", decimals=1, factor=100),
    Column("criterion", "criterion", decimals=1),
    Column("μ at 1 m/s", "friction", stderr="stderr"),
)
_ICE = (
    Column("stone", "stone", kind="word"),
    Column("μ", "friction", stderr="sd_friction"),
    Column("turn", "turn_rate", "rad/s", stderr="sd_turn_rate"),
    Column("mean speed", "speed", "m/s", decimals=3),
    Column("spin", "spin", "rad/s", stderr="sd_spin"),
)
_PAPER = {"rigid-body": 3, "point-mass": 4}
"""Numbers that the models have as tables of the study."""


def page_tables(
    results: Results,
    tracks: pd.DataFrame,
    house: House | None = None,
    unit: Unit = METRES,
) -> list[Table]:
    """Give the tables of a shot in their order; those without a row are left out.

    Parameters
    ----------
    results : Results
        What the run found out.
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS` and, where known, a column ``team``.
    house : House, optional
        The rings; without a house there are no tables for coaches.
    unit : Unit
        Of the tables for coaches; all others are SI.

    Returns
    -------
    list of Table
        The page shows their ``title``, ``note``, ``head`` and ``rows``;
        `curlshot.report.typeset.write_tables` writes them as files.
    """
    hits = tables.hit_table(results.collisions)
    if len(hits):
        hits["stones"] = hits["first"] + " on " + hits["second"]
    made = [
        *([] if house is None else coach_tables(results, tracks, house, unit)),
        Table(
            "table_1_laws",
            "Restitution and friction",
            "Literature as value ± standard error, or as the measured range.",
            _LAWS,
            tables.law_table(results),
        ),
        Table(
            "table_2_measured",
            "Measured before and after each hit",
            "Places and velocities of the centres, and spins, at the instant of contact, from"
            " fits before and after it.",
            _STATES,
            tables.measured_table(results.collisions),
        ),
        *_simulated(results),
        Table("stones", "Stones", "", _STONES, tables.stone_table(tracks)),
        Table(
            "hits",
            "Hits",
            "The normal n points from the first stone to the second. Momentum missing is"
            " |Σv′ − Σv| / |Σv|, zero for a perfect measurement.",
            _HITS,
            hits,
        ),
        _methods(results),
        Table(
            "laws_tried",
            "Laws tried in the shot fit",
            "The criterion is minus twice the log probability of the detections, minus that of"
            " the best choice. The weight is the probability of these laws. The errors include"
            " the differences between the choices.",
            _CHOICES,
            tables.choice_table(results),
        ),
        Table(
            "glides",
            "Glides",
            f"Friction of each free glide with an error of {WORST:g} or less. Shorter glides are"
            " left out, and those slower than one radius a second.",
            _GLIDES,
            tables.glide_table(results.glides),
        ),
        Table(
            "ice",
            "The ice by stone",
            "Turn rate of the path, left positive, at the mean speed of the glides."
            f" {_curl(results)}",
            _ICE,
            tables.ice_table(results),
        ),
        _scores(results),
        _predicted(results),
    ]
    return [table for table in made if len(table.frame)]


def _curl(results: Results) -> str:
    note = results.curl.note or ""
    return f"{note[:1].upper()}{note[1:]}." if note else ""


def _methods(results: Results) -> Table:
    hits = [
        Column(f"e of hit {rank}", f"hit {rank}", stderr=f"sd_hit {rank}")
        for rank in range(1, len(results.collisions) + 1)
    ]
    return Table(
        "methods",
        "Restitution and friction by method",
        "Local: from the paths just before and after the hits. Shot fit: one fit of the whole"
        " shot. Finite differences: the method of the study.",
        (
            Column("method", "method", kind="word"),
            Column("e", "restitution", stderr="sd_restitution"),
            *hits,
            Column("μ", "friction", stderr="sd_friction"),
            Column("μₛ", "stone_friction", stderr="sd_stone_friction"),
            Column("note", "note", kind="note"),
        ),
        tables.method_table(results),
    )


def _simulated(results: Results) -> list[Table]:
    start = "start of the shot fit" if results.joint_estimate else "state before the first hit"
    order = sorted(results.simulations, key=lambda model: (_PAPER.get(model, 5), model))
    return [
        Table(
            f"table_{_PAPER.get(model, 5 + k - len(_PAPER))}_{_plain(model)}",
            f"Simulated before and after each hit: {model}",
            f"From the {start}. — where the simulation has no such hit. The errors come from"
            " those of the start and of the laws.",
            _STATES,
            tables.simulated_table(results.simulations[model], results.collisions),
        )
        for k, model in enumerate(order)
        if results.simulations[model].hits
    ]


def _scores(results: Results) -> Table:
    how = (
        "with the laws and the start of the shot fit"
        if results.joint_estimate
        else "from the state before the first hit"
    )
    return _off(
        "models",
        "Simulated against measured",
        f"The shot simulated {how}.",
        results.simulations,
    )


def _predicted(results: Results) -> Table:
    known = {name: guess for name, guess in results.predictions.items() if guess.rmse is not None}
    how = next(map(assumed, known.values()), "")
    return _off(
        "predictions",
        "Predicted against measured",
        f"From the motion before the first hit and prior knowledge of μ, with {how}.",
        known,
    )


def _off(
    name: str,
    title: str,
    note: str,
    scores: Mapping[str, SimulationScore] | Mapping[str, Prediction],
) -> Table:
    last_places = [
        Column(f"last place of {stone}", stone, "mm", stderr=f"sd_{stone}", factor=1000)
        for stone in tables.scored_stones(scores)
    ]
    return Table(
        name,
        title,
        f"{note} Root mean square distance over all stones and times after the first hit;"
        " distance of the last places ± its expected size, one standard error.",
        (
            Column("model", "model", kind="word"),
            Column("rms", "rmse", "mm", factor=1000),
            *last_places,
            Column("note", "note", kind="note"),
        ),
        tables.score_table(scores),
    )


def _plain(name: str) -> str:
    return re.sub(r"[^\w-]+", "_", name)
