from __future__ import annotations

import subprocess
import sys


def test_cycles_are_looked_for_seldom_but_are() -> None:
    code = (
        "import gc; from curlshot.data.garbage import BETWEEN, collect_seldom; collect_seldom();"
        "before = gc.get_stats()[0]['collections'];"
        "held = [[] for _ in range(BETWEEN // 2)];"
        "middle = gc.get_stats()[0]['collections'];"
        "held += [[] for _ in range(2 * BETWEEN)];"
        "print(middle - before, gc.get_stats()[0]['collections'] > middle)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert told.stdout.split() == ["0", "True"]


def test_nothing_is_looked_for_at_the_end() -> None:
    code = (
        "import atexit, gc; from curlshot.data.garbage import collect_seldom;"
        "atexit.register(lambda: print(gc.get_freeze_count() > 0));"  # runs after what comes later
        "collect_seldom()"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert told.stdout.split() == ["True"]
