from __future__ import annotations

import pandas as pd
import pytest

from curlshot.report.tables.teams import colour_word, team_names
from curlshot.tests.helpers.report.glides import glide


@pytest.mark.parametrize(
    ("colour", "word"),
    [
        ("#c02030", "red"),
        ("#e8d020", "yellow"),
        ("#2040c0", "blue"),
        ("#208040", "green"),
        ("#f0f0f0", "white"),
        ("#101010", "black"),
        ("Team Sweden", "Team Sweden"),
        ("", ""),
    ],
)
def test_colours_have_words(colour: str, word: str):
    assert colour_word(colour) == word


def test_two_teams_of_one_colour_word_keep_their_colours():
    tracks = pd.concat(
        [glide("A", (0, 0), end=1.0, team="#c02030"), glide("B", (1, 0), end=1.0, team="#e03040")]
    )
    assert team_names(tracks) == {"A": "#c02030", "B": "#e03040"}
