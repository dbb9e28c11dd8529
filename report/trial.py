"""The measured shot as the page throws it again, and the sliders that change it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import pandas as pd

from curlshot.data.results import Results
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.physics.prediction.laws import friction_at_1
from curlshot.physics.prediction.start import measured_start
from curlshot.physics.registry import model, models
from curlshot.physics.simulator.simulation import StoneStart
from curlshot.physics.simulator.values import shot_values


@dataclass(frozen=True)
class Slider:
    """A slider of the page: what it sets, from where to where, and where it stands at first.

    All numbers are texts with `decimals` decimals, on the grid of `step`.
    """

    key: str
    label: str
    unit: str
    decimals: int
    low: str
    high: str
    step: str
    value: str


def trial(tracks: pd.DataFrame, results: Results, ensemble: Ensemble) -> dict[str, Any]:
    """Give the shot as it began, as the page's simulator takes it.

    Returns
    -------
    dict
        ``shot`` (see `curlshot.physics.simulator.values.shot_values`), ``thrown`` (its rank),
        ``laws`` to choose from, ``spins_known`` (whether the rigid-body model can run),
        ``assumed``.

    Raises
    ------
    InputError
        Where no stone moves before the first hit.
    """
    start = measured_start(tracks, results, ensemble)
    spins = {stone.name: _spins_after(stone, results) for stone in start.shot.stones}
    stones = tuple(replace(s, omega_after=spins[s.name] or None) for s in start.shot.stones)
    return {
        "shot": shot_values(replace(start.shot, stones=stones)),
        "thrown": start.thrown,
        "laws": {
            family: {name: _usual(kind) for name, kind in models(family).items()}
            for family in ("ice", "curl")
        },
        "spins_known": all(spins.values()),
        "assumed": list(start.assumed.values()),
    }


def sliders(what_if: Mapping[str, Any]) -> list[Slider]:
    """Give the sliders for a `trial`, each at the measured value."""
    shot = what_if["shot"]
    stone, impact = shot["stones"][what_if["thrown"]], shot["impact"]
    name, speed = stone["name"], math.hypot(stone["vx"], stone["vy"])
    friction = friction_at_1(model("ice", **shot["ice"]))
    spin = 1.5 * abs(stone["omega"])
    return [
        _slider("restitution", "Restitution e", "", 3, 0.0, 1.0, impact["restitution"]),
        _slider("friction", "Friction of the ice μ", "", 4, 0.002, 0.02, friction),
        _slider("rub", "Friction between stones μₛ", "", 3, 0.0, 0.5, impact["stone_friction"]),
        _slider("speed", f"Speed of {name}", " m/s", 2, 0.1, max(4.0, 1.5 * speed), speed),
        _slider("aim", f"Aim of {name}, to its left", " cm", 1, -50.0, 50.0, 0.0),
        _slider(
            "spin", f"Spin of {name}", " rad/s", 2, -max(5, spin), max(5, spin), stone["omega"]
        ),
    ]


def _slider(
    key: str, label: str, unit: str, decimals: int, low: float, high: float, value: float
) -> Slider:
    step = 10.0**-decimals
    ends = min(low, value), max(high, value)
    first, last = math.floor(ends[0] / step) * step, math.ceil(ends[1] / step) * step
    texts = (f"{number:.{decimals}f}" for number in (first, last, step, value))
    return Slider(key, label, unit, decimals, *texts)


def _spins_after(stone: StoneStart, results: Results) -> tuple[float, ...]:
    """Spins of a stone after its hits, its own if it had none; empty if one is not known."""
    spins = [h.after[stone.name].omega for h in results.collisions if stone.name in h.stones]
    known = tuple(spin for spin in spins if spin is not None)
    if len(known) < len(spins):
        return ()
    return known or (stone.omega,)


def _usual(kind: type[Any]) -> dict[str, Any]:
    law = kind()
    return {"name": law.name, **asdict(law)}
