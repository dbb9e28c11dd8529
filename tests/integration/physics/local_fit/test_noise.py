from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from curlshot.physics.filter.stretch import ANGLE_MEMORY, PLACE_MEMORY
from curlshot.physics.local_fit.fit import fit_shot
from curlshot.physics.local_fit.hit_detection import cut_all, detect_hits
from curlshot.physics.local_fit.noise import BRIEF, FEWEST, Noise, Run, _square, noises
from curlshot.physics.local_fit.solution import Deceleration
from curlshot.physics.local_fit.traces import local_residuals, traces
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, lasting, watch

Floats = NDArray[np.float64]

SHOTS = 6


def shots(*, given: bool = True, slow: float = 0.0, turned: float = 0.0) -> list[pd.DataFrame]:
    """Detections of shots, by 4 mm and 0.02 rad anew and by more that lasts."""
    out = []
    for seed in range(SHOTS):
        rng = np.random.default_rng([71, seed])
        seen = watch(hit_motion(1.2, 0.08, after=1.5), rng, sd=0.004, given=given)
        for _, group in seen.groupby("stone"):
            t = group["t"].to_numpy()
            for column in ("x", "y"):
                seen.loc[group.index, column] += lasting(rng, t, slow, PLACE_MEMORY)
            seen.loc[group.index, "theta"] += lasting(rng, t, turned, ANGLE_MEMORY)
        out.append(seen)
    return out


def told(seen: pd.DataFrame) -> dict[str, Noise]:
    known = traces(seen)
    cut, _ = cut_all(known, detect_hits(seen, RADIUS), RADIUS)
    pieces = [replace(piece, opens=None, closes=None) for piece in cut]
    return noises(
        fit_shot(known, pieces, (), RADIUS, deceleration=Deceleration(0.0, 3.0, 3.0)), known
    )


def usual(each: list[pd.DataFrame]) -> tuple[Floats, Floats]:
    """Mean size of x, y and θ errors over stones and shots, anew and lasting."""
    of_all = [noise for seen in each for noise in told(seen).values()]
    white = np.mean([np.median(noise.white, axis=0) for noise in of_all], axis=0)
    return white, np.sqrt(np.mean([noise.slow[0] ** 2 for noise in of_all], axis=0))


@pytest.mark.parametrize("given", [True, False])
def test_errors_that_are_anew_are_told(given: bool) -> None:
    white, slow = usual(shots(given=given))
    assert white == pytest.approx([0.004, 0.004, 0.02], rel=0.15)
    assert np.all(slow < [0.0025, 0.0025, 0.015])


@pytest.mark.parametrize("given", [True, False])
def test_errors_that_last_are_told(given: bool) -> None:
    white, slow = usual(shots(given=given, slow=0.01, turned=0.06))
    assert white == pytest.approx([0.004, 0.004, 0.02], rel=0.25)
    # Stretches last a few memories only.
    assert np.all((slow > [0.005, 0.005, 0.02]) & (slow < [0.013, 0.013, 0.08]))


@pytest.mark.parametrize("fps", [50.0, 60.0])
def test_what_angles_of_neighbouring_pictures_have_in_common_does_not_last(fps: float) -> None:
    each = []
    for seed in range(SHOTS):
        rng = np.random.default_rng([73, seed])
        seen = watch(hit_motion(1.2, 0.08, after=1.5), rng, fps=fps, sd_theta=1e-5)
        for _, group in seen.groupby("stone"):
            seen.loc[group.index, "theta"] += lasting(rng, group["t"].to_numpy(), 0.02, 0.016)
        each.append(seen.assign(sd_theta=0.02))
    white, slow = usual(each)
    assert white[2] == pytest.approx(0.02, rel=0.2)
    assert slow[2] < 0.018


