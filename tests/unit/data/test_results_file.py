from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.data.results import (
    Estimate,
    SimulationScore,
)
from curlshot.data.results_file import SCHEMA, read_results, results_json, write_results
from curlshot.tests.helpers.data.results_file import RESULTS, strict


def test_round_trip(tmp_path: Path) -> None:
    write_results(RESULTS, tmp_path / "results.json")
    assert read_results(tmp_path / "results.json") == RESULTS


def test_the_form_of_the_file() -> None:
    raw = strict(results_json(RESULTS))
    assert raw["schema"] == SCHEMA == 1
    assert set(raw) == {
        *("schema", "input", "restitution", "friction", "collisions", "glides"),
        *("simulations", "warnings", "radius", "predictions", "laws", "methods", "model_selection"),
        *("curl", "stones", "misfits", "posterior", "masses", "teams"),
        "sheet",
    }
    assert raw["input"] == {
        "files": ["clip Ä.mp4"],
        "fps": 25.0,
        "frames": 150,
        "duration": 5.96,
    }
    constants = {"a": None, "v_c": None, "b": None}
    assert raw["friction"] == {"value": 0.0109, "stderr": 3e-4, "law": "constant", **constants}
    assert raw["collisions"][0]["stones"] == ["A", "B"]  # type: ignore[index]
    assert raw["collisions"][0]["before"]["B"]["omega"] is None  # type: ignore[index]
    assert raw["glides"][1]["friction"] is None  # type: ignore[index]


def test_what_is_not_finite_is_null(tmp_path: Path) -> None:
    odd = replace(
        RESULTS,
        restitution=Estimate(math.nan, math.inf),
        simulations={"frictional": SimulationScore(np.float64("nan"), {"A": -math.inf})},
        input=replace(RESULTS.input, frames=np.int64(7), fps=np.float32(25)),  # type: ignore[arg-type]
    )
    raw = strict(results_json(odd))
    assert raw["restitution"] == {"value": None, "stderr": None}
    assert raw["input"]["frames"] == 7  # type: ignore[index]
    write_results(odd, tmp_path / "results.json")
    back = read_results(tmp_path / "results.json")
    assert back.restitution == Estimate(None, None)
    assert back.simulations["frictional"].rest_error == {"A": None}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not a results.json"),
        ("{", "not a results.json"),
        ("[]", "not a results.json"),
        ("3", "not a results.json"),
        ("null", "not a results.json"),
        ("{}", "not a results.json"),
        ('{"schema": 2}', "another version"),
        ('{"schema": 1}', "not a results.json"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, text: str, reason: str) -> None:
    path = tmp_path / "results.json"
    path.write_text(text)
    with pytest.raises(InputError, match=reason):
        read_results(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"not a results\.json"):
        read_results(path)
    with pytest.raises(InputError, match="No such file"):
        read_results(tmp_path / "none.json")


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("collisions", 0, "t"), {}),
        (("collisions", 0, "t"), None),
        (("collisions", 0, "stone_friction"), "1.5"),
        (("collisions", 0, "before", "A", "vx"), "fast"),
        (("collisions", 0, "stones"), ["A", "Q"]),
        (("friction", "stderr"), "x"),
        (("restitution", "value"), True),
        (("glides", 0, "t0"), []),
        (("radius",), 0),
        (("radius",), "0.1455"),
    ],
)
def test_what_is_no_number_or_no_stone_is_refused(
    path: tuple[str | int, ...], value: object, tmp_path: Path
) -> None:
    content = json.loads(results_json(RESULTS))
    place = content
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    file = tmp_path / "results.json"
    file.write_text(json.dumps(content))
    with pytest.raises(InputError, match="not a results"):
        read_results(file)
