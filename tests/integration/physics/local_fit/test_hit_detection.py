from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.physics.local_fit.fit import fit_shot
from curlshot.physics.local_fit.hit_detection import _Evidence, _once, cut_all, detect_hits
from curlshot.physics.local_fit.solution import Meeting
from curlshot.physics.local_fit.traces import traces
from curlshot.synthetic.physics import Ice, Impact, Motion, Start, simulate
from curlshot.tests.helpers.physics.watch import (
    RADIUS,
    airtable,
    discs,
    hit_motion,
    semireal,
    watch,
)


def test_a_hit_is_timed_to_a_fraction_of_a_frame() -> None:
    rng = np.random.default_rng(1)
    motion = hit_motion()
    pulls = []
    for _ in range(20):
        (hit,) = detect_hits(watch(motion, rng), RADIUS)
        pulls.append((hit.t - motion.hits[0].t) / hit.stderr_t)
        assert abs(hit.t - motion.hits[0].t) < 0.3 / 30
        assert hit.stones == ("A", "B")
        assert np.dot(hit.normal, motion.hits[0].normal) > 0.998
    assert 0.6 < np.std(pulls) < 1.5
    assert abs(np.mean(pulls)) < 0.6


@pytest.mark.parametrize(("speed", "restitution", "seed"), [(0.5, 0.75, 35), (0.8, 0.7, 31)])
def test_slow_stones_hit_away_from_where_they_seem_closest(
    speed: float, restitution: float, seed: int
) -> None:
    # Side by side for long, 1 cm of noise tells the closest detection by chance: the hit lies past
    # where it is sought from there. One such hit was found twice, one 7 standard errors early.
    motion = hit_motion(speed, 0.03, after=1.2, restitution=restitution, friction=0.007)
    seen = watch(motion, np.random.default_rng(seed), fps=60, sd=0.01)
    (hit,) = detect_hits(seen, RADIUS)
    assert abs(hit.t - motion.hits[0].t) < 3 * hit.stderr_t


@pytest.mark.parametrize("seed", [4])
def test_a_stone_that_hardly_goes_on_hides_no_hit(seed: int) -> None:
    # After its hit the second stone goes on at 3 cm/s; where its fit went to and fro without an
    # end, what it happened to leave was taken for noise, and a hit of the others for too little.
    motion = simulate(
        [Start(0.113, -0.644, 0.0, 0.774), Start(0, 0), Start(-0.204, 0.553), Start(-0.455, 1.026)],
        2.0,
        ice=Ice(b=0.0101, a=0.00325, v_c=0.0639, curl=0.0082),
        impact=Impact(0.91, 0.01),
        step=5e-4,
        keep_every=4,
    )
    seen = watch(motion, np.random.default_rng(seed), fps=60, sd=0.01)
    found = [hit.stones for hit in detect_hits(seen, RADIUS)]
    assert found == [("A", "B"), ("B", "C"), ("C", "D")]


@pytest.mark.parametrize(("early", "other"), [(0.0, None), (0.2, None), (0.0, ("B", "C"))])
def test_a_pair_hits_again_only_after_something_else(
    early: float, other: tuple[str, str] | None
) -> None:
    # Between a hit and 0.2 s after it nothing is, unless another stone; 0.2 s before it, a break.
    motion = hit_motion(others=(Start(0.02, 0.8),))
    known, t = traces(watch(motion, np.random.default_rng(1))), motion.hits[0].t
    meetings = [Meeting(t - early, ("A", "B"), 1 / 30), Meeting(t + 0.2, ("A", "B"), 1 / 30)]
    if other:
        meetings.insert(1, Meeting(t + 0.1, other, 1 / 30))
    fit = fit_shot(known, cut_all(known, meetings, RADIUS)[0], meetings, RADIUS)
    evidence = [_Evidence(9.0 - k, True, True, 1, 0.0) for k in range(len(meetings))]
    found = [told.hit for told in _once(evidence, fit)]
    assert found == ([9.0, 0.0] if not early and not other else [e.hit for e in evidence])


