from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from curlshot.synthetic import PAINTS, CameraPath, Light, Scene, render_still, still_camera
from curlshot.vision.camera_path.edge_tracker import EdgeTracker
from curlshot.vision.camera_path.joint import Seen, spread
from curlshot.vision.camera_path.shutter import (
    LEAST_SMEAR,
    RANGE,
    UNTOLD,
    ShutterLight,
    Smeared,
    more_light,
)
from curlshot.vision.camera_path.smear import SHARP
from curlshot.vision.optics.paint import EIGHT, TWELVE
from curlshot.vision.optics.pose import View, camera
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit
from curlshot.vision.sheet.mixing import half_light
from curlshot.vision.sheet.outline import PaintEdge
from curlshot.vision.video.disk_cache import Cached
from curlshot.vision.video.frame import Frame

SIZE = (960, 540)
HEIGHT, PX_PER_M = 9.0, 100.0

BEFORE, MIDDLE, SWEPT = 0.05, 0.35, 0.15
"""Where the camera looks, m: in the frame before, at mid-exposure, and how far it goes in one."""

OUTLINED = replace(PAINTS["navy-orange"], outline=(25.0, 22.0, 20.0))
SCENE = replace(Scene(paint=OUTLINED), light=Light(noise=0.0, glare=0.0))
AROUND = np.linspace(0, 2 * np.pi, 24, endpoint=False)
RIM = 1.829 * np.stack([np.cos(AROUND), np.sin(AROUND)], axis=-1)


def looking(y: float) -> CameraPath:
    return still_camera(size=SIZE, position=(0.1, -0.1, HEIGHT), target=(0.1, y), px_per_m=PX_PER_M)


@cache
def moments() -> list[np.ndarray]:
    """What one exposure shows, bit by bit, from 0 to 1."""
    places = MIDDLE + SWEPT * (np.arange(19) / 18 - 0.5)
    return [render_still(SCENE, looking(y)) / 255.0 for y in places.tolist()]


def exposed(gamma: float) -> np.ndarray:
    """A pan's picture: the mean of its moments' codes, or of their light if gamma is 2.2."""
    light = np.mean([moment**gamma for moment in moments()], axis=0)
    noise = np.random.default_rng(3).normal(0, 1.0, light.shape)
    return np.clip(255 * light ** (1 / gamma) + noise, 0, 255).round().astype(np.uint8)


@cache
def before() -> HouseFit:
    found = find_house(render_still(SCENE, looking(BEFORE)))
    assert found is not None
    return found


def aside(view: View, rig: np.ndarray) -> float:
    """How far a view of the smeared picture has the rim aside along the pan at most, mm."""
    true = looking(MIDDLE).at(0.0).project(np.c_[RIM, np.zeros(len(RIM))])
    inside = ((true > 0) & (true < SIZE)).all(1)
    seen = camera(view, rig, SIZE, frame=0, t=0.0, rms_px=0.0).ice(true[inside])
    return 1e3 * float(np.abs((seen - RIM[inside])[:, 1]).max())


@pytest.mark.parametrize(("gamma", "share"), [(2.2, 1.0), (1.0, 0.0)])
def test_a_pan_tells_what_its_shutter_blurs(gamma: float, share: float) -> None:
    """An outline hides it in the frame before; taken for codes, light puts the rim 14 mm aside."""
    house = before()
    assert abs(house.edge.light[TWELVE]) < 0.02
    edges = EdgeTracker(SIZE, house.evidence.palette, house.edge)
    ahead = View(house.view.vector - np.array([(MIDDLE - BEFORE) / HEIGHT, 0.0, 0.0, 0.0]))
    (seen,) = edges.settle([Frame(1, 0.04, exposed(gamma))], [ahead], house.rig, house.view)
    smeared = Smeared(edges.sweep, edges.palette, house.edge)
    told = smeared.told(seen.marks.get(), seen.view, house.rig, SIZE, share)
    assert told is not None
    assert abs(told[0] - share) < 0.2
    assert aside(seen.view, house.rig) < 2.0


def test_edges_measured_with_another_share_are_moved_to_where_they_lie(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    house = before()
    edges = EdgeTracker(SIZE, house.evidence.palette, house.edge)
    monkeypatch.setattr(EdgeTracker, "_learn_light", lambda *_: 0.0)
    ahead = View(house.view.vector - np.array([(MIDDLE - BEFORE) / HEIGHT, 0.0, 0.0, 0.0]))
    (seen,) = edges.settle([Frame(1, 0.04, exposed(2.2))], [ahead], house.rig, house.view)
    assert abs(seen.share) < 0.1 and seen.smeared > LEAST_SMEAR
    shares = []
    for _ in range(2):
        assert seen.by_light is not None
        more = more_light(seen.marks.get(), seen.view, house.rig, SIZE, seen.by_light)
        assert more is not None
        shares.append(more[0])
        edges.light = ShutterLight(seen.share + more[0], more[1])
        seen = edges.relit(seen)
        assert seen.share == edges.light.share
    assert shares[0] == pytest.approx(1.0, abs=0.3)
    assert shares[1] == pytest.approx(0.0, abs=0.1)


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
