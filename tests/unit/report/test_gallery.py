from __future__ import annotations

import dataclasses

import pytest

from curlshot.data.sheet import HOUSE
from curlshot.report.gallery import pictures


def names(shot, **changes):
    given = {"tracks": shot.tracks, "simulations": shot.simulations, "house": HOUSE, **changes}
    results = given.pop("results", shot.results)
    return [picture.name for picture in pictures(results, **given)]


def test_figures_come_in_the_order_of_the_page(shot):
    moved = [f"{what}_{s}" for s in "ABC" for what in ("motion", "spin", "simulated")]
    hits = ["hit_1", "hit_2"]
    assert names(shot) == ["plan", "speed", *moved, *hits, "friction", "posterior"]


def test_there_is_no_figure_of_what_is_not_known(shot):
    blind = shot.tracks.assign(theta=float("nan"))
    said = names(
        shot,
        tracks=blind,
        simulations={},
        results=dataclasses.replace(shot.results, collisions=(), glides=(), joint_estimate=None),
    )
    assert said == ["plan", "speed", "motion_A", "motion_B", "motion_C"]


def test_of_stones_that_all_lie_still_there_is_the_plan(shot):
    still = shot.tracks[shot.tracks["stone"] == "D"]
    results = dataclasses.replace(shot.results, collisions=(), glides=(), joint_estimate=None)
    assert names(shot, tracks=still, simulations={}, results=results) == ["plan"]


def test_names_of_files_differ_on_every_disk(shot):
    new = {"A": "a/b", "B": "A_B", "C": "a\\b"}
    tracks = shot.tracks.replace({"stone": new})
    results = dataclasses.replace(shot.results, collisions=(), glides=(), joint_estimate=None)
    found = [n for n in names(shot, tracks=tracks, results=results) if n.startswith("motion")]
    assert sorted(name.lower() for name in found) == ["motion_a_b", "motion_a_b-2", "motion_a_b-3"]


@pytest.mark.parametrize("rows", [1, 2])
def test_residuals_need_more_than_one_time(shot, rows):
    from curlshot.report.tables import residual_table

    table = residual_table(shot.tracks[shot.tracks["frame"] < rows], shot.tracks)
    assert ("residuals" in names(shot, residuals=table)) == (rows > 1)
