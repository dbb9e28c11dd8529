from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.data.tracker import read_table
from curlshot.data.trk import Coordinates, PointMass, Project, Timing
from curlshot.tests.helpers.data.dialects import project, put
from curlshot.tests.helpers.data.trk import SYSTEM


def test_axes_turn_counter_clockwise_and_y_points_up() -> None:
    turned = Coordinates(
        np.array([0]), np.array([[100.0, 50.0]]), np.radians([90.0]), np.array([[20.0, 20.0]])
    )
    # With the x axis up in the picture, what lies to the right is at negative y.
    places = turned.world(np.zeros(2, int), np.array([[100.0, 30.0], [120.0, 50.0]]))
    np.testing.assert_allclose(places, [[1.0, 0.0], [0.0, -1.0]], atol=1e-12)


def test_a_key_holds_until_the_next() -> None:
    here = SYSTEM.at([0, 2, 3, 50])
    assert here.scale[:, 0].tolist() == [50.0, 50.0, 40.0, 40.0]


def test_steps_of_a_clip_and_their_times() -> None:
    even = Timing(2, 3, 2, 0.5, 0.04, np.empty(0))
    frames = np.arange(10)
    assert frames[even.includes(frames)].tolist() == [2, 5]
    np.testing.assert_allclose(even.times(np.array([2, 5])), [0.5, 0.62])
    uneven = Timing(1, 1, 3, 0.5, 0.04, np.array([0.0, 0.04, 0.1, 0.12]))
    np.testing.assert_allclose(uneven.times(np.array([1, 2, 3])), [0.5, 0.56, 0.58])


def test_a_project_without_marks_says_what_it_has_and_what_else_can_be_done() -> None:
    timing = Timing(0, 1, 9, 0.0, 0.04, np.empty(0))
    bare = Project("a.trk", (), SYSTEM, SYSTEM, timing, "m", ("a.mp4",), others=("Vector",))
    with pytest.raises(InputError, match=r"^a.trk: no point mass .*Vector.*`clip`"):
        bare.file()


def test_what_was_done_to_the_picture_and_between_marks_is_told() -> None:
    timing = Timing(0, 1, 9, 0.0, 0.04, np.empty(0))
    frames = np.arange(4)
    red = PointMass("red", 19.0, frames, np.ones((4, 2)), filled=2)
    late = PointMass("late", 1.0, frames + 20, np.ones((4, 2)))
    found = Project(
        "a.trk", (red, late), SYSTEM, SYSTEM, timing, "m", (), filters=("rotate",)
    ).file()
    assert found.tracks["stone"].tolist() == ["red"] * 4
    assert found.masses["red"] == 19.0
    for words in ("(rotate)", "filled in 2 places of red", "late has no mark in the clip"):
        assert any(words in text for text in found.warnings), words


def test_length_unit_of_the_project(tmp_path: Path) -> None:
    root = '<property name="length_unit" type="string">cm</property>'
    plain = read_table([put(tmp_path, project())]).detections
    found = read_table([put(tmp_path, project(root=root))])
    np.testing.assert_allclose(found.detections["x"], plain["x"] / 100)
    assert not [text for text in found.warnings if "unit" in text or "header" in text]
    with pytest.raises(InputError, match="length unit is cm, as the project says, not ft"):
        read_table([put(tmp_path, project(root=root))], length_unit="ft")
    odd = put(tmp_path, project(root=root.replace("cm", "ell")))
    with pytest.raises(InputError, match="“ell”, which is unknown here; known are"):
        read_table([odd])
    named = read_table([odd], length_unit="cm").detections
    np.testing.assert_allclose(named["x"], plain["x"] / 100)
