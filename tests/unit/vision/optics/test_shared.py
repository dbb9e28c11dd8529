from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import legendre

from curlshot.vision.optics.paint import CIRCLES, FIXED, LEFT, TWELVE, Marks
from curlshot.vision.optics.rig import POSITION, RIG_SIZE
from curlshot.vision.optics.shared import ARC, Bundle, family, piece_of, polynomials, sensitivity


def marks(line: int, along: np.ndarray) -> Marks:
    none = np.zeros((len(along), 2))
    return Marks(np.full(len(along), line), along, none, none, np.ones(len(along)))


def bundle(travel: np.ndarray, cov: np.ndarray, pieces: np.ndarray, offset: np.ndarray) -> Bundle:
    return Bundle(np.zeros(RIG_SIZE), travel, (1.0, 5.0), pieces, offset, cov, np.ones(3))


def test_pieces_of_one_arc_are_one_on_each_circle_its_own() -> None:
    along = np.array([0.1, 0.9, 1.1]) * ARC
    pieces = [piece_of(marks(line, along)) for line in range(CIRCLES)]
    for piece in pieces:
        assert piece[0] == piece[1] != piece[2]
    assert len(np.unique(pieces)) == 2 * CIRCLES
    assert family(np.array([TWELVE, LEFT, FIXED])).tolist() == [0, 1, 2]


def test_paint_that_was_not_seen_has_no_offset() -> None:
    along = np.array([0.5, 1.5, 2.5]) * ARC
    seen = piece_of(marks(TWELVE, along[:2]))
    shared = bundle(np.zeros((0, 3)), np.eye(RIG_SIZE + 2), seen, np.array([0.002, -0.001]))
    offset, place = shared.offsets(marks(TWELVE, along))
    np.testing.assert_array_equal(offset, [0.002, -0.001, 0.0])
    np.testing.assert_array_equal(place, [0, 1, -1])


@pytest.mark.parametrize("degree", [0, 3])
def test_the_errors_of_a_camera_s_motion_are_those_of_its_place_at_the_time(degree: int) -> None:
    rng = np.random.default_rng(1)
    count = RIG_SIZE + 3 * degree + 2
    root = rng.normal(0, 1, (count, count))
    shared = bundle(np.zeros((degree, 3)), root @ root.T, np.arange(2), np.zeros(2))
    times = np.array([1.5, 4.0])
    stated = shared.covariances(np.tile(np.eye(RIG_SIZE + 2), (2, 1, 1)), times)
    draws = (root @ rng.normal(0, 1, (count, 40000))).T
    travel = draws[:, RIG_SIZE : RIG_SIZE + 3 * degree].reshape(len(draws), degree, 3)
    still = np.concatenate([draws[:, :RIG_SIZE], draws[:, RIG_SIZE + 3 * degree :]], axis=1)
    for at, basis in zip(stated, polynomials(times, (1.0, 5.0), degree), strict=True):
        here = still.copy()
        here[:, POSITION] += np.einsum("d,ndk->nk", basis, travel)
        scale = np.sqrt(np.outer(at.diagonal(), at.diagonal()))
        np.testing.assert_allclose(np.cov(here.T) / scale, at / scale, atol=0.03)


def test_a_view_follows_what_is_held_as_its_normal_equations_say() -> None:
    rng = np.random.default_rng(2)
    by_view, by_rig = rng.normal(0, 1, (4, 50)), rng.normal(0, 1, (RIG_SIZE, 50))
    by_offset, piece = rng.normal(0, 1, 50), rng.integers(-1, 3, 50)
    cov = np.linalg.inv(by_view @ by_view.T)
    follows = sensitivity(by_view, by_rig, by_offset, cov, piece, RIG_SIZE + 3)
    change = rng.normal(0, 1, RIG_SIZE + 3)
    moved = change[:RIG_SIZE] @ by_rig
    moved += np.where(piece >= 0, by_offset * np.append(change[RIG_SIZE:], 0.0)[piece], 0.0)
    best = np.linalg.lstsq(by_view.T, -moved, rcond=None)[0]
    np.testing.assert_allclose(follows @ change, best, atol=1e-9)


def test_polynomials_are_those_of_legendre() -> None:
    x = np.linspace(-1, 1, 7)
    told = polynomials(3 + 2 * x, (1.0, 5.0), 4)
    assert np.allclose(told, legendre.legvander(x, 4)[:, 1:])
    assert polynomials(x, (0.0, 1.0), 0).shape == (7, 0)
