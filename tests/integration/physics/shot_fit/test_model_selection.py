from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from curlshot.data.tracks import check_detections
from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.filter.slowing import V_C
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.shot_fit.global_fit import fit_shots
from curlshot.physics.shot_fit.model_selection import (
    USUAL,
    _against,
    _values,
)
from curlshot.physics.shot_fit.priors import SLOPE
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.synthetic.physics import Ice, Impact, Start, simulate
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def measure(ice: Ice | None, sd: float = 0.002) -> Estimates:
    """A long, well seen shot on constant ice, or on another."""
    if ice is None:
        motion = hit_motion(1.2, 0.1, before=2.0, after=5.0)
    else:
        stones = [Start(0.1, -2.8, 0.0, 1.4, 0.0, 1.0), Start(0.0, 0.0)]
        motion = simulate(stones, 7.0, ice=ice, impact=Impact(0.83), step=5e-4, keep_every=4)
    seen = watch(motion, np.random.default_rng(5), sd=sd)
    return estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)


def test_constant_ice_and_no_curl() -> None:
    found = measure(None)
    assert found.shot_fit is not None
    laws = found.shot_fit.laws
    assert laws[0].name.startswith("ice constant, curl none")
    assert laws[0].criterion == 0
    assert sum(law.weight for law in laws) == pytest.approx(1)
    assert [law.criterion for law in laws] == sorted(law.criterion for law in laws)
    assert (found.friction.law, found.friction.a) == ("constant", None)
    assert found.curl.value is None
    assert found.curl.note is not None
    assert "as well without curl" in found.curl.note


def test_friction_that_falls_with_the_speed_and_curl() -> None:
    found = measure(Ice(b=0.00626, a=0.00201, v_c=0.0639, curl=0.0082))
    assert found.shot_fit is not None
    assert found.shot_fit.laws[0].name.startswith("ice fit, curl fcv1")
    assert found.friction.law == "fit"
    assert found.friction.stderr is not None
    assert abs(float(found.friction.value or 0) - 0.00815) < 3 * found.friction.stderr
    assert found.curl.stderr is not None
    assert abs(float(found.curl.value or 0) - 0.0082) < 3 * found.curl.stderr


def test_a_fit_with_fewer_unknowns_sets_out_from_where_they_leave_the_others() -> None:
    watched = measure(Ice(b=0.00626, a=0.00201, v_c=0.0639, curl=0.0082)).shot_fit
    assert watched is not None
    full = fit_shots(watched.shots, fixed={"v_c": V_C}, start=USUAL)
    held = {"slope": 0.0, "v_c": V_C, "stone_friction": 2.0}
    values = _values(full, held)
    assert values["slope"] == pytest.approx(0.0, abs=1e-12)
    # The likeliest of a normal distribution there: its gradient is along what is held alone.
    moved = np.array([values[name] for name in full.names]) - full.values
    sd = np.sqrt(np.diag(full.cov))
    slope = np.linalg.solve(full.cov / np.outer(sd, sd), moved / sd)
    others = np.array([name != "slope" for name in full.names])
    assert np.abs(moved[others] / sd[others]).max() > 0.01
    assert np.abs(slope[others]).max() < 1e-6 * np.abs(slope).max()
    assert _values(full) == dict(zip(full.names, full.values.tolist(), strict=True))


@pytest.mark.parametrize(
    ("value", "error", "least", "most"),
    [
        (0.00026, 0.00009, -2.0, 2.0),  # less than on any ice that is known: either may be
        (0.0020, 0.0003, -50.0, -30.0),  # as in FCV1
        (0.0, 0.0003, 1.0, 9.0),
    ],
)
def test_friction_that_hardly_falls_is_no_better_than_constant_one(
    value: float, error: float, least: float, most: float
) -> None:
    """What places share, as far as no error states it, looks like friction that falls a little."""
    prior = np.array([SLOPE.value, SLOPE.stderr])[:, None]
    one = np.array([value])
    fit = ShotFit(("slope",), one, np.array([[error**2]]), *prior, {}, (), 1.0, 0.0, 1, 1.0, True)
    assert least < _against(fit, "slope") < most


def test_a_fit_of_fewer_unknowns_is_heard_if_stated_errors_are_large() -> None:
    """It leaves many times as much as the best, and still less than noise may."""
    stones = [Start(0.1, -2.8, 0.0, 1.4, 0.0, 1.0), Start(0.0, 0.0)]
    ice = Ice(b=0.0102, a=0.0001, v_c=V_C)
    motion = simulate(stones, 6.0, ice=ice, impact=Impact(0.83), step=5e-4, keep_every=4)
    seen = watch(motion, np.random.default_rng(5), sd=0.0002, fps=15)
    seen[["sd_x", "sd_y"]] = 0.01
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    assert found.shot_fit.laws[0].name.startswith("ice constant")


