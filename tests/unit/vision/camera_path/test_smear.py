from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.camera_path.smear import (
    LEAST,
    MOST,
    SHARP,
    Shutter,
    exposure,
    reach_beyond,
    smear,
)

MOTION = np.linspace(-60, 60, 49)


def slopes(share: float) -> np.ndarray:
    """Slopes of edges in pictures exposed for this share of the time between them."""
    return np.asarray(1 / np.hypot(SHARP, share * MOTION))


@pytest.mark.parametrize("share", [0.15, 0.5, 0.9])
def test_the_exposure_is_told_by_how_far_edges_are_smeared(share: float) -> None:
    rng = np.random.default_rng(0)
    slope = slopes(share) * rng.normal(1, 0.05, len(MOTION))
    slope[::6] = np.nan
    slope[::7] = 0.4  # print, or a stone
    assert exposure(slope, MOTION) == pytest.approx(share, rel=0.1)


def test_it_lies_between_none_and_the_whole_time() -> None:
    assert exposure(np.full(len(MOTION), 1 / SHARP), MOTION) == LEAST
    assert exposure(np.full(len(MOTION), 1e-3), MOTION) == MOST


def test_a_camera_at_rest_does_not_tell_it() -> None:
    assert exposure(slopes(0.5), 0.1 * MOTION) is None
    assert exposure(np.full(len(MOTION), np.nan), MOTION) is None


def test_what_is_known_of_the_exposure_follows_the_pictures() -> None:
    shutter = Shutter()
    for _ in range(8):
        shutter.learn(slopes(0.2), MOTION)
    assert shutter.exposure == pytest.approx(0.2, abs=0.01)
    shutter.learn(slopes(0.9), 0.1 * MOTION)  # a camera at rest
    assert shutter.exposure == pytest.approx(0.2, abs=0.01)


def test_the_smear_is_that_of_edges_across_the_motion() -> None:
    around = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    slope = 1 / np.hypot(SHARP, 30 * np.cos(around))
    slope[::6] = np.nan
    assert smear(slope) == pytest.approx(30, rel=0.05)
    assert smear(np.full(48, np.nan)) == 0.0


def test_normals_reach_beyond_a_blur_but_not_across_the_picture() -> None:
    assert reach_beyond(0.0, 1280) == reach_beyond(3.0, 1280) < 10
    assert reach_beyond(0.0, 320) == 6.0
    assert reach_beyond(30.0, 1280) > 30
    assert reach_beyond(500.0, 1280) < 60
