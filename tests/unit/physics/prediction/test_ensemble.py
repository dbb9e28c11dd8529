from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from curlshot.data.errors import InputError
from curlshot.physics.ice import Fit, Penner
from curlshot.physics.impact import Frictional, PointMass
from curlshot.physics.prediction.ensemble import Ensemble, read_ensemble, write_ensemble
from curlshot.physics.simulator.simulation import Shot, StoneStart
from curlshot.tests.helpers.physics.measured import measured


def test_what_is_written_is_read(tmp_path: Path) -> None:
    ensemble = measured()[2]
    laws = Fit(0.002, 0.06, 0.006), Penner(0.009)
    others = [replace(ensemble.likely, ice=ice) for ice in laws]
    ensemble = replace(ensemble, start=0.25, others=others)
    write_ensemble(ensemble, tmp_path / "ensemble.json")
    assert read_ensemble(tmp_path / "ensemble.json") == ensemble


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"schema": 7}, "run again"),
        ({"start": None}, "run again"),
        ({"shots": []}, "run again"),
        ({"shots": [{}]}, "run again"),
        ({"radius": -1.0}, "radius = -1 must be above 0"),
        ({"radius": None}, "run again"),
        ({"stones": []}, "run again"),
        ({"impact": {"name": "point-mass", "restitution": 0.8}}, "run again"),
    ],
)
def test_what_is_none_is_refused(tmp_path: Path, change: dict[str, Any], message: str) -> None:
    path = tmp_path / "ensemble.json"
    write_ensemble(measured()[2], path)
    raw = json.loads(path.read_text())
    of_file = change.keys() & raw.keys()
    (raw if of_file else raw["shots"][1]).update(change)
    path.write_text(json.dumps(raw))
    with pytest.raises(InputError, match=message):
        read_ensemble(path)


def test_names_are_texts(tmp_path: Path) -> None:
    path = tmp_path / "ensemble.json"
    write_ensemble(measured()[2], path)
    path.write_text(path.read_text().replace('"name": "A"', '"name": 5'))
    assert {shot.stones[0].name for shot in read_ensemble(path).others} == {"5"}


@pytest.mark.parametrize("content", ["", "{", "[]", "7", '"text"'])
def test_rubbish_is_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / "ensemble.json"
    path.write_text(content)
    with pytest.raises(InputError, match=r"not an ensemble\.json"):
        read_ensemble(path)


def test_another_model_keeps_restitution_and_friction() -> None:
    stones = StoneStart("A", 0, -1, 0, 1), StoneStart("B", 0, 0)
    shots = [Shot(stones, Frictional(e, 0.07)) for e in (0.8, 0.75, 1.2)]
    other = Ensemble(2.0, shots[0], shots[1:]).by(PointMass(0.1))
    assert other.likely.impact == PointMass(0.8)
    assert [shot.impact for shot in other.others] == [PointMass(0.75), PointMass(1.0)]
    bouncy = Ensemble(2.0, shots[0], ())
    assert bouncy.by(Frictional(0.2, 0.0)).likely == shots[0]
