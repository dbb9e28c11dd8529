"""Shots that may have been the one that was seen, and the file that keeps them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from curlshot.data.errors import InputError
from curlshot.data.files import write_text
from curlshot.physics.impact import Impact
from curlshot.physics.simulator.simulation import Shot, check_shot
from curlshot.physics.simulator.values import shot_of, shot_values

SCHEMA = 1
"""Version of the file's form."""


@dataclass(frozen=True)
class Ensemble:
    """Shots that may have been one that was seen.

    Attributes
    ----------
    start : float
        Time in the clip at which they begin, s.
    likely : Shot
        The one that fits best.
    others : sequence of Shot
        Equally likely ones, drawn from what its errors leave open.
    """

    start: float
    likely: Shot
    others: Sequence[Shot]

    def by(self, impact: Impact) -> Ensemble:
        """Return them with the hits of another model, with their own restitution and friction."""
        others = [_hit_by(other, impact) for other in self.others]
        return Ensemble(self.start, _hit_by(self.likely, impact), others)


def _hit_by(shot: Shot, impact: Impact) -> Shot:
    """Return a shot with the hits of another model, its restitution and friction kept."""
    own: dict[str, Any] = {}
    for item in fields(impact):  # type: ignore[arg-type]
        if hasattr(shot.impact, item.name):
            own[item.name] = getattr(shot.impact, item.name)
    own["restitution"] = min(own["restitution"], 1.0)
    return replace(shot, impact=replace(impact, **own))  # type: ignore[type-var]


def write_ensemble(ensemble: Ensemble, path: Path) -> None:
    """Write an ``ensemble.json`` whole or not at all: a line for each shot, the likely one first.

    `curlshot.physics.simulator.values.shot_values` tells what stands in a line.
    """
    shots = (json.dumps(shot_values(s)) for s in (ensemble.likely, *ensemble.others))
    head = f'{{"schema": {SCHEMA}, "start": {json.dumps(ensemble.start)}, "shots": ['
    write_text(path, head + "\n" + ",\n".join(shots) + "\n]}\n")


def read_ensemble(path: Path) -> Ensemble:
    """Read an ``ensemble.json``.

    Raises
    ------
    InputError
        Where the file is missing or no such thing, or a shot in it cannot be.
    """
    try:
        raw = json.loads(path.read_text(encoding="utf-8"))
        if raw["schema"] != SCHEMA:
            raise ValueError("another version")
        shots = [shot_of(values) for values in raw["shots"]]
        kinds = {(type(s.impact), *(stone.name for stone in s.stones)) for s in shots}
        if len(kinds) != 1:
            raise ValueError("not of the same stones and kind of hits")
        for shot in shots:
            check_shot(shot)
        return Ensemble(float(raw["start"]), shots[0], shots[1:])
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError, AttributeError):
        raise InputError(f"{path}: not an ensemble.json of this version; run again") from None
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
