"""The outcome of a command in a few lines of text, or as plain values."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from curlshot.data.coach_units import METRES, Unit
from curlshot.data.results import Hit, Results, SimulationScore
from curlshot.data.sheet import House
from curlshot.physics.prediction.forecast import AFTER
from curlshot.physics.simulator.simulation import Simulation
from curlshot.physics.statistics.pool import Pooled
from curlshot.physics.statistics.season import POSSIBLE, SCATTER
from curlshot.report.numbers import assumed, count, plus_minus, warned
from curlshot.report.tables import moving_stones, rest_table, shot_stone

FEW_HITS = 4
"""Hits that a prompt of Python lists."""
WIDEST = 100
"""Letters of a line there."""


def odds_text(odds: Mapping[str, Any], written: Sequence[Path]) -> list[str]:
    """Where a shot thrown many times ends; `odds` as in ``whatif.json``."""
    lines = [
        f"{odds['thrown']} thrown {count(odds['samples'], 'time')}, at rest"
        f"{' (mean ± spread)' if odds['samples'] > 1 else ''}:",
    ]
    for name, item in odds["stones"].items():
        if item["x"] is None:
            lines.append(f"  {name}  always leaves the sheet")
            continue
        x, y = (f"{item[k]:+7.2f}{_spread(item[f'sd_{k}'])} m" for k in "xy")
        line = f"  {name}  x {x}   y {y}   moved {item['moved']:4.0%}"
        if item["in_play"] is not None:
            line += f"   in play {item['in_play']:4.0%}"
        if item["in_house"] is not None:
            line += (
                f"   in the house {item['in_house']:4.0%}   shot stone {item['shot_stone']:4.0%}"
            )
        lines.append(line)
    return [*lines, f"written: {', '.join(map(str, written))}"]


def _spread(sd: float | None) -> str:
    """Write a spread, m; nothing where there is none."""
    return "" if sd is None else f" ± {sd:.2f}"


def simulation_json(simulation: Simulation) -> dict[str, Any]:
    """Rest positions and hits of a simulation as plain values, for ``--json``."""
    return {
        "stones": {
            name: {
                "x": rest.x,
                "y": rest.y,
                "theta": rest.theta,
                "t": rest.t,
                "in_play": rest.in_play,
            }
            for name, rest in simulation.rest.items()
        },
        "hits": [
            {
                "t": hit.t,
                "stones": list(hit.stones),
                "normal": list(hit.normal),
                "before": {name: vars(state) for name, state in hit.before.items()},
                "after": {name: vars(state) for name, state in hit.after.items()},
            }
            for hit in simulation.hits
        ],
    }


def simulation_text(simulation: Simulation, written: Sequence[Path] = ()) -> str:
    """Rest positions and hits of a simulation, and the files that have it."""
    lines = ["at rest:"]
    lines += [
        f"  {name}  x {rest.x:+8.3f} m   y {rest.y:+8.3f} m   after {rest.t:6.2f} s"
        f"{'' if rest.in_play else '   (where it left the sheet)'}"
        for name, rest in simulation.rest.items()
    ]
    lines.append("hits:" if simulation.hits else "no hits")
    lines += [f"  {hit.t:6.3f} s  {hit.stones[0]} on {hit.stones[1]}" for hit in simulation.hits]
    if written:
        lines.append(f"written: {', '.join(map(str, written))}")
    return "\n".join(lines)


def season_text(shots: pd.DataFrame, pooled: Mapping[str, Pooled]) -> list[str]:
    """One line per shot, what it cannot tell and why below it, and what all say together."""
    cells = [
        (
            shot["shot"],
            count(int(shot["hits"]), "hit"),
            f"e = {plus_minus(shot['restitution'], shot['stderr_restitution'])}",
            f"μ = {plus_minus(shot['friction'], shot['stderr_friction'])}",
        )
        for shot in shots.to_dict("records")
    ]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = []
    for row, why_not in zip(cells, shots["note"], strict=True):
        lines.append("   ".join(map(str.ljust, row, widths)).rstrip())
        lines += [f"{'':{widths[0]}s}   {why_not}"] if why_not else []
    for name, sign in (("restitution", "e"), ("friction", "μ")):
        mean = pooled[name]
        text = f"{name:<11s} {sign} = {plus_minus(mean.value, mean.stderr)}"
        text += f" of {count(mean.shots, 'shot')}"
        if mean.scatter is not None:
            text += f"; shot to shot {plus_minus(mean.scatter, mean.stderr_scatter)}"
        elif mean.shots:
            text += f"; scatter from shot to shot assumed to be about {SCATTER[name]:g}"
        lines.append(text)
    return [*lines, *warned(impossible(shots))]


def impossible(shots: pd.DataFrame) -> list[str]:
    """Name the e and μ of a season's shots that cannot be."""
    said = []
    for name, sign in (("restitution", "e"), ("friction", "μ")):
        low, high = POSSIBLE[name]
        said += [
            f"{shot['shot']}: {sign} = {plus_minus(shot[name], shot[f'stderr_{name}'])} is"
            " impossible; it counts in the mean with its error"
            for shot in shots.to_dict("records")
            if shot[name] < low or shot[name] > high
        ]
    return said


