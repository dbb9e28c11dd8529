from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.data.sheet import STONE
from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.detection.rays import Rays, directions
from curlshot.vision.detection.smeared import BY_EDGES_OFF, _covered, middles, swept_share, widened

Array = NDArray[np.float64]
RAYS = Rays(
    np.zeros((1, 48, 44, 3), np.uint8), np.zeros((1, 48, 44, 3), np.uint8),
    np.ones((1, 48, 44), bool), np.linspace(0.029, 0.154, 44), directions(48)[0],
)  # fmt: skip


def exposed(middle: Array, way: Array, beyond: float) -> NDArray[np.float32]:
    """Signal on rays about (0, 0) of a stone that goes a way over what signals `beyond`."""
    points = RAYS.radius[:, None] * directions(48)[1][:, None]
    mean = np.zeros(points.shape[:2])
    for share in np.linspace(-0.5, 0.5, 201):
        away = np.hypot(*(points - middle - share * way).transpose(2, 0, 1))
        there = np.where(points[..., 0] > 0, beyond, -0.5)
        mean += np.select([away < STONE.cap_radius, away < STONE.radius], [0.5, -0.5], there) / 201
    return mean[None].astype(np.float32)


@pytest.mark.parametrize("exposure", [0.3, 0.5, 0.95])
@pytest.mark.parametrize("heading", [0.0, 1.9, -2.6])
def test_a_smeared_cap_is_found_whatever_it_passes_over(exposure: float, heading: float) -> None:
    drift = 0.12 * np.array([np.cos(heading), np.sin(heading)])
    for beyond in (-0.5, 0.8):
        truth = np.array([0.006, -0.004])
        seen = exposed(truth, exposure * drift, beyond)
        ok, middle, off = middles(seen, RAYS, STONE, np.zeros((1, 2)), drift[None])
        assert ok.all()
        assert np.hypot(*(middle[0] - truth)) < 0.0012
        assert 0.0002 < np.hypot(*off[0]) < 0.004


def test_what_is_far_from_its_place_or_hardly_in_view_tells_no_middle() -> None:
    drift = np.array([0.12, 0.0])
    far = exposed(np.array([0.055, 0.0]), 0.5 * drift, -0.5)
    hardly = replace(RAYS, inside=RAYS.inside & (np.arange(48) < 4)[:, None])
    near = exposed(np.array([0.006, -0.004]), 0.5 * drift, -0.5)
    for seen, rays in ((far, RAYS), (near, hardly)):
        ok, middle, off = middles(seen, rays, STONE, np.array([[0.001, 0.002]]), drift[None])
        assert not ok.any() and not off.any()
        np.testing.assert_array_equal(middle, [[0.001, 0.002]])


def test_what_is_covered_changes_as_it_is_said_to() -> None:
    rng = np.random.default_rng(4)
    a, b = rng.uniform(-0.14, 0.14, (2, 400))
    b = b[np.abs(b) < 0.09]
    a, way, step = a[: len(b)], np.full(len(b), 0.06), 1e-6
    _, change = _covered(a, b, way, STONE.cap_radius)
    moved = [(a - step, b, way), (a, b - step, way), (a, b, way + step)]
    for by, ahead in zip(change, moved, strict=True):
        share = _covered(*ahead, STONE.cap_radius)[0] - _covered(a, b, way, STONE.cap_radius)[0]
        # Where a border is passed within the step the two differ.
        assert np.mean(np.abs(by - share / step) < 1e-2) > 0.98


def test_slow_stones_are_left_to_their_edges_and_fast_ones_are_not() -> None:
    share = swept_share(np.array([[0.0, 0.0], [0.03, 0.02], [0.0, -0.07], [0.09, 0.05]]))
    assert share[:2].tolist() == [0, 0] and 0.2 < share[2] < 0.8 and share[3] == 1


def test_smeared_edges_say_less_of_where_a_fast_stone_is_along_its_way() -> None:
    times = [0.04 * k for k in range(6)]
    seen = [detection((0.0, 0.1 * k))._replace(light=(0.001, 0.0), swept=k == 3) for k in range(6)]
    out = widened(times, seen)
    for k in range(6):
        extra = 0.0 if k == 3 else 0.1 * BY_EDGES_OFF
        assert out[k].sd_y == pytest.approx(np.hypot(seen[k].sd_y, extra))
        assert out[k].sd_x == pytest.approx(seen[k].sd_x)
        assert np.isnan(out[k].light[0]) == (k != 3)
    rests = [detection((0.0, 0.001 * k)) for k in range(6)]
    assert widened(times, rests) == rests
    assert widened(times[:1], seen[:1]) == seen[:1]
