from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from curlshot.vision.optics.paint import FIXED, FOUR, TWELVE
from curlshot.vision.sheet.edges import crossings
from curlshot.vision.sheet.normals import SAMPLES
from curlshot.vision.sheet.outlined import ALIKE, outlines, summed

ICE, LINE = np.array([225.0, 220.0, 215.0]), np.array([150.0, 60.0, 30.0])
KINDS = {TWELVE: slice(0, 40), FOUR: slice(40, 60)}
COUNT = 60


def drawn(
    place: np.ndarray, width: float = 2.0, line: np.ndarray = LINE, behind: np.ndarray = ICE
) -> np.ndarray:
    """Colours (3, SAMPLES, n) across lines, their middles at these samples, blurred by one."""
    x = np.arange(SAMPLES)[:, None] - place
    before, beyond = ndtr(-x - width / 2), ndtr(x - width / 2)
    share = 1 - before - beyond
    colours = ICE[:, None, None] * before + line[:, None, None] * share
    return (colours + behind[:, None, None] * beyond).astype(np.float32)


def seen(profile: np.ndarray) -> tuple[list[slice], np.ndarray, np.ndarray, np.ndarray]:
    value, good = np.zeros((SAMPLES, COUNT), np.float32), np.zeros(COUNT, bool)
    palette = np.full((FIXED, 2, 3), np.nan)
    return outlines(profile, KINDS, value, good, palette), value, good, palette


@pytest.mark.parametrize("width", [0.5, 2.0, 4.0])
def test_the_middle_of_an_outline_is_its_edge(width: float) -> None:
    rng = np.random.default_rng(1)
    place = rng.uniform(9.5, 14.5, COUNT)
    noisy = drawn(place, width) + rng.normal(0, 2, (3, SAMPLES, COUNT)).astype(np.float32)
    found, value, good, palette = seen(noisy)
    assert found == list(KINDS.values()) and good.all()
    sample, _, crossed = crossings(summed(value))
    assert crossed.all()
    np.testing.assert_allclose(sample, place, atol=0.35 if width < 1 else 0.15)
    np.testing.assert_allclose(palette[TWELVE], [ICE, ICE], atol=3.0)


def test_the_edge_of_paint_and_bare_ice_are_no_outlines() -> None:
    rng = np.random.default_rng(2)
    place = rng.uniform(9.5, 14.5, COUNT)
    edge = drawn(place, 0.0, behind=LINE)
    ice = np.broadcast_to(ICE[:, None, None], edge.shape)
    for colours in (edge, ice + rng.normal(0, 4, edge.shape)):
        found, _, good, palette = seen(colours.astype(np.float32))
        assert not found and not good.any() and np.isnan(palette).all()


def test_where_paint_is_known_none_is_looked_for() -> None:
    value, good = np.zeros((SAMPLES, COUNT), np.float32), np.zeros(COUNT, bool)
    palette = np.full((FIXED, 2, 3), np.nan)
    palette[[TWELVE, FOUR]] = [ICE, ICE - ALIKE]
    assert not outlines(drawn(np.full(COUNT, 12.0)), KINDS, value, good, palette)


def test_what_covers_an_outline_is_none() -> None:
    colours = drawn(np.full(COUNT, 12.0))
    colours[..., ::5] = 60.0  # clothes
    colours[:, 12:, 1::5] = LINE[:, None, None]  # a stone beside it
    _, _, good, _ = seen(colours)
    assert not good[::5].any() and not good[1::5].any()
    assert good.reshape(-1, 5)[:, 2:].all()