def _law(name: str) -> str:
    """Name a law of ice, and the speed of its μ where that depends on speed."""
    return name if name == "constant" else f"{name}, at 1 m/s"


def _watched(results: Results, used: int) -> str:
    """How much was read, and of how much of it the stones are known."""
    read, lasts = results.input.frames, f"{results.input.duration:.2f} s"
    if used < read:
        return f"{count(read, 'frame')}; stones in {used} of them, over {lasts}"
    return f"{count(read, 'frame')}, {lasts}"


def summary(
    results: Results,
    tracks: pd.DataFrame,
    out: Path | None = None,
    house: House | None = None,
    unit: Unit = METRES,
    *,
    marked: bool = False,
) -> str:
    """Put the outcome into a dozen lines that a person can read; `unit` of lengths.

    Of tracks that were `marked` by hand it says what is taken for the tee.
    """
    lines = _measured(results, tracks, results.collisions)
    for text, errors in _simulated(results, unit, results.simulations):
        lines += [f"simulated   {text}", *errors]
    for model, guess in results.predictions.items():
        if guess.rmse is not None:
            lines.append(
                f"predicted   {model}, from before the first hit, {assumed(guess)}:"
                f" {unit.little(guess.rmse)} RMS error"
            )
            lines += _each(
                f"{AFTER} s after hit 1",
                guess.error_at_comparison,
                guess.sd_at_comparison,
                unit,
            )
            lines += _each(f"{'at the end':18s}", guess.rest_error, guess.rest_sd, unit)
            lines += [f"            {guess.note}"] if guess.note else []
    notes = [guess.note for guess in results.predictions.values()]
    if all(guess.rmse is None for guess in results.predictions.values()) and any(notes):
        lines.append(f"predicted   — ({next(filter(None, notes))})")
    if house is not None and marked:
        lines.append("house       the origin is assumed to be its tee (`no_house` if it is not)")
    if house is not None and len(tracks):
        lines.append(f"shot stone  {shot_stone_text(results, tracks, house, unit)}")
    return "\n".join([*lines, *warned(results.warnings), *_written(out)])


def brief(results: Results, tracks: pd.DataFrame, out: Path | None, unit: Unit = METRES) -> str:
    """Put the outcome into ten lines, for a prompt of Python; `unit` of lengths."""
    lines = _measured(results, tracks, results.collisions[:FEW_HITS])
    more = len(results.collisions) - FEW_HITS
    if more > 0:
        lines.insert(-2, f"            and {count(more, 'more hit')}")
    lines += [f"simulated   {text}" for text in nearest_text(results, unit)]
    if results.warnings:
        lines.append(f"warnings    {len(results.warnings)}")
    return "\n".join([*(_cut(line) for line in lines), *_written(out)])


def nearest_model(results: Results) -> str | None:
    """Return the model whose simulation is nearest to the shot; None where none is compared."""
    known = [(score.rmse, name) for name, score in results.simulations.items()]
    return min(((rmse, name) for rmse, name in known if rmse is not None), default=(0, None))[1]


