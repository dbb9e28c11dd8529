from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from curlshot.data.results import Estimate, Prediction
from curlshot.physics.estimate import estimate
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.prediction.forecast import ASSUMED, assumed, predict
from curlshot.physics.shot_fit.priors import Priors
from curlshot.synthetic.physics import Ice, Impact, Motion, Start
from curlshot.synthetic.physics import simulate as move
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def forecasts(seen: pd.DataFrame, *laws: Priors) -> Iterator[dict[str, Prediction]]:
    """With each of the laws, from one estimate."""
    contacts = detect_hits(seen, RADIUS)
    tracks = smooth(seen, contacts, radius=RADIUS)
    found = estimate(seen, contacts, radius=RADIUS)
    return (predict(seen, tracks, found, radius=RADIUS, laws=each) for each in laws)


def forecast(seen: pd.DataFrame, laws: Priors = ASSUMED) -> dict[str, Prediction]:
    (made,) = forecasts(seen, laws)
    return made


def test_last_places_are_predicted_from_before_the_hit() -> None:
    # The laws assumed happen to be the true ones; the second hit follows from the first.
    motion = hit_motion(1.2, 0.08, before=2.0, after=2.0, others=(Start(0.0, 0.7),))
    made = forecast(watch(motion, np.random.default_rng(1), sd=0.003))
    frictional = made["frictional"]
    assert frictional.rmse is not None
    assert frictional.rmse < 0.03
    assert sorted(frictional.rest_error) == ["A", "B", "C"]
    for stone, error in frictional.rest_error.items():
        sd = frictional.rest_sd[stone]
        assert sd is not None
        assert error is not None
        assert error < 2 * sd
    soon = frictional.error_at_comparison
    assert sorted(soon) == ["A", "B", "C"]
    assert all(error is not None and error < 0.02 for error in soon.values())
    assert sorted(frictional.sd_at_comparison) == ["A", "B", "C"]
    for stone, sd in frictional.sd_at_comparison.items():  # errors grow with time
        assert sd is not None
        assert (soon[stone] or 0.0) < 2 * sd < 2 * (frictional.rest_sd[stone] or 0.0)
    assert made["rigid-body"].rmse is None
    assert "spins" in (made["rigid-body"].note or "")


def test_the_error_stated_is_of_where_a_stone_was_last_seen() -> None:
    seen = watch(hit_motion(1.2, 0.08, before=2.0), np.random.default_rng(3), sd=0.003)
    whole = forecast(seen)["frictional"].rest_sd
    left = forecast(seen[(seen["stone"] != "B") | (seen["t"] < 2.5)])["frictional"].rest_sd
    assert (left["B"] or 1.0) < 0.4 * (whole["B"] or 0.0)  # 0.5 s after the hit, not 2
    assert left["A"] == pytest.approx(whole["A"])


def test_what_comes_after_the_hit_is_not_used() -> None:
    seen = watch(hit_motion(1.2, 0.08, before=2.0, restitution=0.5), np.random.default_rng(2))
    laws = (replace(ASSUMED, restitution=Estimate(e, 0.01)) for e in (0.95, 0.5))
    wrong, right = (made["frictional"] for made in forecasts(seen, *laws))
    assert wrong.rmse is not None
    assert right.rmse is not None
    assert right.rmse < 0.03
    assert wrong.rmse > 3 * right.rmse
    assert wrong.restitution == Estimate(0.95, 0.01)


def known(e: float = 0.83, stone_friction: float = 0.05, friction: float = 0.0109) -> Priors:
    """Laws that are known exactly but for how friction falls and paths curl."""
    return Priors(*(Estimate(value, 0.0) for value in (e, stone_friction, friction, 1.0)))


def even(laws: Priors) -> Priors:
    """Return them for ice that is known to be even: constant friction, no curl."""
    return replace(laws, slope=Estimate(0.0, 0.0), turn=Estimate(0.0, 0.0))


