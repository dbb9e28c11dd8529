from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import strategies as st

from curlshot.data.errors import InputError
from curlshot.data.results import (
    Estimate,
    JointEstimate,
    Law,
    NotedEstimate,
    SimulationScore,
    TrackResidual,
)
from curlshot.data.results_file import SCHEMA, read_results, results_json, write_results
from curlshot.tests.helpers.data.results_file import RESULTS, strict


def test_round_trip(tmp_path: Path) -> None:
    write_results(RESULTS, tmp_path / "results.json")
    assert read_results(tmp_path / "results.json") == RESULTS


def test_messages_name_options_in_the_file_and_settings_in_python(tmp_path: Path) -> None:
    warned = replace(
        RESULTS,
        input=replace(RESULTS.input, files=("a --fps `fps`.mp4",)),
        curl=NotedEstimate(note="see `check`"),
        warnings=("wrong frame rate (`fps`)",),
    )
    write_results(warned, tmp_path / "results.json")
    raw = json.loads((tmp_path / "results.json").read_text("utf-8"))
    assert raw["warnings"] == ["wrong frame rate (--fps)"]
    assert (raw["curl"]["note"], raw["input"]["files"]) == (
        "see curlshot check",
        ["a --fps `fps`.mp4"],
    )
    assert read_results(tmp_path / "results.json") == warned


VERSION_1 = """{
 "schema": 1,
 "input": {"files": ["shot.mp4"], "fps": 25.0, "frames": 150, "duration": 5.96},
 "restitution": {"value": 0.83, "stderr": 0.02},
 "friction": {"value": 0.011, "stderr": 0.0003, "law": "constant", "a": null, "v_c": null,
  "b": null},
 "collisions": [],
 "glides": [{"stone": "A", "t0": 1.2, "t1": 5.5, "friction": 0.011, "stderr": 0.0004,
  "turn": 0.002, "stderr_turn": 0.001, "speed": 1.2}],
 "simulations": {},
 "warnings": ["two frames are missing"],
 "radius": 0.145,
 "predictions": {"frictional": {"rmse": 0.03, "rest_error": {"A": 0.05}, "rest_sd": {"A": 0.2},
  "restitution": {"value": 0.85, "stderr": 0.05}, "friction": {"value": 0.01, "stderr": 0.001},
  "note": null, "error_after": {"A": 0.04}, "sd_after": {"A": 0.06}}},
 "laws": {"names": ["friction"], "values": [0.011], "cov": [[1e-8]]},
 "methods": {"global": {"restitution": {"value": 0.83, "stderr": 0.02},
  "friction": {"value": 0.011, "stderr": 0.0003},
  "stone_friction": {"value": null, "stderr": null, "note": null}, "hits": [], "note": null}},
 "law_choice": [{"name": "ice constant", "criterion": 0.0, "weight": 1.0,
  "friction": {"value": 0.011, "stderr": 0.0003}}],
 "curl": {"value": 0.008, "stderr": 0.001, "note": null},
 "stones": {"A": {"friction": {"value": 0.011, "stderr": 0.0004},
  "turn": {"value": 0.002, "stderr": 0.001}, "speed": 1.2,
  "spin": {"value": 0.6, "stderr": 0.1}}},
 "misfits": [{"stone": "A", "t0": 1.2, "t1": 5.5, "size": 6.1, "certain": true,
  "left_out": false}],
 "posterior": null,
 "masses": {},
 "teams": {"A": "#d8c020"},
 "sheet": false
}"""


def test_a_file_of_version_1_is_read(tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    path.write_text(VERSION_1, encoding="utf-8")
    old = read_results(path)
    assert old.joint_estimate == JointEstimate(("friction",), (0.011,), ((1e-8,),))
    assert old.model_selection == (Law("ice constant", 0.0, 1.0, Estimate(0.011, 3e-4)),)
    assert old.residuals == (TrackResidual("A", 1.2, 5.5, 6.1, True, False),)
    assert not old.origin_at_tee
    assert old.methods["shot_fit"].restitution == Estimate(0.83, 0.02)
    assert (old.glides[0].turn_rate, old.glides[0].stderr_turn_rate) == (0.002, 0.001)
    assert old.stones["A"].turn_rate == Estimate(0.002, 0.001)
    guess = old.predictions["frictional"]
    assert guess.error_at_comparison == {"A": 0.04}
    assert guess.sd_at_comparison == {"A": 0.06}
    write_results(old, path)
    assert strict(path.read_text(encoding="utf-8"))["schema"] == 2
    assert read_results(path) == old


def test_the_form_of_the_file() -> None:
    raw = strict(results_json(RESULTS))
    assert raw["schema"] == SCHEMA == 2
    assert set(raw) == {
        *("schema", "input", "restitution", "friction", "collisions", "glides"),
        *("simulations", "warnings", "radius", "predictions", "joint_estimate", "methods"),
        "model_selection",
        *("curl", "stones", "residuals", "posterior", "masses", "teams"),
        "origin_at_tee",
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


numbers = st.one_of(st.none(), st.floats())


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not a results.json"),
        ("{", "not a results.json"),
        ("[]", "not a results.json"),
        ("3", "not a results.json"),
        ("null", "not a results.json"),
        ("{}", "not a results.json"),
        ('{"schema": 3}', "another version"),
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
