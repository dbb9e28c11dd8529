from __future__ import annotations

import argparse

from hypothesis import given
from hypothesis import strategies as st

from curlshot.cli import values
from curlshot.data.limits import POSITIVE, SAMPLES


@given(
    st.sampled_from(
        [values.within(POSITIVE), values.amount, values.speed, values.whole(SAMPLES),
         values.throw_sd, values.frame_range, values.stick, values.house, values.mass, values.pair]
    ),
    st.text(alphabet="0123456789.,:=x-+eEnaif ²٣", max_size=12),
)  # fmt: skip
def test_any_text_is_read_or_refused(read, text: str) -> None:
    try:
        read(text)
    except argparse.ArgumentTypeError as refusal:
        assert repr(text) in str(refusal) or "expected" not in str(refusal)
