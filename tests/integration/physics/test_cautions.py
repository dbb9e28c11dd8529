from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.measurement import Measurement
from curlshot.data.sheet import HOUSE
from curlshot.data.tracks import DETECTION_COLUMNS, check_detections
from curlshot.pipeline import analyse
from curlshot.tests.helpers.physics.watch import hit_motion, watch


@pytest.mark.parametrize(
    ("slower", "said"), [(1.0, ""), (4.0, "slow motion"), (0.4, "fast motion")]
)
def test_a_clip_in_slow_motion_is_told_by_its_friction(slower: float, said: str) -> None:
    t = np.arange(50) / 25
    y = 2.0 - 1.2 * (t / slower) + 0.5 * 0.0109 * 9.81 * (t / slower) ** 2
    noise = np.random.default_rng(0).normal(0, 0.0003, (2, 50))
    glide = pd.DataFrame({"stone": "A", "frame": range(50), "t": t, "x": noise[0]})
    glide = glide.assign(
        y=y + noise[1], team="", sd_x=0.0003, sd_y=0.0003, sd_place_x=0.0, sd_place_y=0.0
    )
    glide = glide.reindex(columns=list(DETECTION_COLUMNS))
    seen = Measurement((Path("glide.csv"),), glide, 25.0, 50, (), house=HOUSE)
    warnings = [w for w in analyse(seen).results.warnings if "motion" in w]
    assert [said in w for w in warnings] == [True] * bool(said)


def test_a_second_throw_is_told() -> None:
    glides = []
    for stone, aside, begins in (("A", 0.0, 0.0), ("B", 0.8, 5.0)):
        t = begins + np.arange(100) / 25
        speed = np.maximum(0.3 - 0.0109 * 9.81 * (t - begins), 0.0)
        glides.append(
            pd.DataFrame({"stone": stone, "t": t, "x": aside, "y": np.cumsum(-speed / 25)})
        )
    table = check_detections(pd.concat(glides))
    table[["x", "y"]] += np.random.default_rng(0).normal(0, 0.001, (len(table), 2))
    seen = Measurement((Path("two.csv"),), table, 25.0, 200, ())
    (said,) = [text for text in analyse(seen).results.warnings if "more than one throw" in text]
    assert "B at 5.00 s" in said
    one = Measurement((Path("one.csv"),), table[table["stone"] == "A"], 25.0, 100, ())
    assert not any("throw" in text for text in analyse(one).results.warnings)


@pytest.mark.parametrize(("frames", "warned"), [(1, False), (3, True), (4, False)])
def test_too_few_frames_to_tell_motion_are_said(frames: int, warned: bool) -> None:
    seen = pd.DataFrame({"stone": "A", "frame": range(frames), "t": np.arange(frames) / 25})
    seen = seen.assign(x=0.1, y=2.0 - 0.04 * seen["frame"], team="", sd_x=0.002, sd_y=0.002)
    seen = seen.reindex(columns=list(DETECTION_COLUMNS))
    said = analyse(Measurement((Path("few.csv"),), seen, 25.0, frames, ())).results.warnings
    assert any("too few to identify which ones move" in text for text in said) == warned


def test_marks_that_no_track_heeds_are_named() -> None:
    seen = watch(hit_motion(1.5, 0.05), np.random.default_rng(39), sd=0.002)
    measured = Measurement((Path("shot.csv"),), seen, 30.0, 90, ())
    assert not any("left out" in text for text in analyse(measured).results.warnings)
    slipped = seen.copy()
    slipped.loc[[20, 130], "x"] += 0.3
    times = [f"{seen.loc[k, 'stone']} at {seen.loc[k, 't']:.2f} s (30 cm off)" for k in (20, 130)]
    [said] = [
        text
        for text in analyse(replace(measured, table=slipped)).results.warnings
        if "left out" in text
    ]
    assert all(each in said for each in times)
