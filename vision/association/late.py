"""Stones that come to be seen when they already rest: how they got there, no picture shows.

A stone that sweepers hide all its way is first seen where it stops. So is one that has lain behind
somebody from the beginning; which of the two it was, the clip does not tell.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence

import numpy as np

from curlshot.data.sheet import Stone
from curlshot.vision.association.follow import Track
from curlshot.vision.optics.camera import Camera

LATE = 1.0
"""A stone is first seen late if its place was in view so long before, s: what is found anew is
followed back through a good part of that."""


def seen_late(rest: Mapping[str, Track], cameras: Sequence[Camera], disc: Stone) -> tuple[str, ...]:
    """Warn of stones that are first seen at rest where nothing was seen before.

    Parameters
    ----------
    rest : mapping of str to Track
        Stones that stay where they are, by their names.
    cameras : sequence of Camera
        In order of time.
    disc : Stone
        Size of the stones.
    """
    times = [camera.t for camera in cameras]
    out = []
    for name, track in rest.items():
        before = bisect_right(times, track.times[0] - LATE)
        if before and _in_view(cameras[before - 1], track, disc):
            out.append(
                f"{name} is first detected at {track.times[0]:.1f} s, at rest: its earlier motion"
                " and hits are unknown"
            )
    return tuple(out)


def _in_view(camera: Camera, track: Track, disc: Stone) -> bool:
    """Whether a camera shows all of the place at which a track begins."""
    x, y = track.detections[0].x, track.detections[0].y
    r = disc.radius
    rim = camera.project(
        np.array([(x - r, y), (x + r, y), (x, y - r), (x, y + r)]), disc.cap_height
    )
    return bool(np.all((rim >= 0) & (rim <= np.array(camera.size) - 1)))
