"""``results.json``: the results of a run, written as strict JSON and read again."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

from curlshot.data.errors import InputError
from curlshot.data.files import write_text
from curlshot.data.messages import as_options, as_settings
from curlshot.data.results import (
    Estimate,
    Friction,
    Glide,
    Hit,
    Input,
    JointEstimate,
    Law,
    MeasuredState,
    Method,
    NotedEstimate,
    Posterior,
    Prediction,
    Results,
    SimulatedHit,
    SimulationScore,
    StoneResult,
    TrackResidual,
)

SCHEMA = 2
"""Version of the file's form."""

MESSAGES = ("warnings", "note", "note_stone_friction")
"""Keys of messages; the file spells the settings in them as options of the command."""

RENAMED_TOP = {
    "laws": "joint_estimate",
    "law_choice": "model_selection",
    "misfits": "residuals",
    "sheet": "origin_at_tee",
}
"""Keys of version 1 at the top of the file, and their names since version 2."""

RENAMED_IN = {
    "methods": {"global": "shot_fit"},
    "glides": {"turn": "turn_rate", "stderr_turn": "stderr_turn_rate"},
    "stones": {"turn": "turn_rate"},
    "predictions": {"error_after": "error_at_comparison", "sd_after": "sd_at_comparison"},
    "residuals": {"size": "rms_ratio", "certain": "significant", "left_out": "downweighted"},
}
"""By key of the top, in its new name: keys of version 1 in its items, and their new names."""

_Made = TypeVar("_Made")


def results_json(results: Results) -> str:
    """Return the text of ``results.json``: strict JSON, values that are not finite as null."""
    content = _respelled(_plain({"schema": SCHEMA, **asdict(results)}), as_options)
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False)


def write_results(results: Results, path: Path) -> None:
    """Write ``results.json`` whole or not at all."""
    write_text(path, results_json(results) + "\n")


def read_results(path: Path) -> Results:
    """Read a ``results.json``, of version 1 too.

    Raises
    ------
    InputError
        Where the file is missing or not a ``results.json``.
    """
    try:
        raw = json.loads(path.read_text(encoding="utf-8"))
        schema = raw.pop("schema")
        if schema not in (1, SCHEMA):
            raise InputError(f"{path}: results of another version; run again")
        if schema == 1:
            raw = _from_version_1(raw)
        raw = _respelled(raw, as_settings)
        return Results(
            input=_made(Input, {**raw["input"], "files": tuple(raw["input"]["files"])}),
            restitution=_made(Estimate, raw["restitution"]),
            friction=_made(Friction, raw["friction"]),
            collisions=tuple(_collision(item) for item in raw["collisions"]),
            glides=tuple(_made(Glide, item) for item in raw["glides"]),
            simulations={name: _simulated(item) for name, item in raw["simulations"].items()},
            warnings=tuple(raw["warnings"]),
            radius=_length(raw["radius"]),
            predictions={
                name: _prediction(item) for name, item in raw.get("predictions", {}).items()
            },
            joint_estimate=_joint(raw.get("joint_estimate")),
            methods={name: _method(item) for name, item in raw.get("methods", {}).items()},
            model_selection=tuple(
                _made(Law, _with_estimates(item, "friction"))
                for item in raw.get("model_selection", ())
            ),
            curl=_made(NotedEstimate, raw.get("curl", {})),
            stones={
                name: _made(StoneResult, _with_estimates(item, "friction", "turn_rate", "spin"))
                for name, item in raw.get("stones", {}).items()
            },
            residuals=tuple(_made(TrackResidual, item) for item in raw.get("residuals", ())),
            posterior=(_made(Posterior, raw["posterior"]) if raw.get("posterior") else None),
            masses={str(name): _length(mass) for name, mass in raw.get("masses", {}).items()},
            teams={str(name): str(team) for name, team in raw.get("teams", {}).items()},
            origin_at_tee=bool(raw.get("origin_at_tee", True)),
        )
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError, AttributeError):
        raise InputError(f"{path}: not a results.json of this program") from None


