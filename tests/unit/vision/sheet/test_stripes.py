from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import HOUSE
from curlshot.vision.optics.paint import CENTRE_LINE, TEE_LINE
from curlshot.vision.optics.pose import aim
from curlshot.vision.optics.rig import OVERHEAD, start_rig
from curlshot.vision.sheet.normals import SAMPLES, Normals, lay_out
from curlshot.vision.sheet.stations import BLOCK
from curlshot.vision.sheet.stripes import Blocks, find_stripes

SIZE = (1280, 720)
POSITION = (0.0, 0.0, 8.5)
REACH = 9.0
STEP = 2 * REACH / (SAMPLES - 1)


def laid_out() -> Normals:
    view, rig = aim((640.0, 360.0), 130.0, POSITION, SIZE), start_rig(OVERHEAD, POSITION)
    return lay_out(view.vector, rig, SIZE, reach=REACH, most=90)


def ice(rng: np.random.Generator, count: int) -> np.ndarray:
    """Colours of noisy ice along normals, a little lighter on one side."""
    level = 215.0 + np.linspace(-3, 3, SAMPLES)[:, None]
    return (level + rng.normal(0, 2, (3, SAMPLES, count))).astype(np.float32)


def line(normals: Normals, kind: int, depth: float, places: tuple[float, ...]) -> np.ndarray:
    """A line's share of the colours: darker by `depth` where it is, px off the middle."""
    x = np.linspace(-REACH, REACH, SAMPLES)[:, None]
    found = np.zeros((SAMPLES, len(normals.along)), np.float32)
    for place in places:
        off = place + 0.3 * normals.along[normals.kinds[kind]]
        found[:, normals.kinds[kind]] -= depth * np.exp(-0.5 * ((x - off) / 1.2) ** 2)
    return found


def stripes(profile: np.ndarray, normals: Normals) -> tuple[Blocks, np.ndarray, np.ndarray]:
    """Blocks, and what is found in profiles along all normals."""
    blocks = Blocks.of(normals)
    within = np.ones(len(blocks.along), bool)
    return blocks, *find_stripes(profile[..., normals.wide :], blocks, within)


@pytest.mark.parametrize("depth", [6.0, 40.0, 180.0, -6.0])
def test_a_line_is_found_where_it_is(depth: float) -> None:
    normals, rng = laid_out(), np.random.default_rng(1)
    profile = ice(rng, len(normals.along)) + line(normals, CENTRE_LINE, depth, (1.5,))
    blocks, offset, good = stripes(profile, normals)
    part = blocks.kinds[CENTRE_LINE]
    assert good[part].mean() > 0.7
    off = offset[part] - (1.5 + 0.3 * blocks.along[part])
    assert np.median(np.abs(off[good[part]])) < 0.35
    assert not good[blocks.kinds[TEE_LINE]].any()


def test_a_line_that_ends_at_the_house_is_found_beyond_it() -> None:
    normals, rng = laid_out(), np.random.default_rng(5)
    profile = ice(rng, len(normals.along))
    painted = line(normals, CENTRE_LINE, 60.0, (1.5,))
    painted[:, np.abs(normals.along) < HOUSE.twelve_foot] = 0
    blocks, offset, good = stripes(profile + painted, normals)
    part = blocks.kinds[CENTRE_LINE]
    beyond = (
        np.abs(normals.along[normals.kinds[CENTRE_LINE]].reshape(-1, BLOCK)) > HOUSE.twelve_foot
    )
    shown, bare = beyond.all(1), ~beyond.any(1)
    assert min(shown.sum(), bare.sum()) >= 4
    assert good[part][shown].mean() > 0.7
    assert good[part][bare].mean() < 0.2
    off = offset[part] - (1.5 + 0.3 * blocks.along[part])
    assert np.median(np.abs(off[good[part] & shown])) < 0.35


def test_two_stripes_are_one_line_between_them() -> None:
    normals, rng = laid_out(), np.random.default_rng(2)
    profile = ice(rng, len(normals.along)) + line(normals, TEE_LINE, 30.0, (-1.4, 2.4))
    blocks, offset, good = stripes(profile, normals)
    part = blocks.kinds[TEE_LINE]
    off = offset[part] - (0.5 + 0.3 * blocks.along[part])
    assert good[part].mean() > 0.7
    assert abs(np.median(off[good[part]])) < 0.6


def test_bare_ice_and_edges_of_paint_are_no_lines() -> None:
    normals, rng = laid_out(), np.random.default_rng(3)
    bare = ice(rng, len(normals.along))
    assert not stripes(bare, normals)[2].any()
    paint = bare.copy()
    paint[:, SAMPLES // 2 :] -= 90
    assert not stripes(paint, normals)[2].any()


def test_without_lines_in_view_there_is_nothing() -> None:
    view, rig = aim((640.0, 360.0), 130.0, POSITION, SIZE), start_rig(OVERHEAD, POSITION)
    circles = lay_out(view.vector, rig, SIZE, reach=REACH, lines=False)
    blocks, _, good = stripes(ice(np.random.default_rng(4), len(circles.along)), circles)
    assert not blocks.kinds
    assert len(good) == 0


@pytest.mark.parametrize("aside", [-3.5, 3.0])
def test_a_line_far_from_the_middle_is_not_drawn_outwards(aside: float) -> None:
    normals, rng = laid_out(), np.random.default_rng(3)
    x = np.linspace(-REACH, REACH, SAMPLES)[:, None]
    profile = ice(rng, len(normals.along))
    dark = 40.0 * np.exp(-0.5 * ((x - aside) / 1.2) ** 2)
    profile[..., normals.kinds[TEE_LINE]] -= dark.astype(np.float32)
    blocks, offset, good = stripes(profile, normals)
    part = blocks.kinds[TEE_LINE]
    assert good[part].mean() > 0.7
    assert abs(np.median(offset[part][good[part]]) - aside) < 0.15
