from __future__ import annotations

from dataclasses import replace

import pandas as pd
import pytest

from curlshot.data.results import Estimate
from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.prediction.forecast import ASSUMED, predict
from curlshot.physics.prediction.replay import simulate_measured
from curlshot.physics.prediction.throws import come_in, later_throws
from curlshot.tests.helpers.physics.throws import MU, SECOND, two_throws
from curlshot.tests.helpers.physics.watch import RADIUS


@pytest.fixture(scope="module")
def both() -> tuple[pd.DataFrame, pd.DataFrame, Estimates]:
    seen = two_throws()
    hits = detect_hits(seen, RADIUS)
    assert [hit.stones for hit in hits] == [("A", "B"), ("C", "A")]
    return seen, smooth(seen, hits, radius=RADIUS), estimate(seen, hits, radius=RADIUS)


def test_a_stone_that_comes_in_when_all_have_stopped_is_another_throw(both) -> None:
    _, tracks, _ = both
    assert later_throws(tracks) == {"C": pytest.approx(SECOND, abs=0.05)}
    assert come_in(tracks, 1.0).keys() == {"C"}
    one = tracks[tracks["stone"] != "C"]
    assert later_throws(one) == {}
    # What comes in while another moves may have been hit out of sight, or be that one.
    sooner = tracks.assign(t=tracks["t"].where(tracks["stone"] != "C", tracks["t"] - 3.8))
    assert later_throws(sooner) == {}
    # A stone that moved when it was last seen, a moment ago, may be the one that comes in.
    lost = tracks[(tracks["stone"] != "B") | (tracks["t"] < 1.5)]
    assert later_throws(lost) == {}
    after = lost.assign(t=lost["t"].where(lost["stone"] != "C", lost["t"] + 5.0))
    assert later_throws(after).keys() == {"C"}


def test_what_another_throw_does_is_not_foretold(both) -> None:
    seen, tracks, found = both
    laws = replace(ASSUMED, friction=Estimate(MU, 0.001))
    made = predict(seen, tracks, found, radius=RADIUS, laws=laws)["frictional"]
    assert made.rest_error.keys() == {"B"}  # A is hit by C
    assert made.rmse is not None and made.rmse < 0.1


def test_without_a_fit_of_the_whole_it_is_not_simulated_again(both) -> None:
    _, tracks, found = both
    alone = simulate_measured(tracks, replace(found, shot_fit=None), radius=RADIUS)
    assert set(alone.samples["frictional"]["stone"]) == {"A", "B"}
    assert alone.scores["frictional"].rest_error.keys() == {"B"}
    whole = simulate_measured(tracks, found, radius=RADIUS)
    assert found.shot_fit is not None
    assert set(whole.samples["frictional"]["stone"]) == {"A", "B", "C"}
    assert whole.scores["frictional"].rest_error.keys() == {"A", "B", "C"}


def test_a_first_throw_alone_is_no_second_one(both) -> None:
    _, tracks, _ = both
    late = tracks[(tracks["t"] > 3.8)]
    assert later_throws(late) == {}
