from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.tests.helpers.vision.handles import RADII, RAYS, patch
from curlshot.vision.spin.bearing import bearing
from curlshot.vision.spin.handle import cap_spectrum


def told(picture: NDArray[np.uint8]) -> float | None:
    return bearing(cap_spectrum(picture, RADII))


def between(one: float, other: float) -> float:
    return abs((one - other + np.pi) % (2 * np.pi) - np.pi)


@pytest.mark.parametrize("turn", [-3.0, -1.6, -0.2, 0.0, 0.7, 1.5708, 3.1])
def test_a_handle_points_where_its_longer_end_does(turn: float) -> None:
    found = told(patch(turn))
    assert found is not None
    assert between(found, turn) < 0.02
    assert abs(found) <= np.pi


def test_a_dark_handle_is_one_as_well() -> None:
    found = told(255 - patch(0.7))
    assert found is not None
    assert between(found, 0.7) < 0.02


def test_light_from_one_side_does_not_turn_a_handle() -> None:
    side = 25 * np.cos(np.arange(RAYS) * (2 * np.pi / RAYS) - 2.0)
    found = told(np.clip(patch(0.7) + side[:, None, None], 0, 255).astype(np.uint8))
    assert found is not None
    assert between(found, 0.7) < 0.03


def test_a_cap_without_a_bar_points_nowhere() -> None:
    rng = np.random.default_rng(4)
    noise = rng.normal(120, 6, (RAYS, len(RADII), 3)).astype(np.uint8)
    assert told(noise) is None
    assert told(np.full_like(noise, 120)) is None


def test_a_mirrored_lamp_is_no_handle() -> None:
    direction = np.arange(RAYS)[:, None, None] * (2 * np.pi / RAYS)
    lamp = 100 * np.exp(20 * (np.cos(direction - 2.0) - 1)) * np.ones((1, len(RADII), 3))
    rng = np.random.default_rng(5)
    plain = 100 + rng.normal(0, 4, lamp.shape)
    assert told((plain + lamp).astype(np.uint8)) is None
    beside = np.clip(patch(0.7, rng) + 0.5 * lamp, 0, 255).astype(np.uint8)
    found = told(beside)
    assert found is None or abs(np.sin(found - 0.7)) < 0.1


def test_spokes_alike_all_round_point_nowhere() -> None:
    """As some discs on air tables have."""
    angle = np.arange(RAYS)[:, None, None] * (2 * np.pi / RAYS)
    spokes = 120 + 60 * (np.cos(4 * angle) > 0.7) * np.ones((1, len(RADII), 3))
    assert told(spokes.astype(np.uint8)) is None
