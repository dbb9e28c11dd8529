from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
import pytest

from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.synthetic.physics import Ice, Start, simulate
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch

SLOW, RESTITUTION, NOISE = 0.0109, 0.83, 0.003


@cache
def seen(glides: int) -> pd.DataFrame:
    """A hit of A on B, and other stones that glide aside of it."""
    rng = np.random.default_rng(4)
    tables = [watch(hit_motion(1.5, 0.06, friction=SLOW), rng, sd=NOISE)]
    for rank in range(glides):
        start = Start(1.5 - 3 * rank, -2.0, 0.0, 1.3 + 0.3 * rank, 0.0, 1.0)
        alone = simulate([start], 3.0, ice=Ice(b=SLOW), step=5e-4, keep_every=4)
        tables.append(watch(alone, rng, sd=NOISE).assign(stone="XYZ"[rank]))
    return pd.concat(tables, ignore_index=True)


@cache
def even() -> Estimates:
    return measure(seen(2))


def measure(table: pd.DataFrame) -> Estimates:
    return estimate(table, detect_hits(table, RADIUS), radius=RADIUS)


def bent(table: pd.DataFrame, stone: str, aside: float, middle: float = 2.2) -> pd.DataFrame:
    """A track drawn aside for a while, m, as by someone in front of the stone."""
    out, own = table.copy(), table["stone"] == stone
    out.loc[own, "y"] += aside * np.exp(-0.5 * ((out.loc[own, "t"] - middle) / 0.3) ** 2)
    return out


@pytest.mark.parametrize("glides", [0, 2])
def test_tracks_that_are_as_they_state_stay_as_they_are(glides: int) -> None:
    found = even() if glides == 2 else measure(seen(glides))
    assert found.warnings == ()
    assert {one.stone for one in found.residuals} == {*"ABXY"[: 2 + glides]}
    assert max(one.rms_ratio for one in found.residuals) < 1.8
    assert not any(one.significant or one.downweighted for one in found.residuals)


@pytest.mark.parametrize(
    ("stone", "aside", "apart"), [("A", 0.1, 0.4), ("B", 0.02, 1.0), ("X", 0.05, 0.2)]
)
def test_a_bent_track_is_named_and_leads_no_estimate_astray(
    stone: str, aside: float, apart: float
) -> None:
    found = measure(bent(seen(2), stone, aside))
    assert {one.stone for one in found.residuals if one.downweighted} == {stone}
    assert any(one.significant for one in found.residuals if one.downweighted)
    assert any(f"the track of {stone} deviates" in warning for warning in found.warnings)
    assert found.shot_fit is not None
    for name, truth in (("restitution", RESTITUTION), ("friction", SLOW)):
        told, before = found.shot_fit[name], even().shot_fit
        assert abs((told.value or 0.0) - truth) < 3 * (told.stderr or 0.0)
        # it is the others' tracks that tell them, about as well as before
        assert before is not None
        off = (told.value or 0.0) - (before[name].value or 0.0)
        assert abs(off) < apart * (told.stderr or 0.0)
        assert (told.stderr or 1.0) < 4 * (before[name].stderr or 0.0)


def test_the_worse_bent_it_is_the_larger_its_misfit() -> None:
    sizes = [
        max(one.rms_ratio for one in measure(bent(seen(2), "X", aside)).residuals)
        for aside in (0.015, 0.045)
    ]
    assert sizes[1] / sizes[0] == pytest.approx(3, rel=0.2)


@pytest.mark.parametrize(("aside", "certain"), [(0.0075, False), (0.01, True)])
def test_a_bend_counts_from_twice_its_error_on(aside: float, certain: bool) -> None:
    own = [one for one in measure(bent(seen(2), "X", aside)).residuals if one.stone == "X"]
    assert [one.significant for one in own] == [certain]


def test_two_bent_tracks_of_five_are_left_out_both() -> None:
    found = measure(bent(bent(seen(3), "X", 0.06), "Y", -0.06, 1.5))
    assert {one.stone for one in found.residuals if one.downweighted} == {"X", "Y"}


def test_a_second_bent_track_is_named_beside_one_that_is_left_out() -> None:
    found = measure(bent(bent(seen(2), "X", 0.06), "Y", -0.06, 1.5))
    assert {one.stone for one in found.residuals if one.downweighted} == {"X"}
    assert {one.stone for one in found.residuals if one.significant} == {"X", "Y"}


def test_of_two_stones_that_contradict_each_other_neither_is_left_out() -> None:
    found = measure(bent(seen(0), "B", 0.03))
    assert not any(one.downweighted for one in found.residuals)
    assert any("too few stones move to identify" in text for text in found.warnings)


def test_outliers_bend_no_track() -> None:
    table = seen(2).copy()
    table.loc[table.index[table["stone"] == "X"][20:80:20], "y"] += 0.2
    found = measure(table)
    assert not any(one.significant for one in found.residuals)


def test_an_error_that_places_share_is_no_misfit() -> None:
    table = bent(seen(2), "X", 0.02)
    shared = measure(table.assign(sd_place_x=0.02, sd_place_y=0.02))
    assert not any(one.significant for one in shared.residuals)


def test_a_bent_track_of_a_stone_by_itself_is_not_laid_to_another() -> None:
    table = bent(seen(1), "X", 0.06)
    (text,) = [w for w in measure(table[table["stone"] == "X"]).warnings if "track of X" in w]
    assert "something else moves the stone" in text and "another" not in text
