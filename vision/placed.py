"""Who is told of each frame as soon as its camera is known: a clip need be read only once."""

from __future__ import annotations

from collections.abc import Callable

from vision.camera import Camera
from vision.clip import Frame

Placed = Callable[[Frame, Camera], None]
"""Takes the frames that have a camera, in order; the camera may be provisional."""


def nobody(frame: Frame, camera: Camera) -> None:
    """Take a frame and do nothing."""
