"""What a whole fit begins with, and how far it may go."""

from __future__ import annotations

import math

import numpy as np
import pytest

from curlshot.physics.estimate import estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import estimate_locally
from curlshot.physics.shot_fit import observed
from curlshot.physics.shot_fit.priors import loose_priors
from curlshot.physics.shot_fit.shot_model import curl, ice
from curlshot.physics.simulator.motion import Motion, Path
from curlshot.synthetic.physics import Start
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_wherever_a_fit_may_go_stones_move_as_their_velocities_say() -> None:
    seen = watch(hit_motion(1.5, 0.06), np.random.default_rng(2))
    whole = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS).shot_fit
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
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    assert set(found.shot_fit.shots[0].traces) == {"A", "B"}
    told = found.shot_fit["restitution"]
    assert abs((told.value or 0.0) - 0.83) < 2.5 * (told.stderr or 0.0) < 0.01


def test_who_is_set_off_by_a_hit_that_is_not_told_lay_there_until_then() -> None:
    """B passes a hit on to C at once: C was not on its way, through A and B, since the start."""
    motion = hit_motion(2.0, 0.05, others=[Start(-0.02, 2 * RADIUS + 0.01)])
    assert [(hit.first, hit.second) for hit in motion.hits] == [(0, 1), (1, 2)]
    seen = watch(motion, np.random.default_rng(3), sd=0.001)
    contacts = detect_hits(seen, RADIUS)[:1]
    assert {*contacts[0].stones} == {"A", "B"}

    local = estimate_locally(seen, contacts, radius=RADIUS)
    assert local.fit is not None
    shot = observed.observe(local.known, local.fit, RADIUS, priors=loose_priors(RADIUS))
    assert shot is not None
    place = {unknown.name: unknown.guess for unknown in shot.unknowns if unknown.stone == "C"}
    assert place == {
        "C.x": pytest.approx(-0.02, abs=0.001),
        "C.y": pytest.approx(2 * RADIUS + 0.01, abs=0.001),
    }
    assert contacts[0].t - 0.1 < shot.traces["C"].t[-1] < motion.hits[1].t + 0.04
    assert shot.traces["A"].t[-1] > motion.hits[1].t + 1

    found = estimate(seen, contacts, radius=RADIUS)
    assert found.shot_fit is None
    assert any("does not reproduce" in text for text in found.warnings)