def test_other_laws_add_to_the_errors() -> None:
    """Where the tracks can hardly tell the laws apart the friction's error says so."""
    found = measure(None, sd=0.02)
    assert found.shot_fit is not None
    best = found.shot_fit.laws[0]
    error = found.shot_fit["friction"].stderr
    assert error is not None
    value = float(best.friction.value or 0)
    squares = [
        law.weight * (float(law.friction.stderr or 0) ** 2 + (law.friction.value - value) ** 2)
        for law in found.shot_fit.laws
        if law.friction.value is not None
    ]
    assert error**2 == pytest.approx(sum(squares), rel=1e-6)
    assert sum(squares[1:]) > 0


def test_the_friction_of_slow_stones_on_falling_ice_is_as_uncertain_as_it_says() -> None:
    """Friction at 1 m/s is told by stones of half that speed only as far as the law is."""
    pulls = []
    for v_c in (0.03, 0.064, 0.13):
        stones = [Start(0.1, -1.2, 0.0, 0.7, 0.0, 1.0), Start(0.0, 0.0)]
        ice = Ice(b=0.0075, a=0.0015, v_c=v_c)
        motion = simulate(stones, 5.0, ice=ice, impact=Impact(0.83), step=5e-4, keep_every=4)
        seen = watch(motion, np.random.default_rng(6), sd=0.003)
        found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS).friction
        assert found.law == "fit"
        pulls.append((float(found.value or 0) - ice.friction(1.0)) / float(found.stderr or 0))
    assert max(map(abs, pulls)) < 3


@dataclass(frozen=True)
class Rooted(Ice):
    """Penner's ice: friction falls with the root of the speed."""

    def friction(self, speed: float) -> float:
        return self.b * max(speed, 1e-3) ** -0.5


def test_ice_of_another_law_is_recognised_and_counts_in_the_errors() -> None:
    """What a / (v + v_c) + b makes of such ice is off at 1 m/s by more than noise explains."""
    found = measure(Rooted(b=0.008))
    assert found.shot_fit is not None
    assert found.shot_fit.laws[0].name.startswith("ice penner")
    assert found.shot_fit.laws[0].weight > 0.9
    assert found.friction.stderr is not None
    assert abs(float(found.friction.value or 0) - 0.008) < 2.5 * found.friction.stderr
    assert found.friction.stderr < 0.05 * 0.008


def test_ice_of_another_law_counts_where_stones_do_not_slide_on_each_other() -> None:
    """It was compared with sliding stones alone, with which none fits."""
    stones = [Start(0.1, -2.8, 0.0, 2.0, 0.0, 1.5), Start(0.0, 0.0), Start(-0.3, 0.7)]
    motion = simulate(
        stones, 6.0, ice=Rooted(b=0.008, curl=0.015), impact=Impact(0.83, 0.25),
        step=5e-4, keep_every=4,
    )  # fmt: skip
    seen = watch(motion, np.random.default_rng(5), sd=0.001)
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    assert found.shot_fit.laws[0].name == "ice penner, curl fcv1, stones stick"
    assert found.friction.stderr is not None
    assert abs(float(found.friction.value or 0) - 0.008) < 2.5 * found.friction.stderr


def test_a_fit_that_has_come_to_rest_in_a_wrong_place_begins_anew() -> None:
    """Constant friction lets stones of three hits in a row miss each other by centimetres."""
    ice = Ice(b=0.00676, a=0.00217, v_c=0.0639, curl=0.0082)
    stones = [
        Start(-0.4346, 3.91, 0.3264, -1.9421, 0.0, 1.7),
        *(Start(-0.15, 1.9), Start(-0.05, 0.75), Start(0.6, -1.1)),
    ]
    impact = Impact(0.85, stone_friction=0.12)
    motion = simulate(stones, 4.96, ice=ice, impact=impact, step=5e-4, keep_every=4)
    seen = watch(motion, np.random.default_rng(1), fps=25, sd=0.0005)
    seen = seen[(seen["stone"] != "C") | (seen["t"] < 3.0)].reset_index(drop=True)
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    assert not found.shot_fit.diverged
    assert found.friction.value == pytest.approx(ice.friction(1.0), abs=1e-4)
    assert found.friction.stderr is not None
    assert found.friction.stderr < 1e-4
    assert found.restitution.value == pytest.approx(0.85, abs=0.001)
    assert found.curl.value == pytest.approx(0.0082, abs=0.001)


@pytest.mark.parametrize(
    ("share", "first", "third", "impact", "end", "fps"),
    [
        # Without curl friction would have to grow with the speed, which it does on no ice.
        (1.0, (0.129, -6.399, 0, 3.416, 0, -1.0), (-2.305, 4.499), (0.848, 0.017), 5.5, 60),
        # From first guesses the second stone would pass by the third.
        (1.28, (0.017, -4.998, 0, 2.293, 0, 1.27), (-0.264, 4.221), (0.933, 0.09), 6.5, 25),
    ],
)
def test_slowing_and_curl_are_told_apart_in_a_shot_of_two_hits(
    share: float,
    first: tuple[float, ...],
    third: tuple[float, float],
    impact: tuple[float, float],
    end: float,
    fps: float,
) -> None:
    ice = Ice(b=0.0079 * share, a=0.0025 * share, v_c=0.0639, curl=0.0082)
    stones = [Start(*first), Start(0.0, 0.0), Start(*third)]
    motion = simulate(stones, end, ice=ice, impact=Impact(*impact), step=5e-4, keep_every=4)
    assert len(motion.hits) == 2
    seen = watch(motion, np.random.default_rng(8), fps=fps, sd=0.01)
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    # Paths that curl do not keep momentum as parabolas: beside a slow hit that may not tell it.
    assert all("restitution unknown" in warning for warning in found.warnings)
    assert len(found.warnings) <= 1
    for told, true, most in (
        (found.friction, ice.friction(1.0), 0.0003),
        (found.restitution, impact[0], 0.006),
        (found.curl, ice.curl, 0.002),  # with it held elsewhere the fits say as much
    ):
        assert told.value is not None
        assert told.stderr is not None
        assert told.stderr < most
        assert abs(told.value - true) < 2 * told.stderr


