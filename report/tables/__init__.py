"""The tables of a shot, as DataFrames: SI units, one fact a column, NaN or None where unknown."""

from curlshot.report.tables.coach import speed_table, takeout_table
from curlshot.report.tables.laws import choice_table, ice_table, law_table, method_table
from curlshot.report.tables.rest import distance_table, last_speed, rest_table, shot_stone
from curlshot.report.tables.shot import (
    glide_table,
    hit_table,
    moving_stones,
    play,
    residual_table,
    score_table,
    scored_stones,
    stone_table,
)
from curlshot.report.tables.states import in_axes, magnitude, measured_table, simulated_table

__all__ = [
    "choice_table",
    "distance_table",
    "glide_table",
    "hit_table",
    "ice_table",
    "in_axes",
    "last_speed",
    "law_table",
    "magnitude",
    "measured_table",
    "method_table",
    "moving_stones",
    "play",
    "residual_table",
    "rest_table",
    "score_table",
    "scored_stones",
    "shot_stone",
    "simulated_table",
    "speed_table",
    "stone_table",
    "takeout_table",
]
