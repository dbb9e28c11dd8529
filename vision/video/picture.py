"""Pictures as a decoder gives them: luma at every pixel, colour at every other one.

Most of a picture is never looked at in colour. So the planes of the decoder are kept as they
are, and colours are made where they are asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import av
import cv2
import numpy as np
from av.video.reformatter import ColorRange
from numpy.typing import NDArray

Image = NDArray[np.uint8]
Floats = NDArray[np.float32]

TO_CHROMA = np.array([[0.114, 0.587, 0.299], [0.5, -0.331, -0.169], [-0.081, -0.419, 0.5]])
"""Luma and the two chromas of blue, green and red (ITU-R BT.601)."""

_WEIGHTS = {1: (0.2126, 0.0722), 9: (0.2627, 0.0593), 7: (0.212, 0.087)}
"""Weights of red and blue in luma by the number of the matrix in ITU-T H.273 (BT.709, BT.2020 and
SMPTE 240M; not all releases of PyAV have names for them); else those of BT.601."""


@dataclass(frozen=True)
class Planes:
    """A picture of luma and chroma.

    Attributes
    ----------
    luma : ndarray, shape (h, w)
        As coded.
    blue, red : ndarray
        Blue and red less luma as coded, of the size of the luma or of half of it.
    to_bgr : ndarray, shape (3, 4)
        From luma, both chromas and 1 to blue, green and red.
    share : float
        Samples of chroma per sample of luma, along either side.
    frame : av.VideoFrame, optional
        What they are the planes of, for the whole picture in colour.
    turns : int
        Quarter turns, counter-clockwise, by which that was turned.
    """

    luma: Image
    blue: Image
    red: Image
    to_bgr: NDArray[np.float64]
    share: float = 0.5
    frame: av.VideoFrame | None = None
    turns: int = 0

    @classmethod
    def of(cls, frame: av.VideoFrame, pixel: float = 1.0) -> Planes:
        """Take a decoded frame of whatever format as it is meant to be shown: upright, unsqueezed.

        Parameters
        ----------
        frame : av.VideoFrame
        pixel : float
            Width of its pixels over their height.
        """
        turns = round(frame.rotation / 90) % 4
        name = frame.format.name
        layout = name if name in ("yuv420p", "yuvj420p") else "yuv420p"
        width = frame.width if pixel == 1 else 2 * round(frame.width * pixel / 2)
        if (layout, width) != (name, frame.width):
            frame = frame.reformat(width=width, format=layout)
        luma, blue, red = (_upright(_values(plane), turns) for plane in frame.planes)
        return cls(luma, blue, red, _to_bgr(frame), frame=frame, turns=turns)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Height, width and 3, as of a picture in colour."""
        height, width = self.luma.shape
        return height, width, 3

    @cached_property
    def image(self) -> Image:
        """The whole picture, BGR, shape (h, w, 3)."""
        if self.frame is None:
            height, width = self.luma.shape
            chroma = [cv2.resize(plane, (width, height)) for plane in (self.blue, self.red)]
            return np.asarray(cv2.transform(cv2.merge([self.luma, *chroma]), self.to_bgr), np.uint8)
        found = np.asarray(self.frame.to_ndarray(format="bgr24"), np.uint8)
        return _upright(found, self.turns)

    def at(self, x: Floats, y: Floats) -> Image:
        """Colours (BGR) at places, px, shape (rows, columns, 3): see `colours_at`."""
        return np.asarray(cv2.transform(cv2.merge(self._coded(x, y)), self.to_bgr), np.uint8)

    def channels(self, x: Floats, y: Floats) -> Floats:
        """Colours at places, px, shape (3, rows, columns): see `channels_at`."""
        coded = np.array(self._coded(x, y), np.float32).reshape(3, -1)
        mixed = self.to_bgr.astype(np.float32)
        return np.asarray(mixed[:, :3] @ coded + mixed[:, 3:]).reshape(3, *x.shape)

    def _coded(self, x: Floats, y: Floats) -> tuple[Image, Image, Image]:
        """Luma and both chromas at places, px, shape (rows, columns) each."""
        luma = cv2.remap(self.luma, x, y, cv2.INTER_LINEAR)
        # A sample of colour stands in the middle of the pixels that share it.
        x, y = (self.share * along + 0.5 * (self.share - 1) for along in (x, y))
        blue, red = (
            cv2.remap(plane, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
            for plane in (self.blue, self.red)
        )
        return np.asarray(luma, np.uint8), np.asarray(blue, np.uint8), np.asarray(red, np.uint8)

    def reduced(self, times: int) -> Planes:
        """Give the picture so many times smaller, each pixel the mean of what it covers."""
        height, width = self.luma.shape[0] // times, self.luma.shape[1] // times
        covered = times * height, times * width
        chroma = tuple(round(self.share * side + 0.25) for side in covered)
        return Planes(
            _shrunk(self.luma, covered, (height, width)),
            _shrunk(self.blue, chroma, (height, width)),
            _shrunk(self.red, chroma, (height, width)),
            self.to_bgr,
            share=1.0,
        )


def _shrunk(plane: Image, covered: tuple[int, ...], size: tuple[int, int]) -> Image:
    """Shrink what is covered of a plane, (height, width), to a size."""
    part = plane[: covered[0], : covered[1]]
    if part.shape[:2] == size:
        return part
    return np.asarray(cv2.resize(part, size[::-1], interpolation=cv2.INTER_AREA), np.uint8)


def _values(plane: Any) -> Image:
    rows = np.frombuffer(memoryview(plane), np.uint8).reshape(plane.height, plane.line_size)
    return rows[:, : plane.width]


def _upright(values: Image, turns: int) -> Image:
    return np.ascontiguousarray(np.rot90(values, turns)) if turns else values


def _to_bgr(frame: av.VideoFrame) -> NDArray[np.float64]:
    """Matrix, shape (3, 4), from luma, both chromas and 1 to blue, green and red."""
    full = frame.color_range == ColorRange.JPEG or frame.format.name == "yuvj420p"
    return _matrix(int(frame.colorspace), full)


@lru_cache(maxsize=4)
def _matrix(space: int, full: bool) -> NDArray[np.float64]:
    red, blue = _WEIGHTS.get(space, (0.299, 0.114))
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
    found = np.column_stack([matrix, -matrix @ [black, 128.0, 128.0]])
    found.flags.writeable = False  # all pictures of a clip share it
    return found


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


def channels_at(picture: Picture, x: Floats, y: Floats) -> Floats:
    """Colours (blue, green, red) at places in a picture, a table for each, (3, rows, columns).

    As `colours_at`, but neither rounded nor held between 0 and 255 if it was decoded.
    """
    if isinstance(picture, Planes):
        return picture.channels(x, y)
    found = cv2.remap(picture, x, y, cv2.INTER_LINEAR)
    return np.ascontiguousarray(np.moveaxis(found, -1, 0), np.float32)


def lightness_at(picture: Picture, x: Floats, y: Floats) -> Image:
    """Lightness at places in a picture, as it is coded: as `colours_at`, shape (rows, columns)."""
    if isinstance(picture, Planes):
        return np.asarray(cv2.remap(picture.luma, x, y, cv2.INTER_LINEAR), np.uint8)
    return np.asarray(cv2.cvtColor(colours_at(picture, x, y), cv2.COLOR_BGR2GRAY), np.uint8)


def brightened(picture: Picture, gain: NDArray[np.float64]) -> Picture:
    """Give a picture in another light: blue, green and red times a gain, shape (3,)."""
    if np.all(gain == 1):
        return picture
    if isinstance(picture, Planes):
        return replace(picture, to_bgr=gain[:, None] * picture.to_bgr, frame=None)
    return np.asarray(cv2.transform(picture, np.diag(gain)), np.uint8)


def toned(picture: Picture, table: Image | None) -> Picture:
    """Give a picture with other tones: for each code, 0 to 255, another one, shape (256,)."""
    if table is None:
        return picture
    if isinstance(picture, Planes):
        picture = replace(picture, frame=None)
    return np.asarray(cv2.LUT(image_of(picture), table), np.uint8)


def image_of(picture: Picture) -> Image:
    """Give the whole picture in colour (BGR), shape (h, w, 3)."""
    return picture.image if isinstance(picture, Planes) else picture


def reduced(picture: Picture, times: int) -> Picture:
    """Give a picture so many times smaller, each pixel the mean of what it covers."""
    if times == 1:
        return picture
    if isinstance(picture, Planes):
        return picture.reduced(times)
    height, width = picture.shape[0] // times, picture.shape[1] // times
    return _shrunk(picture, (times * height, times * width), (height, width))