def test_spins_of_slow_stones_are_less_sure_at_the_hit() -> None:
    """A stone's loss of spin goes with the inverse of its speed, which holds only roughly."""
    seen = watch(hit_motion(1.5, 0.02), np.random.default_rng(3), sd=0.003)
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    spins = found.shot_fit.shots[0].spins
    after = {spin.stone: spin.stderr for spin in spins if spin.t > found.collisions[0].t}
    assert after["B"] < 0.05
    assert after["A"] > 2 * after["B"]


def test_stones_that_stick_from_the_least_friction_on_may_not_rub_at_all() -> None:
    """With little to rub they stick in every fit that sets out from some friction."""
    motion = simulate(
        [Start(-0.09, -2.7, 0.0, 1.6, 0.0, -2.2), Start(0.0, 0.0)], 4.0,
        ice=Ice(b=0.0073), impact=Impact(0.72, 0.0), step=5e-4, keep_every=4,
    )  # fmt: skip
    seen = watch(motion, np.random.default_rng(0), fps=60, sd=0.01)
    fit = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS).shot_fit
    assert fit is not None
    assert fit["stone_friction"].value == pytest.approx(0.0, abs=0.01)
    assert abs(float(fit["restitution"].value or 0) - 0.72) < 2 * float(
        fit["restitution"].stderr or 0
    )


@pytest.mark.parametrize("seed", [0, 4])
def test_a_spin_that_nobody_saw_may_be_of_either_sense(seed: int) -> None:
    """One that was taken for the other, or for none, made the ice and the hit look otherwise."""
    motion = simulate(
        [Start(0.08, -8.0, 0.0, 2.71, 0.0, -1.73), Start(0.0, 0.0)], 4.0,
        ice=Ice(b=0.00824, curl=0.0082), impact=Impact(0.65, 0.03), step=5e-4, keep_every=4,
    )  # fmt: skip
    seen = watch(motion, np.random.default_rng(seed), fps=60, sd=0.003).drop(
        columns=["theta", "sd_theta"]
    )
    found = estimate(check_detections(seen), detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    assert float(found.curl.value or 0) == pytest.approx(0.0082, abs=0.002)
    assert float(found.shot_fit["A.omega"].value or 0) < 0
    others = ["other sense" in law.name for law in found.shot_fit.laws]
    assert any(others) and not others[0]
    for got, true in ((found.restitution, 0.65), (found.friction, 0.00824)):
        assert abs(float(got.value or 0) - true) < 2.5 * float(got.stderr or 0)


@pytest.mark.parametrize("spin", [-0.8, 1.5])
def test_a_path_curls_to_the_side_of_a_spin_that_nobody_saw(spin: float) -> None:
    """Without friction between stones no hit tells its sense: curl was told to the other side."""
    motion = simulate(
        [Start(0.14, -3.3, 0.0, 1.85, 0.0, spin), Start(0.0, 0.0)], 5.0,
        ice=Ice(b=0.0078, curl=0.012), impact=Impact(0.78, 0.0), step=1e-3, keep_every=2,
    )  # fmt: skip
    seen = watch(motion, np.random.default_rng(23), fps=25, sd=0.002).drop(
        columns=["theta", "sd_theta"]
    )
    found = estimate(check_detections(seen), detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    assert found.curl.value == pytest.approx(0.012, abs=0.002)
    assert abs(float(found.curl.value or 0) - 0.012) < 2.5 * float(found.curl.stderr or 0)


def test_one_place_counts_once_whatever_led_there() -> None:
    """Stones that stick do so by any friction, and a spin may be set out for from either sense."""
    motion = hit_motion(1.5, 0.15, before=0.8, after=1.5, stone_friction=0.5)
    seen = watch(motion, np.random.default_rng(3), sd=0.002).drop(columns=["theta", "sd_theta"])
    found = estimate(check_detections(seen), detect_hits(seen, RADIUS), radius=RADIUS).shot_fit
    assert found is not None
    places = {
        (
            "slope" in fit.names, "turn" in fit.names, "v_c" in fit.names, fit.shots[0].ice,
            round(float(fit["A.omega"].value or 0), 1),
            round(fit.state()["stone_friction"], 1) if fit.identifies("stone_friction") else None,
        )
        for _, fit in found.choices
    }  # fmt: skip
    assert len(places) == len(found.choices) > 1
