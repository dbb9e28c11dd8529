"""Stones in a few pictures of one clip, each looked at on its own: what was taken, what refused."""

from __future__ import annotations

from collections.abc import Sequence

from data.sheet import STONE, Stone
from vision.appearance import CONVINCING, learn
from vision.camera import Camera
from vision.clip import Image
from vision.stones import Findings, search_picture


def glance(pictures: Sequence[tuple[Image, Camera]], disc: Stone = STONE) -> list[Findings]:
    """Search each picture, knowing what the stones of all of them look like.

    Parameters
    ----------
    pictures : sequence of (ndarray of shape (h, w, 3), Camera)
    disc : Stone
        Size of the stones, or `plain_disc(radius)` for other discs.

    Returns
    -------
    list of Findings
        One per picture, with the places that were refused and why.
    """
    first = [search_picture(image, camera, None, disc) for image, camera in pictures]
    appearance = learn([s for found in first for s in found.stones if s.score > CONVINCING])
    if appearance is None:
        return first
    return [search_picture(image, camera, appearance, disc) for image, camera in pictures]
