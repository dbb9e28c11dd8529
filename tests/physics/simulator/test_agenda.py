from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from physics.simulator.agenda import Agenda, Pair

pairs = st.sampled_from([(i, j) for j in range(4) for i in range(j)])
times = st.one_of(st.floats(0, 10), st.just(math.inf))


@given(st.lists(st.tuples(pairs, times, st.booleans())), st.floats(0, 10))
def test_the_last_word_on_each_pair_counts(
    said: list[tuple[Pair, float, bool]], until: float
) -> None:
    agenda = Agenda()
    known = {}
    for pair, t, exact in said:
        agenda.expect(t, pair, exact=exact)
        known[pair] = (t, pair, exact)
        assert agenda.first() == min(t for t, _, _ in known.values())
    due = sorted(one for one in known.values() if one[0] <= until and one[0] < math.inf)
    assert sorted(agenda.due(until)) == due
    assert sorted(agenda.due(until)) == due  # asking takes nothing away
    for t, pair, _ in due:
        assert agenda.time(pair) == t


def test_what_is_dropped_is_not_expected() -> None:
    agenda = Agenda()
    for t, pair in ((1.0, (0, 1)), (2.0, (0, 2)), (3.0, (1, 2))):
        agenda.expect(t, pair, exact=True)
    agenda.drop((0, 1))
    assert agenda.first() == 2.0
    agenda.drop_all_of(0)
    assert agenda.due(10.0) == [(3.0, (1, 2), True)]
    agenda.drop_all_of(2)
    assert agenda.first() == math.inf
