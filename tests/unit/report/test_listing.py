from __future__ import annotations

from dataclasses import replace

import pytest

from curlshot.data.results import Prediction
from curlshot.data.sheet import HOUSE
from curlshot.report.listing import page_tables


@pytest.fixture(scope="module")
def made(shot):
    return {t.name: t for t in page_tables(shot.results, shot.tracks, HOUSE)}


def test_the_tables_of_the_study_and_of_coaches_are_there(made):
    names = list(made)
    assert names[:4] == ["coach_stones", "coach_speeds", "coach_hits", "coach_distances"]
    assert {"table_1_laws", "table_2_measured", "table_4_point-mass"} <= set(names)
    assert {"methods", "laws_tried", "ice"} <= set(names)
    assert "table_3_rigid-body" not in names  # it could not run


def test_predictions_stand_beside_what_was_fitted(shot):
    known = Prediction(0.02, {"A": 0.031}, {"A": 0.05})
    results = replace(
        shot.results, predictions={"frictional": known, "rigid-body": Prediction(None)}
    )
    made = {t.name: t for t in page_tables(results, shot.tracks)}
    assert list(made["predictions"].frame["model"]) == ["frictional"]
    assert list(made["predictions"].frame["A"]) == [0.031]
    (row,) = made["predictions"].frame.to_dict("records")
    assert made["predictions"].columns[2].parts(row) == ("31", "50")
    assert "prior knowledge of μ, with e assumed." in made["predictions"].note
    assert "shot fit" in made["models"].note
    assert "start of the shot fit" in made["table_4_point-mass"].note
    other = page_tables(replace(results, joint_estimate=None, predictions={}), shot.tracks)
    alone = {table.name: table for table in other}
    assert "predictions" not in alone
    assert "from the state before" in alone["models"].note
    assert "before the first hit" in alone["table_4_point-mass"].note


def test_without_a_house_there_is_nothing_for_coaches(shot):
    names = [table.name for table in page_tables(shot.results, shot.tracks, None)]
    assert not [name for name in names if name.startswith("coach")]


def test_empty_notes_take_no_room(made):
    assert "note" not in [column.title for column in made["coach_hits"].head]
    assert "note" in [column.title for column in made["hits"].head]


def test_why_a_hit_tells_no_friction_between_stones(shot):
    hits = tuple(replace(hit, note_stone_friction="no spin") for hit in shot.results.collisions)
    made = {t.name: t for t in page_tables(replace(shot.results, collisions=hits), shot.tracks)}
    column = next(c for c in made["hits"].head if c.title == "note on that friction")
    assert column.parts(made["hits"].records[0])[0] == "no spin"


def test_which_glides_are_left_out_is_said(made):
    assert "with an error of 0.02 or less. Shorter glides are left out" in made["glides"].note