def nearest_text(results: Results, unit: Unit = METRES) -> list[str]:
    """Say how far the nearest simulation is from the shot; empty where none is compared."""
    name = nearest_model(results)
    if name is None:
        return []
    return [text for text, _ in _simulated(results, unit, {name: results.simulations[name]})]


def _cut(line: str) -> str:
    return line if len(line) <= WIDEST else f"{line[: WIDEST - 1]}…"


def _written(out: Path | None) -> list[str]:
    """Name the page that a run wrote, or its folder."""
    if out is None:
        return []
    report = out / "report.html"
    return [f"written     {report if report.exists() else out}"]


def _measured(results: Results, tracks: pd.DataFrame, collisions: Sequence[Hit]) -> list[str]:
    """Name the input, the stones, some hits, e and μ."""
    moved = moving_stones(tracks, results.collisions, results.radius)
    names = sorted(tracks["stone"].unique()) or sorted(results.stones)
    lines = [
        f"input       {', '.join(results.input.files[:3])}"
        f"{' …' if len(results.input.files) > 3 else ''}: "
        + _watched(results, tracks["frame"].nunique() or results.input.frames),
        f"stones      {len(names)} ({', '.join(names)}); moved: {', '.join(moved) or 'none'}",
    ]
    for hit in collisions:
        lines.append(
            f"hit         {hit.stones[0]} on {hit.stones[1]} at {hit.t:.3f} s: "
            f"e = {plus_minus(hit.restitution, hit.stderr)}"
        )
    law = "" if results.friction.value is None else f" ({_law(results.friction.law)})"
    return [
        *lines,
        f"restitution e = {plus_minus(results.restitution.value, results.restitution.stderr)}",
        f"friction    μ = {plus_minus(results.friction.value, results.friction.stderr)}{law}",
    ]


def _simulated(
    results: Results, unit: Unit, simulations: Mapping[str, SimulationScore]
) -> Iterator[tuple[str, list[str]]]:
    """Say of models how far their simulations are off, and how far each stone at the end."""
    for models, score in _alike(simulations):
        off = f"— ({score.note or 'nothing to compare'})"
        if score.rmse is not None:
            off = f"{unit.little(score.rmse)} RMS error"
        # Only a shot that was fitted as a whole begins with what fits it.
        how = "" if results.joint_estimate is None else ", fitted shot"
        yield f"{models}{how}: {off}", _each("at the end", score.rest_error, score.rest_sd, unit)


def _alike(
    simulations: Mapping[str, SimulationScore],
) -> Iterator[tuple[str, SimulationScore]]:
    """Names of the models that came to the same, as they do without a hit, and what it is."""
    left = dict(simulations)
    while left:
        score = next(iter(left.values()))
        same = [model for model, other in left.items() if other == score]
        yield ", ".join(same), score
        for model in same:
            del left[model]


def _each(
    when: str, errors: Mapping[str, float | None], stated: Mapping[str, float | None], unit: Unit
) -> list[str]:
    """Return the errors of the stones' places with their uncertainties, a few stones a line."""
    texts = [
        f"{stone} {unit.little(error, sd)} (± {unit.little(sd, error)})"
        for stone, error in errors.items()
        if error is not None and (sd := stated.get(stone)) is not None
    ]
    head = f"{'':12s}{when:15s} "
    rows = textwrap.wrap(
        ", ".join(text.replace(" ", "\xa0") for text in texts), WIDEST - len(head)
    )  # a stone and its numbers stay together
    return [
        f"{'' if k else head:{len(head)}s}{row}".replace("\xa0", " ") for k, row in enumerate(rows)
    ]


def shot_stone_text(results: Results, tracks: pd.DataFrame, house: House, unit: Unit) -> str:
    """Name the shot stone and its distance from the tee, or say why it is not known."""
    rest = rest_table(tracks, results.collisions, house, results.radius)
    name, why = shot_stone(rest)
    if name is None:
        return f"not known: {why}"
    distance = float(rest.loc[rest["stone"] == name, "to_tee"].iloc[0])
    return f"{name}, {unit.length(distance)} from the tee; {why}"