def move_onto_another(thrown: Start, ice: Ice, before: float, after: float) -> Motion:
    """Throw a stone that hits one at rest, 95 mm beside its middle, after some time, s."""
    (state,) = move([thrown], before, ice=ice, step=5e-4, keep_every=4).at(before)
    ahead = state[3:5] / np.hypot(*state[3:5])
    place = state[:2] + 0.275 * ahead + 0.095 * np.array([-ahead[1], ahead[0]])
    return move(
        [thrown, Start(*place.tolist())], before + after, ice=ice, impact=Impact(0.83, 0.05),
        step=5e-4, keep_every=4,
    )  # fmt: skip


@pytest.mark.parametrize("spin", [-1.2, 1.2])
def test_ice_that_bends_the_way_to_the_first_hit_is_followed(spin: float) -> None:
    # Taken for straight, 4 s of it end a centimetre beside, and the stone that is hit leaves
    # at an angle that is some hundredths of a radian off.
    ice, seen_for = Ice(b=0.00626, a=0.00201, v_c=0.0639, curl=0.0082), 4.0
    thrown = Start(0.0, 0.0, 0.0, 1.8, 0.3, spin)
    motion = move_onto_another(thrown, ice, seen_for, 0.5)
    seen = watch(motion, np.random.default_rng(6), sd=0.001)
    errors = forecast(seen, known(friction=ice.friction(1.0)))["frictional"].rest_error
    assert max(errors[stone] or 1.0 for stone in "AB") < 0.004


def test_friction_that_is_assumed_wrongly_does_not_move_the_start() -> None:
    seen = watch(hit_motion(1.2, 0.08, before=3.0, after=0.3), np.random.default_rng(7), sd=0.001)
    wrong = replace(ASSUMED, friction=Estimate(0.0079, 0.003))
    usual, other = (made["frictional"].rest_error for made in forecasts(seen, ASSUMED, wrong))
    for stone, error in other.items():
        assert error == pytest.approx(usual[stone], abs=0.002)


def test_a_stone_that_was_pushed_is_predicted_from_what_was_seen_since() -> None:
    seen = watch(hit_motion(1.2, 0.08, before=3.0), np.random.default_rng(8), sd=0.001)
    usual = forecast(seen)["frictional"]
    own = (seen["stone"] == "A") & (seen["t"] < 1.5)
    pushed = seen.copy()
    pushed.loc[own, "y"] += 0.7 * (1.5 - pushed.loc[own, "t"])  # by 0.7 m/s, with a hand
    again = forecast(pushed)["frictional"]
    for stone, error in again.rest_error.items():
        assert error == pytest.approx(usual.rest_error[stone], abs=0.02)
    assert set(again.rest_error) == {"A", "B"}


def test_the_spread_of_last_places_is_as_stated() -> None:
    off = []
    for seed in range(6):
        seen = watch(hit_motion(1.3, 0.08, before=1.5), np.random.default_rng(seed), sd=0.003)
        made = forecast(seen, even(known()))["frictional"]
        off += [made.rest_error[s] / (made.rest_sd[s] or np.nan) for s in "AB"]  # type: ignore[operator]
    assert 0.6 < np.sqrt(np.mean(np.square(off))) < 1.4


def test_no_hit_is_no_prediction() -> None:
    seen = watch(hit_motion(before=1.0), np.random.default_rng(3))
    early = seen[seen["t"] < 0.8].reset_index(drop=True)
    assert forecast(early) == {}


@pytest.mark.parametrize("frames", [1, 3])
def test_too_little_before_the_hit_is_said(frames: int) -> None:
    seen = watch(hit_motion(1.2, 0.08), np.random.default_rng(4))
    contacts = detect_hits(seen, RADIUS)
    early = seen["t"] < contacts[0].t
    kept = seen[~early | seen["frame"].isin(np.sort(seen["frame"][early].unique())[-frames:])]
    kept = kept.reset_index(drop=True)
    found = estimate(kept, contacts, radius=RADIUS)
    made = predict(kept, smooth(kept, contacts, radius=RADIUS), found, radius=RADIUS)
    frictional = made["frictional"]
    far = max((sd or 0.0 for sd in frictional.rest_sd.values()), default=np.inf)
    assert frictional.note is not None or far > 0.1