def test_a_near_miss_is_no_hit() -> None:
    rng = np.random.default_rng(2)
    passing = hit_motion(offset=0.0, others=())
    states = passing.states.copy()
    # The same stone on a parallel path that clears the other by 5 mm.
    free = hit_motion(offset=0.0, others=(), restitution=0.83)
    t = free.times
    v0, slow = free.states[0, 0, 4], 0.0109 * 9.81
    states[:, 0, 0] = 2 * RADIUS + 0.005
    states[:, 0, 1] = free.states[0, 0, 1] + v0 * t - 0.5 * slow * t**2
    states[:, 1, :2] = 0.0
    miss = type(free)(t, states, ())
    for given_sd in (True, False):
        assert detect_hits(watch(miss, rng, given=given_sd), RADIUS) == ()


def test_chain_of_hits_two_frames_apart(shared: Path) -> None:
    rng = np.random.default_rng(3)
    for sd, slow in ((0.005, 0.0), (0.01, 0.005), (0.015, 0.0)):
        seen = semireal(shared, "pyeongchang_two_hits", rng, sd=sd, slow=slow)
        hits = detect_hits(seen, RADIUS)
        assert [hit.stones for hit in hits] == [("A", "B"), ("B", "C")]
        assert hits[0].t == pytest.approx(2.3130, abs=0.02)
        assert hits[1].t == pytest.approx(2.3937, abs=0.02)


def test_two_side_by_side_are_hit_between_two_detections() -> None:
    rng = np.random.default_rng(6)
    motion = hit_motion(2.0, 0.155, others=(Start(0.325, 0.0),))
    assert [(hit.first, hit.second) for hit in motion.hits] == [(0, 1), (0, 2)]
    assert motion.hits[1].t - motion.hits[0].t < 0.8 / 30
    for _ in range(5):
        # The two that are hit lie within reach of each other, too.
        hits = detect_hits(watch(motion, rng, sd=0.002), RADIUS)
        assert [hit.stones for hit in hits] == [("A", "B"), ("A", "C")]


def test_stones_that_touch_at_rest_hit_only_when_one_is_hit() -> None:
    rng = np.random.default_rng(4)
    frozen = Start(0.0, 2 * RADIUS + 0.002)
    motion = hit_motion(offset=0.02, others=(frozen,))
    hits = detect_hits(watch(motion, rng, sd=0.003), RADIUS)
    assert hits[0].stones == ("A", "B")
    assert all(abs(hit.t - motion.hits[0].t) < 0.1 for hit in hits)
    still = watch(motion, rng, sd=0.003)
    still = still[still["t"] < 0.9].reset_index(drop=True)
    assert detect_hits(still, RADIUS) == ()


@pytest.mark.parametrize(("aside", "seed"), [(30, 4), (60, 1), (60, 2)])
def test_a_slow_stone_that_moves_a_touching_pair_by_millimetres_hits_both(
    aside: float, seed: int
) -> None:
    apart = (2 * RADIUS + 1e-5) * np.array([np.sin(np.radians(aside)), np.cos(np.radians(aside))])
    motion = hit_motion(0.1, 0.01, after=1.5, others=(Start(*apart),))
    hits = detect_hits(watch(motion, np.random.default_rng(seed), fps=25.0, sd=0.001), RADIUS)
    assert [hit.stones for hit in hits] == [("A", "B"), ("B", "C")]


