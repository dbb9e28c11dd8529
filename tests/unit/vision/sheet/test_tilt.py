from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.sheet.tilt import FOCAL, Rounding, Tilt, rounded

SIZE = (320, 180)
ANGLE = np.linspace(0, 2 * np.pi, 200, endpoint=False)
CIRCLE = np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=-1)


def pinhole(ice: np.ndarray, tilt: float) -> np.ndarray:
    """Picture, px, of places on ice, in px at its middle, that falls away upwards by a tilt."""
    focal = FOCAL * SIZE[0]
    x, y = ice.T
    depth = focal - y * np.sin(tilt)
    seen = focal * np.stack([x, y * np.cos(tilt)], -1) / depth[:, None]
    return np.asarray(seen + (np.array(SIZE) - 1) / 2)


@pytest.mark.parametrize("tilt", [0.0, 0.6, 1.0])
def test_a_tilted_circle_is_round_from_above(tilt: float) -> None:
    circle = np.array([20.0, -10.0]) + 60 * CIRCLE
    seen = pinhole(circle, tilt)
    level = Tilt.of(float(np.cos(tilt)), 0.0, SIZE)
    np.testing.assert_allclose(level.level(seen), circle, atol=1e-9)
    np.testing.assert_allclose(level.pictured(circle), seen, atol=1e-9)


def test_gradients_of_a_circle_point_from_its_centre() -> None:
    level = Tilt.of(0.6, 0.4, SIZE)
    circle = np.array([15.0, 25.0]) + 50 * CIRCLE
    seen = level.pictured(circle)
    along = np.roll(seen, -1, 0) - np.roll(seen, 1, 0)
    across = np.stack([along[:, 1], -along[:, 0]], -1)
    points, gradients = level.level_edges(seen, across)
    np.testing.assert_allclose(points, circle, atol=1e-9)
    np.testing.assert_allclose(gradients, CIRCLE, atol=2e-3)


@pytest.mark.parametrize("part", [slice(None), slice(20, 110)], ids=["whole", "part"])
def test_rings_are_made_round(part: slice) -> None:
    # Two rings, squashed by 8 % and turned, among edges of other things.
    bend = np.array([[1.03, 0.02], [0.02, 0.95]])
    rings = np.concatenate([radius * CIRCLE[part] for radius in (60.0, 40.0)])
    way = np.concatenate([CIRCLE[part]] * 2) @ np.linalg.inv(bend)
    way /= np.hypot(*way.T)[:, None]
    other = np.random.default_rng(3).uniform(-70, 70, (60, 2))
    points = np.concatenate([rings @ bend.T + [2.0, -1.0], other])
    gradients = np.concatenate([way, np.tile([1.0, 0.0], (60, 1))])
    level = Tilt.of(1.0, 0.0, SIZE)
    found = rounded(points, gradients, Rounding(level, np.zeros(2)), np.array([60.0, 40.0]))
    round_, facing = found.of_edges(points, gradients)
    count = len(rings)
    np.testing.assert_allclose(np.hypot(*round_[:count].T), np.hypot(*rings.T), atol=0.7)
    assert ((round_[:count] * facing[:count]).sum(1) > 0.999 * np.hypot(*round_[:count].T)).all()


def test_edges_that_do_not_face_the_centre_do_not_make_rings_rounder() -> None:
    ring, beside = 60 * CIRCLE, np.repeat(63 * CIRCLE[:60], 6, axis=0)
    along = np.stack([-beside[:, 1], beside[:, 0]], -1) / 63
    points, gradients = np.concatenate([ring, beside]), np.concatenate([CIRCLE, along])
    level = Tilt.of(1.0, 0.0, SIZE)
    found = rounded(points, gradients, Rounding(level, np.zeros(2)), np.array([60.0]))
    off, _ = found.of_edges(ring, CIRCLE)
    np.testing.assert_allclose(np.hypot(*off.T), 60, atol=0.2)


def test_rings_without_edges_stay_as_they_are() -> None:
    seen = Rounding(Tilt.of(0.8, 0.0, SIZE), np.array([3.0, 4.0]))
    assert rounded(5 * CIRCLE, CIRCLE, seen, np.array([60.0, 40.0])) is seen
