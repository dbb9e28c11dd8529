from __future__ import annotations

import math
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from curlshot.data.errors import InputError
from curlshot.tests.helpers.physics.shot import read

values = st.recursive(
    st.one_of(
        st.integers().map(str),
        st.floats().map(lambda x: repr(x) if math.isfinite(x) else "nan"),
        st.booleans().map(lambda b: str(b).lower()),
        st.sampled_from(["'fcv1'", "'A'", '"B"', "'frictional'", "1979-05-27", '"a\\nb"']),
    ),
    lambda inner: st.lists(inner, max_size=3).map(lambda items: f"[{', '.join(items)}]"),
    max_leaves=3,
)
keys = st.sampled_from(
    ["name", "x", "y", "vx", "vy", "omega", "omega_after", "mass", "theta", "model", "ice",
     "friction", "curl", "radius", "restitution", "inertia", "other"]
)  # fmt: skip
tables = st.tuples(
    st.sampled_from(["[physics]", "[[stone]]", "[[stone]]", "[other]", ""]),
    st.dictionaries(keys, values, max_size=5),
)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.lists(tables, max_size=4))
def test_nothing_but_a_shot_or_one_line(
    tmp_path: Path, content: list[tuple[str, dict[str, str]]]
) -> None:
    text = "\n".join(
        "\n".join([head, *(f"{key} = {value}" for key, value in body.items())])
        for head, body in content
    )
    try:
        shot = read(tmp_path, text)
    except InputError as error:
        assert "\n" not in str(error)
    else:
        assert shot.stones