FALLING = Ice(b=0.0075, a=0.0024, v_c=0.0639, curl=0.0082)


def test_stones_that_lie_in_one_another_are_no_mistake_of_the_whole_run() -> None:
    """As in a table whose scale is an eighth too small, with two stones that touch at rest."""
    beside = [Start(0.9, 0.4), Start(0.9 + 2 * RADIUS, 0.4)]
    motion = hit_motion(1.5, 0.05, after=1.0, others=beside)
    seen = watch(motion, np.random.default_rng(7), sd=0.001)
    seen[["x", "y"]] *= 0.88
    found = forecast(seen)
    for name in ("point-mass", "frictional"):
        assert found[name].rmse is None
        assert "stones C and D overlap" in str(found[name].note)


def far_shot(ice: Ice, seed: int, before: float = 2.5) -> pd.DataFrame:
    """A shot that is seen till its stones have come to rest, far from where they hit."""
    thrown = Start(0.0, 0.0, 0.0, 2.0, 0.3, 1.5)
    motion = move_onto_another(thrown, ice, before, 8.0)
    return watch(motion, np.random.default_rng(seed), fps=25, sd=0.002)


@pytest.mark.parametrize("ice", [FALLING, Ice()])
def test_a_shot_is_foretold_with_the_ice_that_the_whole_of_it_has_shown(ice: Ice) -> None:
    # With constant friction and no curl the stones would end decimetres off.
    seen = far_shot(ice, 3)
    contacts = detect_hits(seen, RADIUS)
    found = estimate(seen, contacts, radius=RADIUS)
    assert found.shot_fit is not None
    shape = {name: Estimate(found.shot_fit[name].value, 0.0) for name in ("slope", "v_c", "turn")}
    friction = Estimate(found.friction.value, found.friction.stderr)
    laws = replace(known(), friction=friction, **shape)
    tracks = smooth(seen, contacts, radius=RADIUS)
    made = predict(seen, tracks, found, radius=RADIUS, laws=laws)["frictional"]
    assert set(made.rest_error) == {"A", "B"}
    for stone, error in made.rest_error.items():
        assert (error or 1.0) < 0.03
        assert (error or 1.0) < 2 * (made.rest_sd[stone] or 0.0) < 0.2


def test_what_is_not_known_of_the_ice_is_in_the_errors() -> None:
    """The shot is seen for too short a time to tell how friction falls, or whether paths curl."""
    seen = far_shot(FALLING, 4, before=1.0)
    friction = Estimate(FALLING.friction(1.0), 0.0)
    hits = replace(known(), friction=friction)
    any_ice, straight = (made["frictional"] for made in forecasts(seen, hits, even(hits)))
    off = {stone: error or 0.0 for stone, error in straight.rest_error.items()}
    assert max(off.values()) > 0.1
    assert max(off[stone] / (straight.rest_sd[stone] or 0.0) for stone in off) > 2
    for stone, error in any_ice.rest_error.items():
        assert (error or 1.0) < 2 * (any_ice.rest_sd[stone] or 0.0)


def test_where_nothing_tells_laws_apart_the_plainest_are_predicted_with() -> None:
    motion = hit_motion(1.3, 0.08, before=0.7, after=6.0)
    seen = watch(motion, np.random.default_rng(9), fps=25, sd=0.001)
    unsure, sure = (made["frictional"] for made in forecasts(seen, known(), even(known())))
    for stone, error in sure.rest_error.items():
        assert unsure.rest_error[stone] == pytest.approx(error, abs=1e-3)
        assert (unsure.rest_sd[stone] or 0.0) > 2 * (sure.rest_sd[stone] or 0.0)


def test_what_caps_beside_their_centres_leave_open_of_aims_covers_the_errors() -> None:
    motion = hit_motion(1.3, 0.08, before=0.7, after=1.5)
    seen = watch(motion, np.random.default_rng(9), sd=0.0003)
    seen["sd_place_x"] = seen["sd_place_y"] = 0.002
    made = forecasts(seen, even(known()), even(known()))
    half = next(made)["frictional"]
    for stone, error in half.rest_error.items():
        sd = half.rest_sd[stone] or 0.0
        assert (error or 1.0) < 2 * sd


