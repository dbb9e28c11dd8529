"""A priority queue of the contacts to come."""

from __future__ import annotations

import math
from heapq import heappop, heappush

Pair = tuple[int, int]
Expected = tuple[float, Pair, bool]
"""Time of a contact, s, or where it is not exact the earliest that it can be; its pair."""


class EventQueue:
    """The next contact of each pair of stones, if any; the earliest of all comes first."""

    def __init__(self) -> None:
        self._by_pair: dict[Pair, Expected] = {}
        # A heap of all that was ever expected; entries that have been replaced are skipped.
        self._queue: list[Expected] = []

    def expect(self, t: float, pair: Pair, *, exact: bool) -> None:
        """Put a contact in place of what was expected of the pair; none where `t` is infinite."""
        if t == math.inf:
            self.drop(pair)
            return
        self._by_pair[pair] = expected = (t, pair, exact)
        heappush(self._queue, expected)

    def drop(self, pair: Pair) -> None:
        """Expect no contact of a pair."""
        self._by_pair.pop(pair, None)

    def drop_all_of(self, stone: int) -> None:
        """Expect no contact of a stone."""
        self._by_pair = {pair: due for pair, due in self._by_pair.items() if stone not in pair}

    def time(self, pair: Pair) -> float:
        """Time at which a contact of a pair is expected, s."""
        return self._by_pair[pair][0]

    def first(self) -> float:
        """Time of the first contact, s; infinity where none is expected."""
        while self._queue and self._by_pair.get(self._queue[0][1]) is not self._queue[0]:
            heappop(self._queue)
        return self._queue[0][0] if self._queue else math.inf

    def due(self, until: float) -> list[Expected]:
        """List what is expected by then; it stays expected."""
        out = []
        while self._queue and self._queue[0][0] <= until:
            expected = heappop(self._queue)
            if self._by_pair.get(expected[1]) is expected:
                out.append(expected)
        for expected in out:
            heappush(self._queue, expected)
        return out
