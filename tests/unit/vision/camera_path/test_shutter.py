from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.tests.helpers.vision.shutter import (
    SIZE,
    before,
)
from curlshot.vision.camera_path.joint import Seen, spread
from curlshot.vision.camera_path.shutter import (
    LEAST_SMEAR,
    RANGE,
    UNTOLD,
    ShutterLight,
    Smeared,
)
from curlshot.vision.camera_path.smear import SHARP
from curlshot.vision.optics.paint import EIGHT, TWELVE
from curlshot.vision.sheet.mixing import half_light
from curlshot.vision.sheet.outline import PaintEdge
from curlshot.vision.video.disk_cache import Cached


def test_a_house_that_comes_into_view_in_a_pan_is_fitted_where_it_is_sharp() -> None:
    marks = Cached(before().evidence.marks)
    seen = [
        Seen(k, k / 25, before().view, marks, True, smeared=8.0 if k < 6 else 0.5)
        for k in range(16)
    ]
    assert [s.index for s in spread(seen, 4)] == [6, 9, 12, 15]
    assert [s.index for s in spread(seen, 12)] == [0, 1, 3, 4, 5, 7, 8, 10, 11, 12, 14, 15]
    assert [s.index for s in spread(seen[6:] + seen[:6], 4)] == [6, 11, 0, 5]


def test_what_is_smeared_across_the_pan_stays_where_it_is() -> None:
    palette = before().evidence.palette
    half = half_light(palette)
    assert half[TWELVE] < -0.1
    line, normal = (
        np.array([TWELVE, TWELVE, EIGHT]),
        np.array([[0.0, 1.0], [1.0, 0.0], [0.0, -1.0]]),
    )
    edge = PaintEdge(light=(0.5 * half[0], 0.5 * half[1], 0.5 * half[2]))
    smeared = Smeared(np.array([0.0, 40 * SHARP]), palette, edge)
    more = smeared.levels(line, normal, 1.0)
    assert more is not None
    np.testing.assert_allclose(more, [0.5 * half[TWELVE], 0.0, 0.5 * half[EIGHT]], atol=2e-3)
    slow = replace(smeared, sweep=np.array([0.0, 0.9 * LEAST_SMEAR]))
    assert slow.levels(line, normal, 1.0) is None


def test_a_slow_pan_or_few_edges_tell_nothing() -> None:
    house = before()
    marks, asked = house.evidence.marks, (house.view, house.rig, SIZE, 0.0)
    fast = Smeared(np.array([0.0, 12.0]), house.evidence.palette, house.edge)
    slow = replace(fast, sweep=np.array([0.0, 0.9 * LEAST_SMEAR]))
    assert fast.told(marks, *asked) is not None
    assert slow.told(marks, *asked) is None
    assert fast.told(marks.pick(np.arange(10)), *asked) is None
    near = marks.pick((marks.line == TWELVE) & (np.abs(marks.along) < 0.3))
    assert fast.told(near, *asked) is None


def test_the_share_is_that_of_pictures_at_rest_until_a_pan_tells_it() -> None:
    palette = before().evidence.palette
    half = half_light(palette)
    start = ShutterLight.of(PaintEdge(light=(0.8 * half[0], 0.0, 0.0)), palette)
    assert start.share == pytest.approx(0.8) and start.sd == UNTOLD
    assert ShutterLight.of(PaintEdge(), palette).share == 0.0
    now = start
    for _ in range(20):
        now = now.taking(0.1, 0.1)
    assert now.share == pytest.approx(0.1, abs=0.02) and now.sd < 0.05
    assert now.taking(9.0, 1e-3).share == RANGE[1]