def test_a_brief_glide_at_many_pictures_a_second_tells_how_it_errs() -> None:
    t = np.arange(40) / 500
    off = np.random.default_rng(5).normal(0, 1, len(t))
    means = Run("A", np.arange(len(t)), t, off, 3.0).means(BRIEF)
    assert means.each == 3
    assert means.off[1] == pytest.approx(off[3:6].mean())
    assert means.t[1] == pytest.approx(t[4])
    assert means.samples[:3].tolist() == [0, 3, 6]
    assert len(local_residuals(means.t, means.off[:, None])) >= FEWEST


def test_pictures_that_are_far_enough_apart_count_each() -> None:
    t = np.arange(40) / 30
    run = Run("A", np.arange(len(t)), t, np.zeros(len(t)), 3.0)
    assert run.means(BRIEF) is run


def test_what_is_stated_is_lasting_where_it_does_not_scatter() -> None:
    states = {"sd_x": 0.012, "sd_y": 0.012, "sd_theta": 0.06}
    white, slow = usual([seen.assign(**states) for seen in shots()])
    assert white == pytest.approx([0.004, 0.004, 0.02], rel=0.15)
    # The residuals, which show no such thing, have their say as well.
    assert np.all(slow > [0.002, 0.002, 0.015])
    assert np.all(slow < [0.012, 0.012, 0.06])


def test_a_detection_that_lies_off_is_a_worse_one() -> None:
    seen = shots()[0]
    at = seen.index[(seen["stone"] == "A") & (seen["frame"] == 12)][0]
    off = seen.copy()
    off.loc[at, ["x", "theta"]] += [0.025, 0.12]
    noise, plain = told(off)["A"], told(seen)["A"]
    assert np.all(noise.white[12, [0, 2]] > 2 * plain.white[12, [0, 2]])
    others = np.arange(len(noise.white)) != 12
    assert np.median(noise.white[others, 0]) == pytest.approx(
        np.median(plain.white[others, 0]), rel=0.3
    )


def test_an_angle_that_bends_more_than_ice_turns_a_stone_is_wrong() -> None:
    seen = shots()[0]
    bent = seen.copy()
    after = (seen["stone"] == "B") & (seen["t"] > 1.6)
    bent.loc[after, "theta"] -= 0.5 * (seen["t"][after] - 1.6) ** 2
    noise, plain = told(bent)["B"], told(seen)["B"]
    assert noise.slow[-1, 2] > 3 * plain.slow[-1, 2]
    assert noise.white[-1, 2] == pytest.approx(plain.white[-1, 2], rel=0.3)


def test_stones_that_never_move_err_as_is_stated() -> None:
    t = np.arange(30) / 25
    still = pd.DataFrame({"stone": "A", "frame": np.arange(30), "t": t, "x": 0.3, "y": 0.1})
    still = still.assign(theta=np.nan, sd_x=0.002, sd_y=0.002, sd_theta=np.nan, team="")
    noise = told(still)["A"]
    assert noise.white[:, :2] == pytest.approx(0.002)
    assert np.all(noise.slow == 0)
    assert np.isnan(noise.white[:, 2]).all()


def test_what_a_few_detections_are_much_worse_by_is_anew_in_them() -> None:
    seen = shots(slow=0.004)[0]
    before = told(seen)
    for name, group in seen.groupby("stone"):
        worse = seen.copy()
        worse.loc[group.index[:3], ["sd_x", "sd_y"]] *= 20
        after = told(worse)[str(name)]
        usually = np.median(after.slow, axis=0)[:2]
        assert np.all(after.slow[:3, :2] <= 2.001 * usually)
        assert np.all(after.white[:3, :2] > 5 * before[str(name)].white[:3, :2])
        np.testing.assert_allclose(after.slow[3:, :2], np.tile(usually, (len(group) - 3, 1)))


def test_a_few_detections_far_off_hardly_widen_the_others() -> None:
    scatter = np.random.default_rng(7).normal(0, 1, (1000, 1))
    scatter[::50] = 30.0
    assert 0.9 < _square(scatter) < 1.3
