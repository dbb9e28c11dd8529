from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import estimate_locally
from curlshot.synthetic.physics import Ice, Impact, Start, simulate
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_long_glides_on_ice_that_slows_slow_stones_more() -> None:
    """A glide of 2.5 s is no parabola there: by itself that moves e by some 0.01."""
    fcv1 = Ice(a=0.00201, b=0.00626, v_c=0.0639)
    pulls = []
    for seed in range(8):
        rng = np.random.default_rng(700 + seed)
        starts = [Start(rng.uniform(0.0, 0.15), -2.9, 0, rng.uniform(0.9, 1.1), 0, 1), Start(0, 0)]
        motion = simulate(starts, 5.0, ice=fcv1, impact=Impact(0.75), step=5e-4, keep_every=4)
        seen = watch(motion, rng, sd=0.001)
        e = estimate_locally(seen, detect_hits(seen, RADIUS), radius=RADIUS).restitution
        assert e.value is not None
        assert e.stderr is not None
        assert e.stderr < 0.02
        pulls.append((e.value - 0.75) / e.stderr)
    assert np.sqrt(np.mean(np.square(pulls))) < 1.4, pulls


def test_a_hit_at_which_a_hidden_stone_takes_the_momentum_tells_no_restitution() -> None:
    third = Start(0.05, 0.36)  # struck 0.1 s after the hit
    seen = watch(hit_motion(1.2, 0.05, others=[third]), np.random.default_rng(3), sd=0.002)
    contacts = [c for c in detect_hits(seen, RADIUS) if c.stones == ("A", "B")]
    hidden = seen[seen["stone"] != "C"]
    hidden = hidden[(hidden["t"] < contacts[0].t) | (hidden["t"] > contacts[0].t + 0.15)]
    found = estimate_locally(hidden, contacts, radius=RADIUS)
    (hit,) = found.collisions
    assert hit.restitution is None
    assert "something else touched the stones" in str(hit.note)
    assert found.restitution.value is None
    assert sum("momentum changes" in text for text in found.warnings) == 1


@pytest.mark.parametrize(("restitution", "said"), [(1.1, 1), (0.99, 0)])
def test_a_restitution_above_1_is_odd(restitution: float, said: int) -> None:
    motion = hit_motion(1.2, 0.05, restitution=restitution)
    seen = watch(motion, np.random.default_rng(8), sd=0.002)
    found = estimate_locally(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert sum("is more than 1" in text for text in found.warnings) == said
    (hit,) = found.collisions
    assert (hit.restitution is None) == bool(said)


@pytest.mark.parametrize("offset", [-0.13, 0.13])
def test_ice_that_bends_slow_ways_leads_no_restitution_astray(offset: float) -> None:
    # What is left of the first stone goes aside, slowly, and its way turns the more the slower it
    # is: taken for a parabola its velocity across, which is along the normal, was 4 mm/s off.
    reach = np.sqrt((2 * RADIUS) ** 2 - offset**2)
    motion = simulate(
        [Start(offset, -reach - 1.2, 0.0, 1.15, 0.3, 1.0), Start(0.0, 0.0)],
        4.5,
        ice=Ice(b=0.00885, a=0.00284, v_c=0.0639, curl=0.0082),
        impact=Impact(0.83, 0.05),
        step=5e-4,
        keep_every=4,
    )
    seen = watch(motion, np.random.default_rng(1), fps=60, sd=1e-5)
    seen[["sd_x", "sd_y"]] = 0.003
    found = estimate_locally(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.restitution.value == pytest.approx(0.83, abs=0.002)


@pytest.mark.parametrize("turn", [0.0, 30.0])
def test_hits_beside_one_that_is_not_told_tell_no_restitution(turn: float) -> None:
    """Three hits within a frame, of three stones in a row (found) or in a wedge (one is not)."""
    gap, turn = 2 * RADIUS + 0.002, np.radians(turn)
    further = [Start(0.0, gap), Start(0.0, 2 * gap)]
    if turn:
        further = [Start(side * gap * np.sin(turn), gap * np.cos(turn)) for side in (-1.0, 1.0)]
    start = [Start(0.02 if turn else 0.0, -1.5, 0.0, 1.4), Start(0.0, 0.0), *further]
    motion = simulate(start, 3.0, impact=Impact(0.83), step=2e-4, keep_every=10)
    seen = watch(motion, np.random.default_rng(4), sd=0.001)
    contacts = detect_hits(seen, RADIUS)
    if turn:
        contacts = tuple(hit for hit in contacts if hit.stones != ("B", "C"))
    found = estimate_locally(seen, contacts, radius=RADIUS)
    assert len(found.collisions) == (2 if turn else 3)
    for hit in found.collisions:
        if turn:
            assert hit.restitution is None
            assert "in quick succession" in str(hit.note)
        else:
            assert hit.restitution == pytest.approx(0.83, abs=2 * (hit.stderr or 0.0))
    assert (found.restitution.value is None) == bool(turn)


@pytest.mark.parametrize(
    ("ice", "span"),
    [(Ice(b=0.0109), 1.0), (Ice(b=0.0084, a=0.0027, v_c=0.0639, curl=0.0082), 1.6)],
)
def test_no_ice_draws_the_restitution_of_a_fast_hit_aside(ice: Ice, span: float) -> None:
    """What is known beforehand of the ice is in the error; noise and its mirror image cancel."""
    pulls = []
    for seed, (offset, spin) in enumerate(((-0.1, 1.0), (-0.06, -1.0), (0.06, 1.0), (0.1, -1.0))):
        rng = np.random.default_rng(seed)
        ahead = float(np.sqrt(4 * RADIUS**2 - offset**2))
        come = Start(offset, -ahead - 2.5 * span, 0.0, 2.5 + 0.05 * span, 0.0, spin)
        motion = simulate([come, Start(0, 0)], 2 * span, ice=ice, step=5e-4, keep_every=4)
        truth = watch(motion, rng, sd=1e-9).assign(sd_x=0.01, sd_y=0.01)
        noise = rng.normal(0, 0.01, (len(truth), 2))
        for sign in (1, -1):
            seen = truth.assign(**{k: truth[k] + sign * noise[:, i] for i, k in enumerate("xy")})
            e = estimate_locally(seen, detect_hits(seen, RADIUS), radius=RADIUS).restitution
            assert e.value is not None
            assert e.stderr is not None
            pulls.append((e.value - Impact().restitution) / e.stderr)
    assert abs(np.mean(pulls)) < 0.35, pulls