SMALL = 0.2


def small_discs(mu: float, e: float, **known: Estimate) -> Prediction:
    """Predict a hit of discs of a fifth of a stone's size, of which some laws are `known`."""
    radius = SMALL * RADIUS
    motion = hit_motion(1.5, 0.08, before=0.6, after=1.0, friction=mu / SMALL, restitution=e)
    seen = watch(motion, np.random.default_rng(2), sd=0.005)
    seen[["x", "y", "sd_x", "sd_y"]] *= SMALL
    contacts = detect_hits(seen, radius)
    tracks = smooth(seen, contacts, radius=radius)
    found = estimate(seen, contacts, radius=radius)
    laws = replace(assumed(radius), **known)
    return predict(seen, tracks, found, radius=radius, laws=laws)["frictional"]


@pytest.mark.parametrize("friction", [0.03, 0.06])
def test_discs_that_are_no_stones_do_not_glide_as_on_curling_ice(friction: float) -> None:
    # With the friction of curling ice the last place is 4.5 and 10 cm off (stated: 1 and 5).
    made = small_discs(friction, 0.83, restitution=Estimate(0.83, 0.06))
    assert (made.rest_error["B"] or 1.0) < 2 * (made.rest_sd["B"] or 0.0)
    assert (made.rest_error["B"] or 1.0) < 0.02
    assert assumed(RADIUS) == ASSUMED


@pytest.mark.parametrize("restitution", [0.5, 0.95])
def test_discs_that_are_no_stones_may_bounce_otherwise(restitution: float) -> None:
    # With what is known of the e of curling stones, 0.5 is 2.1 of its errors off.
    made = small_discs(0.002, restitution, friction=Estimate(0.002, 0.0001))
    assert (made.rest_error["B"] or 1.0) < 1.5 * (made.rest_sd["B"] or 0.0)


def misled(before: pd.DataFrame, seen: pd.DataFrame) -> dict[str, Prediction]:
    """Predict what was seen from something else than was seen before the hit."""
    contacts = detect_hits(seen, RADIUS)
    tracks = smooth(seen, contacts, radius=RADIUS)
    return predict(before, tracks, estimate(seen, contacts, radius=RADIUS), radius=RADIUS)


def test_a_shot_whose_hit_is_not_foretold_is_not_predicted() -> None:
    seen = watch(hit_motion(1.2, 0.08, before=2.0, after=2.0), np.random.default_rng(4), sd=0.003)
    early = (seen["stone"] == "A") & (seen["t"] < 2.0)
    # As if the thrown stone had crept to 20 cm before the hit, at a tenth of its speed.
    slow, last = seen.copy(), seen[early].iloc[-1]
    for axis in ("x", "y"):
        slow.loc[early, axis] = last[axis] + 0.1 * (seen.loc[early, axis] - last[axis])
        slow.loc[early, axis] -= 0.2 * (axis == "y")
    made = misled(slow, seen)
    for name in ("point-mass", "frictional"):
        assert made[name].rmse is None
        assert "A and B do not hit each other" in (made[name].note or "")


def test_hits_that_are_foretold_and_did_not_happen_are_named() -> None:
    aside = Start(-0.6, 0.5)
    motion = hit_motion(1.2, 0.08, before=2.0, after=2.0, others=(aside,))
    seen = watch(motion, np.random.default_rng(1), sd=0.003)
    right = misled(seen, seen)["frictional"]
    assert right.note is None
    moved = seen.copy()
    moved.loc[moved["stone"] == "C", "x"] -= aside.x  # into the way of the stone that is hit
    moved.loc[moved["stone"] == "C", "y"] += 0.7 - aside.y
    wrong = misled(moved, seen)["frictional"]
    assert wrong.note == "in the prediction, B and C hit each other; in the clip they did not"
    assert (wrong.rmse or 0.0) > 3 * (right.rmse or 1.0)
