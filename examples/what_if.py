"""What if the stone had been thrown 5 cm to the left.

Run it as ``python examples/what_if.py RUN``. RUN is the folder that `curlshot run` wrote.
"""

from __future__ import annotations

import sys

import curlshot

if not sys.argv[1:]:
    print("usage: python examples/what_if.py RUN", file=sys.stderr)
    sys.exit(2)
run = curlshot.load(sys.argv[1])

for words, changes in (
    ("as thrown", {}),
    ("5 cm to the left", {"aim_offset": 0.05}),
    ("a tenth faster", {"speed": "1.1x"}),
):
    # Each throw is a little off, as players throw and stones are known.
    _, odds = curlshot.simulate(run, **changes).throw(200)
    print(words)
    for name, stone in odds["stones"].items():
        if stone["moved"] > 0.5:
            inside, shot = stone["in_house"], stone["shot_stone"]
            print(f"  {name}: in the house {inside:.0%}, shot stone {shot:.0%}")
