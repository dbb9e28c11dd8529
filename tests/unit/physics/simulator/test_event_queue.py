from __future__ import annotations

import math

from curlshot.physics.simulator.event_queue import EventQueue


def test_what_is_dropped_is_not_expected() -> None:
    events = EventQueue()
    for t, pair in ((1.0, (0, 1)), (2.0, (0, 2)), (3.0, (1, 2))):
        events.expect(t, pair, exact=True)
    events.drop((0, 1))
    assert events.first() == 2.0
    events.drop_all_of(0)
    assert events.due(10.0) == [(3.0, (1, 2), True)]
    events.drop_all_of(2)
    assert events.first() == math.inf