@pytest.mark.parametrize(
    ("speed", "row", "pairs"),
    [(0.52, 2, ["AB", "BC"]), (0.5, 3, ["AB", "BC", "CD"]), (0.48, 2, [])],
)
@pytest.mark.parametrize("seed", [1, 2])
def test_touching_stones_pass_on_what_a_slow_one_brings(
    speed: float, row: int, pairs: list[str], seed: int
) -> None:
    # On ice as FCV1 has it the first comes at 0.2 and 0.13 m/s and stops there, as do all of the
    # row but the last, which goes on for centimetres; the slowest stops before it.
    still = [Start(0.0, k * (2 * RADIUS + 4e-4)) for k in range(row)]
    ice = Ice(b=0.00626286, a=0.00200985, v_c=0.06385782)
    come = Start(0.01, -1.0 - 2 * RADIUS, 0.0, speed)
    motion = simulate([come, *still], 6.0, ice=ice, step=5e-4, keep_every=4)
    assert len({(hit.first, hit.second) for hit in motion.hits}) == len(pairs)
    seen = watch(motion, np.random.default_rng(seed), sd=0.001)
    assert ["".join(hit.stones) for hit in detect_hits(seen, RADIUS)] == pairs


def packed(rows: int, come: Start, duration: float) -> Motion:
    """A stone that runs from below into a triangle of stones less than a millimetre apart."""
    wide, deep = 2 * RADIUS + 6e-4, (2 * RADIUS + 8e-4) * np.sqrt(0.75)
    pack = [Start((j - i / 2) * wide, i * deep) for i in range(rows) for j in range(i + 1)]
    return simulate([come, *pack], duration, impact=Impact(0.83, 0.2), step=5e-4, keep_every=4)


@pytest.mark.parametrize("seed", [1, 3, 7])
def test_of_three_packed_stones_the_front_one_drives_both_others(seed: int) -> None:
    # All of it is between two detections: that the other two, which touch, met is not needed.
    rng = np.random.default_rng(seed)
    motion = packed(2, Start(rng.uniform(0.03, 0.05), -1.5, 0.0, 2.0, 0.0, 1.0), 2.0)
    hits = detect_hits(watch(motion, rng, sd=0.001), RADIUS)
    assert sorted("".join(hit.stones) for hit in hits) == ["AB", "BC", "BD"]


def test_a_stone_goes_off_along_the_line_of_centres() -> None:
    rng = np.random.default_rng(5)
    motion = packed(3, Start(rng.uniform(0.03, 0.06), -1.0, 0.0, 1.8, 0.0, 1.0), 1.2)
    assert not any({hit.first, hit.second} == {5, 6} for hit in motion.hits)
    pairs = ["".join(hit.stones) for hit in detect_hits(watch(motion, rng, sd=0.001), RADIUS)]
    # The last stone is driven by D; F, which touches it too, lies 60 degrees aside of its way.
    assert pairs[:2] == ["AB", "BC"]
    assert "FG" not in pairs


@pytest.mark.parametrize("beside", [0.05, 0.12])
def test_what_is_hidden_until_shortly_before_hides_no_hit(beside: float) -> None:
    motion = hit_motion(1.6, beside)
    seen = watch(motion, np.random.default_rng(4), sd=0.001)
    before = motion.hits[0].t - seen["t"]
    hidden = (seen["stone"] == "B") & before.between(0.17, 0.61)
    (hit,) = detect_hits(seen[~hidden].reset_index(drop=True), RADIUS)
    assert hit.t == pytest.approx(motion.hits[0].t, abs=0.005)


@pytest.mark.parametrize("gap", [0.2, 0.6, 1.0])
@pytest.mark.parametrize(("speed", "beside", "share"), [(0.6, 0.05, 0.5), (2.0, 0.12, 0.2)])
def test_a_hit_while_both_stones_are_out_of_sight_is_where_their_ways_cross(
    speed: float, beside: float, share: float, gap: float
) -> None:
    motion = hit_motion(speed, beside, before=2.0, after=2.5)
    seen = watch(motion, np.random.default_rng(5), sd=0.002)
    since = seen["t"] - motion.hits[0].t + share * gap
    (hit,) = detect_hits(seen[(since < 0) | (since > gap)].reset_index(drop=True), RADIUS)
    assert abs(hit.t - motion.hits[0].t) < max(0.01, 3 * hit.stderr_t)


