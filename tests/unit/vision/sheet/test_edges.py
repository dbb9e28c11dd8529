from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.optics.paint import EIGHT, FIXED, FOUR, TWELVE
from curlshot.vision.optics.pose import aim
from curlshot.vision.optics.rig import OVERHEAD, start_rig
from curlshot.vision.sheet.edges import MIN_CONTRAST, crossings, steps
from curlshot.vision.sheet.normals import SAMPLES, Normals, lay_out

POSITION = (0.0, 0.0, 8.5)
UNKNOWN = np.full((FIXED, 2, 3), np.nan)
ICE, PAINT = np.array([225.0, 220.0, 215.0]), np.array([40.0, 60.0, 190.0])


def circles() -> Normals:
    view, rig = aim((640.0, 360.0), 130.0, POSITION, (1280, 720)), start_rig(OVERHEAD, POSITION)
    return lay_out(view.vector, rig, (1280, 720), reach=9.0, most=40, lines=False)


def profiles(place: np.ndarray, ice: np.ndarray = ICE, paint: np.ndarray = PAINT) -> np.ndarray:
    """Colours (3, SAMPLES, n) that go over from ice to paint at these samples, shape (n,)."""
    share = 1 / (1 + np.exp(-(np.arange(SAMPLES)[:, None] - place) / 0.8))
    mixed = ice[:, None, None] * (1 - share) + paint[:, None, None] * share
    return mixed.astype(np.float32)


def test_an_edge_lies_half_way_between_its_two_colours() -> None:
    normals = circles()
    place = np.random.default_rng(0).uniform(9, 15, len(normals.line))
    value, good, palette = steps(profiles(place), normals, UNKNOWN)
    sample, rise, crossed = crossings(value)
    assert good.all() and crossed.all()
    np.testing.assert_allclose(sample, place, atol=0.06)
    np.testing.assert_allclose(rise, 0.25 / 0.8, rtol=0.15)  # of a logistic curve, half way
    for kind in (TWELVE, EIGHT, FOUR):
        np.testing.assert_allclose(palette[kind], [ICE, PAINT], atol=2.0)
    assert np.isnan(palette[FOUR + 1 :]).all()


def test_what_has_other_colours_is_no_edge_of_the_circle() -> None:
    normals = circles()
    place = np.full(len(normals.line), 12.3)
    known = UNKNOWN.copy()
    known[:] = [ICE, PAINT]
    colours = profiles(place)
    colours[:, :, ::4] = profiles(place[::4], paint=np.array([190.0, 190.0, 40.0]))
    _, good, _ = steps(colours, normals, known)
    assert not good[::4].any()
    assert good.sum() == len(place) - len(place[::4])


def test_light_may_fall_off_where_paint_is_pale_but_no_shadow_is_paint() -> None:
    normals = circles()
    place = np.full(len(normals.line), 12.3)
    pale = ICE - [5.0, 25.0, 45.0]
    known = UNKNOWN.copy()
    known[:] = [ICE, pale]
    light = np.linspace(0.8, 1.1, len(place))
    assert steps((light * profiles(place, paint=pale)).astype(np.float32), normals, known)[1].all()
    shadow = profiles(place, ice=ICE, paint=0.8 * ICE)
    assert not steps(shadow, normals, known)[1].any()
    light[::3] = 0.5
    dim = steps((light * profiles(place, paint=pale)).astype(np.float32), normals, known)[1]
    assert not dim[::3].any() and dim[1::3].all() and dim[2::3].all()


@pytest.mark.parametrize("light", [0.25, 0.6, 1.4])
def test_a_whole_picture_may_fade(light: float) -> None:
    normals = circles()
    place = np.full(len(normals.line), 12.3)
    known = UNKNOWN.copy()
    known[:] = [ICE, PAINT]
    both = np.stack([light * profiles(place), profiles(place)]).astype(np.float32)
    value, good, palette = steps(both, normals, known)
    assert good.all()
    np.testing.assert_allclose(value[0], value[1], atol=1e-3)
    np.testing.assert_allclose(palette[0, TWELVE], light * palette[1, TWELVE], rtol=1e-4)
    colours = light * profiles(place, ice=PAINT, paint=ICE)
    assert not steps(colours.astype(np.float32), normals, known)[1].any()


def test_a_faint_step_is_no_edge() -> None:
    normals = circles()
    faint = profiles(np.full(len(normals.line), 12.0), paint=ICE - MIN_CONTRAST / 2)
    assert not steps(faint, normals, UNKNOWN)[1].any()
    assert not crossings(np.full((SAMPLES, 3), 0.4, np.float32))[2].any()


def test_of_several_crossings_the_steepest_counts() -> None:
    value = np.repeat(np.linspace(-0.5, 0.5, SAMPLES, dtype=np.float32)[:, None], 2, axis=1)
    value[4:6, 0] += [0.3, 0.45]
    value[18:, 1] -= 0.6
    value[20:, 1] += 0.9
    sample, _, good = crossings(value)
    assert good.all()
    assert 3 < sample[0] < 6
    assert 19 <= sample[1] <= 20
