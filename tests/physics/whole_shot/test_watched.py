"""What a whole fit begins with, and how far it may go."""

from __future__ import annotations

import math

import numpy as np

from physics.estimate import estimate
from physics.local_fit.contacts import find_contacts
from physics.simulator.motion import Motion, Path
from physics.whole_shot.shot_model import curl, ice
from tests.physics.watch import RADIUS, hit_motion, watch
from tests.synthetic.physics import Start


def test_wherever_a_fit_may_go_stones_move_as_their_velocities_say() -> None:
    seen = watch(hit_motion(1.5, 0.06), np.random.default_rng(2))
    whole = estimate(seen, find_contacts(seen, RADIUS), radius=RADIUS).whole
    assert whole is not None
    unknowns = {unknown.name: unknown for unknown in whole.shots[0].unknowns}
    values = {"friction": unknowns["friction"].low, "turn": unknowns["turn"].high}
    path = Path(0.0, Motion(0.0, 0.0, 0.0, 0.0, 1.3, 1.0), ice(values), curl(values))
    for t in np.linspace(0.1, 5.0, 50).tolist():
        before, now, after = (path.at(t + shift) for shift in (-1e-4, 0.0, 1e-4))
        rate = (after.x - before.x) / 2e-4 - now.vx, (after.y - before.y) / 2e-4 - now.vy
        assert math.hypot(*rate) < 1e-4


def test_who_was_hit_out_of_sight_has_no_say_in_the_whole_shot() -> None:
    """C comes into view long after B has hit it: it was not on its way when the shot began."""
    motion = hit_motion(1.5, 0.05, after=3.0, others=[Start(0.02, 1.0)])
    assert len(motion.hits) == 2
    seen = watch(motion, np.random.default_rng(12), sd=0.001)
    again = motion.hits[1].t
    hidden = ((seen["stone"] == "B") & (seen["t"] > again - 0.1)) | (
        (seen["stone"] == "C") & (seen["t"] < again + 0.7)
    )
    seen = seen[~hidden].reset_index(drop=True)
    found = estimate(seen, find_contacts(seen, RADIUS), radius=RADIUS)
    assert found.whole is not None
    assert set(found.whole.shots[0].traces) == {"A", "B"}
    told = found.whole["restitution"]
    assert abs((told.value or 0.0) - 0.83) < 2.5 * (told.stderr or 0.0) < 0.01
