import numpy as np
import pytest

from tests.vision.test_follow import sighting
from vision.roundness import SHARE, USUAL, edge_error
from vision.sighting import Sighting

WAVES = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])


def bent(bend: float, visible: float = 1.0) -> Sighting:
    return sighting((0.0, 1.0))._replace(bends=tuple(bend * WAVES), visible=visible)


def test_the_more_the_edges_are_bent_the_larger_the_error() -> None:
    errors = [edge_error([[bent(b)] * 9] * 6) for b in (0.0, 0.5 * USUAL, USUAL, 2 * USUAL)]
    assert (np.diff(errors) > 0).all()
    assert errors[2] == pytest.approx(SHARE * USUAL)


def test_stones_count_alike_and_a_bad_moment_does_not() -> None:
    calm = [bent(0.001)] * 9
    assert edge_error([calm * 20, [bent(0.003)]]) == edge_error([calm, [bent(0.003)]])
    assert edge_error([[*calm, bent(0.02)]]) == edge_error([calm])


def test_what_changes_from_picture_to_picture_is_no_bend() -> None:
    noise = [bent(0.003 * sign) for sign in (-1, 1) * 20]
    assert edge_error([noise]) == edge_error([[bent(0.0)]])


def test_stones_half_hidden_say_nothing() -> None:
    assert edge_error([]) == edge_error([[bent(0.02, visible=0.5)]]) == SHARE * USUAL
