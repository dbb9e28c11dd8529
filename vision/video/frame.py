"""A frame of a clip: its picture, its number in the container and its time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from curlshot.vision.video.picture import Image, Picture, image_of


@dataclass(frozen=True)
class Frame:
    """One frame of a clip.

    Attributes
    ----------
    index : int
        Its number among the decoded frames of the container, duplicates counted.
    t : float
        Its time, s.
    picture : Picture
        What it shows.
    """

    index: int
    t: float
    picture: Picture

    @cached_property
    def image(self) -> Image:
        """The picture in colour (BGR), shape (h, w, 3)."""
        return image_of(self.picture)
