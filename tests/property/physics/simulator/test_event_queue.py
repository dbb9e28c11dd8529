from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from curlshot.physics.simulator.event_queue import EventQueue, Pair

pairs = st.sampled_from([(i, j) for j in range(4) for i in range(j)])
times = st.one_of(st.floats(0, 10), st.just(math.inf))


@given(st.lists(st.tuples(pairs, times, st.booleans())), st.floats(0, 10))
def test_the_last_word_on_each_pair_counts(
    said: list[tuple[Pair, float, bool]], until: float
) -> None:
    events = EventQueue()
    known = {}
    for pair, t, exact in said:
        events.expect(t, pair, exact=exact)
        known[pair] = (t, pair, exact)
        assert events.first() == min(t for t, _, _ in known.values())
    due = sorted(one for one in known.values() if one[0] <= until and one[0] < math.inf)
    assert sorted(events.due(until)) == due
    assert sorted(events.due(until)) == due  # asking takes nothing away
    for t, pair, _ in due:
        assert events.time(pair) == t
