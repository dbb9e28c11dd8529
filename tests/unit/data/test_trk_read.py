from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.data.tracker import read_table
from curlshot.tests.helpers.data.dialects import KEYS, MARKS, numbers, project, put


def test_places_are_those_of_the_moving_coordinate_system(tmp_path: Path) -> None:
    found = read_table([put(tmp_path, project())]).detections.set_index(["stone", "frame"])
    for (stone, frame), row in found.iterrows():
        px, py = MARKS[stone][frame]
        ox, oy, angle, sx, sy = KEYS[0 if frame < 3 else 3]
        place = complex((px - ox) / sx, -(py - oy) / sy) * np.exp(-1j * np.radians(angle))
        np.testing.assert_allclose([row["x"], row["y"]], [place.real, place.imag], atol=1e-12)
        assert row["t"] == pytest.approx(frame * 0.04)


def test_only_steps_of_the_clip_count_and_time_starts_there(tmp_path: Path) -> None:
    clip = numbers(startframe=1, stepsize=2, stepcount=2, starttime=500)
    found = read_table([put(tmp_path, project(keys={0: KEYS[0]}, clip=clip))])
    assert list(found.detections["frame"]) == [1, 3]
    np.testing.assert_allclose(found.detections["t"], [0.5, 0.58])
    assert any("blue has no mark in the clip" in text for text in found.warnings)


def test_frames_before_a_shift_are_dropped(tmp_path: Path) -> None:
    clip = numbers(startframe=2, frameshift=2)
    found = read_table([put(tmp_path, project(clip=clip))]).detections
    assert list(found["frame"][found["stone"] == "red"]) == [0, 1, 2, 3]


def test_reference_frame_gives_the_origin_and_is_left_out(tmp_path: Path) -> None:
    marks = {
        "base": {0: (10.0, 10.0), 2: (20.0, 10.0)},
        "red": dict.fromkeys(range(4), (60.0, 10.0)),
    }
    root = '<property name="referenceframe" type="string">base</property>'
    keys = {0: (0.0, 0.0, 0.0, 10.0, 10.0)}
    found = read_table([put(tmp_path, project(marks, keys, root=root))])
    assert list(found.detections["stone"]) == ["red"] * 4
    np.testing.assert_allclose(found.detections["x"], [5, 5, 4, 4])
    assert any("relative to base" in text for text in found.warnings)


def test_uneven_frames_of_the_video_keep_their_times(tmp_path: Path) -> None:
    stamps = '<property name="start_times" type="array" class="[D">' + (
        '<property name="array" type="string">{0,40,80,160,200,240}</property></property>'
    )
    found = read_table([put(tmp_path, project(video=stamps, duration=48.0))])
    red = found.detections[found.detections["stone"] == "red"]
    np.testing.assert_allclose(red["t"], np.array([0, 40, 80, 160, 200, 240]) / 1000)
    assert any("uneven" in text for text in found.warnings)


def test_marks_filled_in_between_marks_by_hand_are_told(tmp_path: Path) -> None:
    keys = (
        '<property name="keyFrames" type="array" class="[I"><property name="array" type="string">'
    )
    keys += "{%s}</property></property>"
    curve = {n: (10.0 * n, 3.0 * n * n) for n in range(6)}
    line = {n: (10.0 * n, 15.0 * n) for n in range(6)}
    for rows, by_hand, told in [(line, "0,5", "4 places"), (line, "9", ""), (curve, "0,5", "")]:
        text = project({"red": rows}, {0: (0.0, 0.0, 0.0, 100.0, 100.0)})
        text = text.replace('<property name="name"', keys % by_hand + '<property name="name"')
        warnings = read_table([put(tmp_path, text)]).warnings
        assert any(told in text for text in warnings) if told else not warnings
