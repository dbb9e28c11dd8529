from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from curlshot.data.errors import InputError
from curlshot.data.results import (
    Estimate,
    Glide,
)
from curlshot.data.results_file import read_results, results_json
from curlshot.tests.helpers.data.results_file import RESULTS, strict

numbers = st.one_of(st.none(), st.floats())


@given(value=numbers, stderr=numbers, text=st.text())
def test_any_value_is_strict_json(value: float | None, stderr: float | None, text: str) -> None:
    results = replace(
        RESULTS,
        restitution=Estimate(value, stderr),
        warnings=(text,),
        glides=(Glide(text, 0.0, 1.0, value, stderr),),
    )
    raw = strict(results_json(results))
    known = value is not None and math.isfinite(value)
    assert raw["restitution"]["value"] == (value if known else None)  # type: ignore[index]
    assert raw["warnings"] == [text]


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    key=st.sampled_from(sorted(json.loads(results_json(RESULTS)))),
    value=st.recursive(
        st.one_of(st.none(), st.integers(), st.text(max_size=5), st.booleans()),
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
        max_leaves=4,
    ),
)
def test_damaged_results_are_read_or_refused(tmp_path: Path, key: str, value: object) -> None:
    raw = json.loads(results_json(RESULTS))
    raw[key] = value
    path = tmp_path / "results.json"
    path.write_text(json.dumps(raw))
    try:
        read_results(path)
    except InputError as refusal:
        assert str(path) in str(refusal)
