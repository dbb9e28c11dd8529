from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import estimate_locally
from curlshot.synthetic.physics import Start
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_why_the_friction_between_stones_is_not_told() -> None:
    motion = hit_motion(1.5, 0.0, stone_friction=0.5)
    seen = watch(motion, np.random.default_rng(1), sd=0.003)
    contacts = detect_hits(seen, RADIUS)
    (stuck,) = estimate_locally(seen, contacts, radius=RADIUS).collisions
    assert stuck.stone_friction is None
    assert "stopped sliding" in str(stuck.note_stone_friction)
    (blind,) = estimate_locally(seen.assign(theta=np.nan), contacts, radius=RADIUS).collisions
    assert "spin of A before the hit was not measured" in str(blind.note_stone_friction)
    slid = watch(hit_motion(1.5, 0.2, stone_friction=0.05), np.random.default_rng(1), sd=0.001)
    (told,) = estimate_locally(slid, detect_hits(slid, RADIUS), radius=RADIUS).collisions
    assert told.stone_friction == pytest.approx(0.05, abs=0.02)
    assert told.note_stone_friction is None


def test_why_a_restitution_is_not_told_says_where_a_stone_was_seen() -> None:
    chain = [Start(0.02, 2 * RADIUS + 0.004)]
    motion = hit_motion(0.25, 0.02, others=chain, before=0.6, after=0.8)
    seen = watch(motion, np.random.default_rng(1), sd=0.01)
    hits = estimate_locally(seen, detect_hits(seen, RADIUS), radius=RADIUS).collisions
    assert [hit.note for hit in hits] == [
        None,
        "restitution unknown: B is measured once between two hits",
    ]


def test_what_momentum_is_off_by_beyond_its_error_is_in_that_of_the_restitution() -> None:
    """A map that is stretched on one side of the hit alone: both are off by more than is stated."""
    motion = hit_motion(1.5, 0.03, restitution=0.83)
    even = watch(motion, np.random.default_rng(3), sd=0.0005)
    contacts = detect_hits(even, RADIUS)
    bent = even.copy()
    bent.loc[bent["t"] < contacts[0].t, "y"] *= 1.02
    (kept,), (off,) = (
        estimate_locally(seen, contacts, radius=RADIUS).collisions for seen in (even, bent)
    )
    assert kept.restitution == pytest.approx(0.83, abs=2 * (kept.stderr or 0.0))
    assert (off.momentum_residual or 0.0) > 3 * (off.stderr_momentum or 0.0)
    assert abs((off.restitution or 0.0) - 0.83) > 3 * (kept.stderr or 0.0)
    assert off.restitution == pytest.approx(0.83, abs=2 * (off.stderr or 0.0))
