"""What a whole fit begins with, and how far it may go."""

from __future__ import annotations

import math

import numpy as np

from physics.estimate import estimate
from physics.local_fit.contacts import find_contacts
from physics.simulator.motion import Motion, Path
from physics.whole_shot.shot_model import curl, ice
from tests.physics.watch import RADIUS, hit_motion, watch


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
