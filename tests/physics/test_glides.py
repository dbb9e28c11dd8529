from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from data.sheet import GRAVITY
from data.tracks import check_sightings
from physics.estimate import estimate


def glide(duration: float, sd_place: float, wobble: float) -> pd.DataFrame:
    """A stone that slows by 0.1 m/s², seen with an error that bends with the place."""
    t = np.arange(0, duration, 0.04)
    y = 1.5 * t - 0.05 * t**2
    seen = y + wobble * np.sin(2 * np.pi * y / y[-1])
    table = pd.DataFrame({"stone": "A", "frame": np.arange(len(t)), "t": t, "x": 0.0, "y": seen})
    return check_sightings(
        table.assign(sd_x=0.001, sd_y=0.001, sd_place_x=sd_place, sd_place_y=sd_place)
    )


@pytest.mark.parametrize("duration", [1.0, 2.0, 4.0])
def test_an_error_that_places_share_tells_in_the_friction(duration: float) -> None:
    honest = estimate(glide(duration, 0.002, 0.002), (), radius=0.1455).friction
    assert honest.value is not None and honest.stderr is not None
    assert abs(honest.value - 0.1 / GRAVITY) < 2 * honest.stderr
    assert honest.stderr < 0.02
    told, blind = (
        estimate(glide(duration, sd_place, 0.0), (), radius=0.1455).friction.stderr
        for sd_place in (0.002, 0.0)
    )
    assert told is not None and blind is not None and blind < told
