"""Pictures as a decoder gives them: luma at every pixel, colour at every other one.

Most of a picture is never looked at in colour. So the planes of the decoder are kept as they
are, and colours are made where they are asked for.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import av
import cv2
import numpy as np
from av.video.reformatter import ColorRange, Colorspace
from numpy.typing import NDArray

Image = NDArray[np.uint8]
Floats = NDArray[np.float32]

_WEIGHTS = {
    int(Colorspace.ITU709): (0.2126, 0.0722),
    int(Colorspace.BT2020): (0.2627, 0.0593),
    int(Colorspace.SMPTE240M): (0.212, 0.087),
}
"""Weights of red and blue in luma (ITU-R BT.709, BT.2020, SMPTE 240M); else those of BT.601."""


@dataclass(frozen=True)
class Planes:
    """A picture of luma and chroma.

    Attributes
    ----------
    frame : av.VideoFrame
        As decoded, in the format yuv420p or yuvj420p.
    turns : int
        Quarter turns, counter-clockwise, by which it is shown.
    """

    frame: av.VideoFrame
    turns: int = 0

    @classmethod
    def of(cls, frame: av.VideoFrame) -> Planes:
        """Take a decoded frame of whatever format, the way up in which it is meant to be shown."""
        if frame.format.name not in ("yuv420p", "yuvj420p"):
            frame = frame.reformat(format="yuv420p")
        return cls(frame, round(frame.rotation / 90) % 4)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Height, width and 3, as of a picture in colour."""
        height, width = self.frame.height, self.frame.width
        return (width, height, 3) if self.turns % 2 else (height, width, 3)

    @cached_property
    def luma(self) -> Image:
        """Luma as coded, shape (h, w)."""
        return self._plane(0)

    @cached_property
    def chroma(self) -> tuple[Image, Image]:
        """Blue and red less luma as coded, each of shape (h / 2, w / 2), rounded up."""
        return self._plane(1), self._plane(2)

    def _plane(self, number: int) -> Image:
        plane = self.frame.planes[number]
        rows = np.frombuffer(memoryview(plane), np.uint8).reshape(plane.height, plane.line_size)
        values = rows[:, : plane.width]
        return np.ascontiguousarray(np.rot90(values, self.turns)) if self.turns else values

    @cached_property
    def image(self) -> Image:
        """The whole picture, BGR, shape (h, w, 3)."""
        found = np.asarray(self.frame.to_ndarray(format="bgr24"), np.uint8)
        return np.ascontiguousarray(np.rot90(found, self.turns)) if self.turns else found

    @cached_property
    def _to_bgr(self) -> NDArray[np.float64]:
        """Matrix, shape (3, 4), from luma, both chromas and 1 to blue, green and red."""
        red, blue = _WEIGHTS.get(self.frame.colorspace, (0.299, 0.114))
        full = self.frame.color_range == ColorRange.JPEG or self.frame.format.name == "yuvj420p"
        light, colour, black = (1.0, 1.0, 0.0) if full else (255 / 219, 255 / 224, 16.0)
        green = 1 - red - blue
        by_blue, by_red = 2 * colour * (1 - blue), 2 * colour * (1 - red)
        matrix = np.array(
            [
                [light, by_blue, 0.0],
                [light, -by_blue * blue / green, -by_red * red / green],
                [light, 0.0, by_red],
            ]
        )
        return np.column_stack([matrix, -matrix @ [black, 128.0, 128.0]])

    def at(self, x: Floats, y: Floats) -> Image:
        """Colours (BGR) at places, px, each of shape (rows, columns); black beside the picture."""
        luma = cv2.remap(self.luma, x, y, cv2.INTER_LINEAR)
        # Each sample of colour stands in the middle of the four pixels that share it.
        x, y = 0.5 * x - 0.25, 0.5 * y - 0.25
        blue, red = (
            cv2.remap(plane, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
            for plane in self.chroma
        )
        found = cv2.transform(cv2.merge([luma, blue, red]), self._to_bgr)
        return np.asarray(found, np.uint8)


Picture = Image | Planes
"""A picture in colour (BGR), or as decoded."""


def colours_at(picture: Picture, x: Floats, y: Floats) -> Image:
    """Colours (BGR) at places in a picture, bilinear, shape (rows, columns, 3).

    Parameters
    ----------
    x, y : ndarray of float32, shape (rows, columns)
        Places, px; neither side longer than 32766, as `cv2.remap` needs. Beside the picture
        it is dark.
    """
    if isinstance(picture, Planes):
        return picture.at(x, y)
    return np.asarray(cv2.remap(picture, x, y, cv2.INTER_LINEAR), np.uint8)


def image_of(picture: Picture) -> Image:
    """Give the whole picture in colour (BGR), shape (h, w, 3)."""
    return picture.image if isinstance(picture, Planes) else picture
