from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.config import Config
from curlshot.data.errors import SceneError
from curlshot.data.measurement import Measurement
from curlshot.data.sheet import HOUSE
from curlshot.data.tracks import DETECTION_COLUMNS
from curlshot.pipeline import analyse


def test_samples_that_cannot_be_drawn_are_not_left_out_in_silence() -> None:
    still = pd.DataFrame({"stone": "A", "frame": range(20), "t": np.arange(20) / 25})
    still = still.assign(
        x=0.1, y=0.2, team="", sd_x=0.003, sd_y=0.003, sd_place_x=0.0, sd_place_y=0.0
    )
    still = still.reindex(columns=list(DETECTION_COLUMNS))
    seen = Measurement((Path("still.csv"),), still, 25.0, 20, ())
    steps = []
    done = analyse(seen, Config().replace(samples=10), lambda *step: steps.append(step))
    assert steps == [("physics", 0, 1), ("physics", 1, 1)]
    assert done.posterior is None
    assert any("no samples" in text for text in done.results.warnings)
    assert not any("no samples" in text for text in analyse(seen).results.warnings)


@pytest.mark.parametrize("across", [False, True])
def test_a_table_that_goes_across_a_sheet_has_none(across: bool) -> None:
    t = np.arange(50) / 25
    way = 2.0 - 1.2 * t + 0.5 * 0.0109 * 9.81 * t**2
    noise = np.random.default_rng(0).normal(0, 0.0003, (2, 50))
    places = (
        {"x": way + noise[0], "y": noise[1]} if across else {"x": noise[0], "y": way + noise[1]}
    )
    glide = pd.DataFrame({"stone": "A", "frame": range(50), "t": t, "team": "", **places})
    glide = glide.assign(sd_x=0.0003, sd_y=0.0003, sd_place_x=0.0, sd_place_y=0.0)
    glide = glide.reindex(columns=list(DETECTION_COLUMNS))
    done = analyse(Measurement((Path("glide.csv"),), glide, 25.0, 50, (), house=HOUSE))
    assert (done.house is None, done.results.origin_at_tee) == (across, not across)
    assert any("put the origin on the tee" in text for text in done.results.warnings) == across


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (Config(), "`house` corrects it"),
        (Config().replace(stick=(1.0, 1.0, 90.0, 1.0, 0.5)), "verify `radius` and `stick`"),
        (Config().replace(camera=Path("camera.csv")), "verify `radius` and `camera`"),
    ],
)
def test_what_to_do_where_no_stone_was_found_goes_by_how_the_camera_was_known(
    settings: Config, said: str
) -> None:
    nothing = pd.DataFrame(columns=list(DETECTION_COLUMNS))
    with pytest.raises(SceneError, match=rf"a\.mp4: no stone was found; `check` .*{said}$"):
        analyse(Measurement((Path("a.mp4"),), nothing, 25.0, 20, ()), settings)
