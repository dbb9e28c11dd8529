from collections.abc import Sequence

import numpy as np
import pytest

from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.roundness import PIXELS, SHARE, SMALL, USUAL, edge_errors

WAVES = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])
CAP, LARGE = 0.1, 1e6


def bent(
    bend: float,
    visible: float = 1.0,
    pixel: float = 0.0,
    light: tuple[float, float] = (np.nan, np.nan),
) -> Detection:
    return detection((0.0, 1.0))._replace(
        bends=tuple(bend * WAVES), visible=visible, pixel_size=pixel, light=light
    )


def edge_error(stones: Sequence[Sequence[Detection]], radius: float = CAP) -> float:
    """Give the one error of stones that differ in nothing."""
    errors = edge_errors(stones, radius)
    assert errors.shape == (len(stones), 2)
    np.testing.assert_array_equal(errors, errors[0, 0])
    return float(errors[0, 0])


def test_the_more_the_edges_are_bent_the_larger_the_error() -> None:
    errors = [edge_error([[bent(b)] * 9] * 6) for b in (0.0, 0.5 * USUAL, USUAL, 2 * USUAL)]
    assert (np.diff(errors) > 0).all()
    assert errors[2] == pytest.approx(SHARE * USUAL)


def test_what_pixels_bend_moves_the_middle_no_further() -> None:
    rng, pixel = np.random.default_rng(5), 0.01
    waves = rng.normal(0, PIXELS * pixel, (200, 6))
    for share in (0.3, 0.6, 0.9):
        seen = [[bent(0, pixel=pixel)._replace(bends=tuple(w))] for w in (share * waves).tolist()]
        assert edge_error(seen, LARGE) == pytest.approx(share * PIXELS * pixel, rel=0.05)
    # Of rendered stones, which are round, none shows waves larger than a tenth of a pixel.
    small, large = (
        edge_error([[bent(w * pixel, pixel=pixel)] * 9] * 20, LARGE) for w in (0.08, 0.16)
    )
    assert small < 2 * 0.08 * pixel and large > 3 * 0.16 * pixel
    shaped = edge_error([[bent(0.006, pixel=pixel)] * 9] * 20, LARGE)
    assert shaped == pytest.approx(SHARE * 0.006, rel=0.03)


def test_of_a_few_pixels_the_middle_is_off_by_more_than_their_waves_say() -> None:
    round_ones = [[bent(0.0, pixel=pixel)] * 9 for pixel in (0.0, 0.004, 0.016)]
    by_waves, fine, coarse = edge_errors(round_ones, CAP) ** 2
    fine, coarse = fine - by_waves, coarse - by_waves
    np.testing.assert_allclose(np.sqrt(coarse), SMALL * 0.016**3 / CAP**2, rtol=1e-6)
    np.testing.assert_allclose(coarse / fine, 4.0**6, rtol=1e-6)


def test_edges_by_hue_and_by_lightness_that_differ_say_so_on_their_axis() -> None:
    apart = bent(0.001, light=(-0.001, 0.0))
    alike, differs, beyond, unseen = edge_errors(
        [
            [bent(0.001, light=(0.0, 0.0))] * 9,
            [*[apart] * 8, bent(0.001, light=(0.02, 0.02)), bent(0.001)],
            [bent(0.001, light=(0.0, 0.02))] * 9,
            [bent(0.001)] * 9,
        ],
        CAP,
    )
    np.testing.assert_array_equal(alike, unseen)
    added = np.sqrt(np.array([differs, beyond]) ** 2 - alike**2)
    np.testing.assert_allclose(added, 0.3 * np.array([[0.001, 0], [0, 0.0012]]), atol=1e-9)


def test_stones_count_alike_and_a_bad_moment_does_not() -> None:
    calm = [bent(0.001)] * 9
    assert edge_error([calm * 20, [bent(0.003)]]) == edge_error([calm, [bent(0.003)]])
    assert edge_error([[*calm, bent(0.02)]]) == edge_error([calm])


def test_what_changes_from_picture_to_picture_is_no_bend() -> None:
    noise = [bent(0.003 * sign) for sign in (-1, 1) * 20]
    assert edge_error([noise]) == edge_error([[bent(0.0)]])


def test_stones_half_hidden_say_nothing() -> None:
    assert edge_error([[bent(0.02, visible=0.5)]]) == pytest.approx(SHARE * USUAL)
    hidden, shown = edge_errors([[bent(0.02, visible=0.5)], [bent(0.0)]], CAP)
    np.testing.assert_array_equal(hidden, shown)
    assert edge_errors([], CAP).shape == (0, 2)