def _respelled(value: Any, spell: Callable[[str], str], message: bool = False) -> Any:
    """Return JSON values with the settings spelled in another way in all messages of them."""
    if isinstance(value, dict):
        return {key: _respelled(item, spell, key in MESSAGES) for key, item in value.items()}
    if isinstance(value, list):
        return [_respelled(item, spell, message) for item in value]
    return spell(value) if message and isinstance(value, str) else value


def _from_version_1(raw: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of a file of version 1 with the names of version 2."""
    new = {RENAMED_TOP.get(key, key): value for key, value in raw.items()}
    new["methods"] = _renamed(new.get("methods", {}), RENAMED_IN["methods"])
    for key in ("glides", "residuals"):
        new[key] = [_renamed(item, RENAMED_IN[key]) for item in new.get(key, ())]
    for key in ("stones", "predictions"):
        items = new.get(key, {}).items()
        new[key] = {name: _renamed(item, RENAMED_IN[key]) for name, item in items}
    return new


def _renamed(item: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """Return a mapping with new names of some keys."""
    return {names.get(key, key): value for key, value in item.items()}


def _collision(item: dict[str, Any]) -> Hit:
    nx, ny = item["normal"]
    return _made(Hit, {**item, **_sides(item), "normal": (nx, ny)})


def _simulated(item: dict[str, Any]) -> SimulationScore:
    hits = tuple(_made(SimulatedHit, {**hit, **_sides(hit)}) for hit in item.get("hits", ()))
    return _made(SimulationScore, {**item, "hits": hits})


def _sides(hit: dict[str, Any]) -> dict[str, Any]:
    """Read who hit whom, and their states before and after."""
    first, second = hit["stones"]
    states = {
        when: {name: _made(MeasuredState, hit[when][name]) for name in (first, second)}
        for when in ("before", "after")
    }
    return {"stones": (first, second), **states}


def _made(kind: type[_Made], item: Mapping[str, Any]) -> _Made:
    """Make a value of what JSON gave; TypeError where a number is none."""
    made = kind(**item)
    for name, hint in get_type_hints(kind).items():
        value = getattr(made, name)
        absent = value is None and hint == float | None
        if hint in (float, float | None) and not (absent or type(value) in (int, float)):
            raise TypeError(f"{name} is no number")
    return made


def _length(value: Any) -> float:
    if type(value) not in (int, float) or not 0 < value < math.inf:
        raise TypeError("not a length or mass")
    return float(value)


def _prediction(item: dict[str, Any]) -> Prediction:
    return _made(Prediction, _with_estimates(item, "restitution", "friction"))


def _method(item: dict[str, Any]) -> Method:
    hits = tuple(_made(Estimate, hit) for hit in item["hits"])
    sliding = _made(NotedEstimate, item["stone_friction"])
    own = _with_estimates(item, "restitution", "friction")
    return _made(Method, {**own, "stone_friction": sliding, "hits": hits})


def _with_estimates(item: dict[str, Any], *names: str) -> dict[str, Any]:
    """Make the estimates of an item of these names."""
    return {**item, **{name: _made(Estimate, item[name]) for name in names}}


def _joint(item: dict[str, Any] | None) -> JointEstimate | None:
    if item is None:
        return None
    names, cov = tuple(item["names"]), tuple(tuple(map(float, row)) for row in item["cov"])
    if {len(names)} != {len(item["values"]), len(cov), *map(len, cov)}:
        raise ValueError("names, values and covariance do not fit")
    return JointEstimate(names, tuple(map(float, item["values"])), cov)


def _plain(value: Any) -> Any:
    """Reduce to what JSON knows; numbers that are not finite become None."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if value is None or isinstance(value, (str, bool, int)):
        return value
    number = float(value)
    return number if math.isfinite(number) else None
