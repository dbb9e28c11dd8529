"""Stones that are first seen at rest."""

from __future__ import annotations

from dataclasses import replace

import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.camera import still_camera
from curlshot.tests.helpers.vision.stones import camera_of, scene_of
from curlshot.tests.helpers.vision.tracks import Place, clip
from curlshot.vision.association.follow import follow
from curlshot.vision.association.late import seen_late
from curlshot.vision.optics.camera import Camera

WIDE = camera_of(still_camera(), scene_of([]))
CLOSE = camera_of(still_camera(px_per_m=500.0), scene_of([]))


@pytest.mark.parametrize(
    ("since", "begins", "warned"),
    [
        (0.0, WIDE, 0),  # it is there from the beginning
        (0.6, WIDE, 0),  # so late that may be chance
        (2.0, WIDE, 1),
        (2.0, CLOSE, 0),  # its place has only just come into view
    ],
)
def test_a_stone_first_seen_at_rest_is_told_of(since: float, begins: Camera, warned: int) -> None:
    def path(t: float) -> Place | None:
        return (1.6, 0.5) if t >= since else None

    frames = clip([path, lambda t: (0.0, 0.0)])
    tracks = {f"{t.detections[0].x:.0f}": t for t in follow(frames, STONE.radius)}
    assert len(tracks) == 2
    cameras = [replace(WIDE if t > 1.5 else begins, frame=index, t=t) for index, t, _ in frames]
    told = seen_late({"A": tracks["2"], "B": tracks["0"]}, cameras, STONE)
    assert len(told) == warned
    assert all(text.startswith(f"A is first detected at {since:.1f} s, at rest") for text in told)
