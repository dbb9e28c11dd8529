from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.rings import W, drawn
from curlshot.vision.sheet.rings import guesses


@pytest.mark.parametrize("squash", [1.0, 0.78, 0.5])
@pytest.mark.parametrize(
    ("centre", "twelve"), [((160, 90), 60), ((150, 172), 75), ((165, 200), 80)]
)
def test_the_rings_are_the_first_guess(
    centre: tuple[float, float], twelve: float, squash: float
) -> None:
    best = guesses(drawn(centre, twelve, squash))[0]
    np.testing.assert_allclose(best.centre, centre, atol=4)
    assert best.scale * 1.829 == pytest.approx(twelve, rel=0.06)
    assert best.foreshortening == pytest.approx(squash, abs=0.11)


@pytest.mark.parametrize(
    ("squash", "lean"), [(0.55, -20.0), (0.55, 20.0), (0.55, -40.0), (0.46, 28.0), (0.42, 12.0)]
)
def test_rings_that_lean_are_found(squash: float, lean: float) -> None:
    best = guesses(drawn((160, 90), 70, squash, lean))[0]
    assert best.foreshortening == pytest.approx(squash, abs=0.06)
    np.testing.assert_allclose(best.centre, (160, 90), atol=4)
    # OpenCV turns an ellipse clockwise in the picture, its short axis too.
    assert best.lean == pytest.approx(-np.radians(lean), abs=0.2)


@pytest.mark.parametrize("squash", [1.0, 0.6])
def test_rings_are_found_in_upright_pictures(squash: float) -> None:
    upright = np.random.default_rng(2).integers(0, 256, (569, W, 3), np.uint8)
    upright[200:380] = drawn((160, 90), 80, squash)
    best = guesses(upright)[0]
    np.testing.assert_allclose(best.centre, (160, 290), atol=4)
    assert best.foreshortening == pytest.approx(squash, abs=0.11)
