from __future__ import annotations

import pytest

from curlshot.data.coach_units import FEET
from curlshot.data.sheet import HOUSE
from curlshot.report.coach_listing import coach_tables


def by_name(shot, *unit):
    return {t.name: t for t in coach_tables(shot.results, shot.tracks, HOUSE, *unit)}


def test_feet_are_metres_by_another_name(shot):
    metres, feet = by_name(shot), by_name(shot, FEET)
    for name in ("coach_stones", "coach_distances", "coach_hits"):
        assert feet[name].frame.equals(metres[name].frame)
        units = {column.unit for column in feet[name].head}
        assert units & {"ft", "ft/s"}
        assert not units & {"m", "m/s"}
    row = feet["coach_distances"].records[0]
    tee = next(c for c in feet["coach_distances"].head if c.key == "tee")
    assert float(tee.parts(row)[0]) == pytest.approx(row["tee"] / 0.3048, abs=0.06)


def test_notes_name_lengths_in_the_unit_of_the_table(shot):
    metres, feet = by_name(shot), by_name(shot, FEET)

    def notes(table):
        (column,) = (column for column in table.head if column.key == "note")
        return " ".join(column.parts(row)[0] for row in table.records)

    for name in ("coach_stones", "coach_speeds"):
        said = notes(metres[name])
        assert notes(feet[name]) == FEET.converted(said) != said


def test_every_stone_that_stopped_has_a_distance_to_every_other(shot):
    table = by_name(shot)["coach_distances"]
    stones = ["A", "B", "D"]  # C still moves as the clip ends
    heads = [column.title for column in table.head]
    assert heads == ["stone", "to the tee", *(f"to {stone}" for stone in stones)]
    assert [row["stone"] for row in table.records] == stones
    assert table.note == "From centre to centre, each ± 5.7 mm or less."  # √2 of 4 mm


def test_the_note_says_who_lies_shot(shot):
    assert by_name(shot)["coach_stones"].note.startswith("Shot stone: ")
