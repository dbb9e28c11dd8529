from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from data.results import Estimate, Prediction
from physics.contacts import find_contacts
from physics.estimate import estimate
from physics.forecast import predict
from physics.kalman import smooth
from physics.watched import LITERATURE
from tests.physics.watch import RADIUS, hit_motion, watch
from tests.synthetic.physics import Start


def forecast(
    seen: pd.DataFrame, restitution: Estimate = LITERATURE.restitution
) -> dict[str, Prediction]:
    contacts = find_contacts(seen, RADIUS)
    tracks = smooth(seen, contacts, radius=RADIUS)
    found = estimate(seen, contacts, radius=RADIUS)
    return predict(seen, tracks, found, radius=RADIUS, restitution=restitution)


def test_last_places_are_predicted_from_before_the_hit() -> None:
    # The laws assumed happen to be the true ones; the second hit follows from the first.
    motion = hit_motion(1.2, 0.08, before=2.0, after=2.0, others=(Start(0.0, 0.7),))
    made = forecast(watch(motion, np.random.default_rng(1), sd=0.003))
    frictional = made["frictional"]
    assert frictional.rmse is not None
    assert frictional.rmse < 0.03
    assert sorted(frictional.rest_error) == ["A", "B", "C"]
    for stone, error in frictional.rest_error.items():
        sd = frictional.rest_sd[stone]
        assert sd is not None
        assert error is not None
        assert error < 2 * sd
    soon = frictional.error_after
    assert sorted(soon) == ["A", "B", "C"]
    assert all(error is not None and error < 0.02 for error in soon.values())
    assert made["rigid-body"].rmse is None
    assert "spins" in (made["rigid-body"].note or "")


def test_what_comes_after_the_hit_is_not_used() -> None:
    seen = watch(hit_motion(1.2, 0.08, before=2.0, restitution=0.5), np.random.default_rng(2))
    wrong, right = (
        forecast(seen, restitution=Estimate(e, 0.01))["frictional"] for e in (0.95, 0.5)
    )
    assert wrong.rmse is not None
    assert right.rmse is not None
    assert right.rmse < 0.03
    assert wrong.rmse > 3 * right.rmse
    assert wrong.restitution == Estimate(0.95, 0.01)


def test_no_hit_is_no_prediction() -> None:
    seen = watch(hit_motion(before=1.0), np.random.default_rng(3))
    early = seen[seen["t"] < 0.8].reset_index(drop=True)
    assert forecast(early) == {}


@pytest.mark.parametrize("frames", [1, 3])
def test_too_little_before_the_hit_is_said(frames: int) -> None:
    seen = watch(hit_motion(1.2, 0.08), np.random.default_rng(4))
    contacts = find_contacts(seen, RADIUS)
    early = seen["t"] < contacts[0].t
    kept = seen[~early | seen["frame"].isin(np.sort(seen["frame"][early].unique())[-frames:])]
    kept = kept.reset_index(drop=True)
    found = estimate(kept, contacts, radius=RADIUS)
    made = predict(kept, smooth(kept, contacts, radius=RADIUS), found, radius=RADIUS)
    frictional = made["frictional"]
    far = max((sd or 0.0 for sd in frictional.rest_sd.values()), default=np.inf)
    assert frictional.note is not None or far > 0.1