@pytest.mark.parametrize("gap", [0.2, 0.5])
@pytest.mark.parametrize(("speed", "beside", "share"), [(0.6, 0.05, 0.3), (2.8, 0.05, 0.6)])
def test_a_hit_while_the_stone_that_comes_is_out_of_sight_is_where_its_ways_cross(
    speed: float, beside: float, share: float, gap: float
) -> None:
    motion = hit_motion(speed, beside, before=1.5, after=1.5)
    seen = watch(motion, np.random.default_rng(2), fps=25.0, sd=0.012)
    since = seen["t"] - motion.hits[0].t + share * gap
    hidden = (seen["stone"] == "A") & since.between(0, gap)
    (hit,) = detect_hits(seen[~hidden].reset_index(drop=True), RADIUS)
    assert abs(hit.t - motion.hits[0].t) < max(0.01, 3 * hit.stderr_t)


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("speed", [0.8, 2.0])
@pytest.mark.parametrize("after", [False, True])
def test_a_stone_hardly_seen_on_one_side_of_its_hit_does_not_hide_it(
    count: int, speed: float, after: bool
) -> None:
    """It comes into view just before, or goes out of it: the other tells when they met."""
    motion = hit_motion(speed, before=2.2)
    seen, t = watch(motion, np.random.default_rng(9), sd=0.001), motion.hits[0].t
    times = np.unique(seen["t"])
    beside = times[times > t][:count] if after else times[times < t][-count:]
    hidden = (seen["t"] > beside[-1]) if after else (seen["t"] < beside[0])
    hidden &= seen["stone"] == ("B" if after else "A")
    (hit,) = detect_hits(seen[~hidden].reset_index(drop=True), RADIUS)
    assert hit.stones == ("A", "B")
    assert hit.t == pytest.approx(t, abs=0.01)


def test_real_tracks_have_one_hit_each(shared: Path) -> None:
    (hit,) = detect_hits(airtable(shared), 0.035)
    assert hit.t == pytest.approx(0.178, abs=0.01)
    for number, t in ((48, 1.624), (64, 1.024)):
        (hit,) = detect_hits(discs(shared, number), 0.025)
        assert hit.t == pytest.approx(t, abs=0.003)


@pytest.mark.parametrize(
    ("gap", "beyond", "speed", "sd"), [(0.0, 0.4, 0.75, 0.0015), (0.0005, 0.12, 1.7, 0.0008)]
)
def test_a_frozen_pair_is_hit_and_hits_on(
    gap: float, beyond: float, speed: float, sd: float
) -> None:
    rng = np.random.default_rng(8)
    aside = np.array([0.3, 0.954])
    second = (2 * RADIUS + gap + 1e-5) * aside
    third = second + (2 * RADIUS + beyond) * aside
    motion = hit_motion(speed, -0.08, others=(Start(*second), Start(*third)))
    for fps in (25.0, 30.0, 50.0):
        hits = detect_hits(watch(motion, rng, fps=fps, sd=sd), RADIUS)
        assert [hit.stones for hit in hits] == [("A", "B"), ("B", "C"), ("C", "D")]


@pytest.mark.parametrize(
    ("fps", "sd", "seed"), [(25.0, 0.003, 1), (30.0, 0.001, 2), (50.0, 0.003, 3)]
)
def test_a_hit_goes_on_through_a_row_of_three(fps: float, sd: float, seed: int) -> None:
    """All in one frame: which of the hits came first is told by what came nearer alone."""
    rng = np.random.default_rng(seed)
    for gap in (1e-5, 1e-3):
        second = (2 * RADIUS + gap) * np.array([0.25, 0.968])
        third = second + (2 * RADIUS + gap) * np.array([-0.5, 0.866])
        motion = hit_motion(1.9, 0.05, after=1.6, others=(Start(*second), Start(*third)))
        hits = detect_hits(watch(motion, rng, fps=fps, sd=sd), RADIUS)
        pairs = [hit.stones for hit in hits]
        assert pairs[:3] == [("A", "B"), ("B", "C"), ("C", "D")]
        assert hits[2].t - hits[0].t < 0.03
