import numpy as np
import pytest

from tests.vision.test_follow import sighting
from vision.roundness import PIXELS, SHARE, USUAL, edge_error
from vision.sighting import Sighting

WAVES = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])


def bent(bend: float, visible: float = 1.0, pixel: float = 0.0) -> Sighting:
    return sighting((0.0, 1.0))._replace(
        bends=tuple(bend * WAVES), visible=visible, pixel_size=pixel
    )


def test_the_more_the_edges_are_bent_the_larger_the_error() -> None:
    errors = [edge_error([[bent(b)] * 9] * 6) for b in (0.0, 0.5 * USUAL, USUAL, 2 * USUAL)]
    assert (np.diff(errors) > 0).all()
    assert errors[2] == pytest.approx(SHARE * USUAL)


def test_what_pixels_bend_moves_the_middle_no_further() -> None:
    rng, pixel = np.random.default_rng(5), 0.01
    waves = rng.normal(0, PIXELS * pixel, (200, 6))
    for share in (0.3, 0.6, 0.9):
        seen = [[bent(0, pixel=pixel)._replace(bends=tuple(w))] for w in (share * waves).tolist()]
        assert edge_error(seen) == pytest.approx(share * PIXELS * pixel, rel=0.05)
    shaped = edge_error([[bent(0.004, pixel=pixel)] * 9] * 20)
    assert shaped == pytest.approx(SHARE * 0.004, rel=0.03)


def test_stones_count_alike_and_a_bad_moment_does_not() -> None:
    calm = [bent(0.001)] * 9
    assert edge_error([calm * 20, [bent(0.003)]]) == edge_error([calm, [bent(0.003)]])
    assert edge_error([[*calm, bent(0.02)]]) == edge_error([calm])


def test_what_changes_from_picture_to_picture_is_no_bend() -> None:
    noise = [bent(0.003 * sign) for sign in (-1, 1) * 20]
    assert edge_error([noise]) == edge_error([[bent(0.0)]])


def test_stones_half_hidden_say_nothing() -> None:
    assert edge_error([]) == edge_error([[bent(0.02, visible=0.5)]])
    assert edge_error([]) == pytest.approx(SHARE * USUAL)
