"""Callbacks for each frame as soon as its camera is known: a clip need be read only once."""

from __future__ import annotations

from collections.abc import Callable

from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.frame import Frame

Placed = Callable[[Frame, Camera], None]
"""Takes the frames that have a camera, in order; the camera may be provisional."""


def nobody(frame: Frame, camera: Camera) -> None:
    """Take a frame and do nothing."""
