"""How often unused cycles of objects are looked for."""

from __future__ import annotations

import atexit
import gc

BETWEEN = 200_000
"""Objects that are made between two looks. Python's 700 cost a fortieth of the whole time, and one
look at all that is imported two hundredths of a second; what holds pictures is in no cycle and
goes at once."""


def collect_seldom() -> None:
    """Look for unused cycles of objects hundreds of times less often than Python does by itself.

    And for none at the end, when all goes with the process.
    """
    gc.set_threshold(BETWEEN)
    atexit.register(gc.freeze)
