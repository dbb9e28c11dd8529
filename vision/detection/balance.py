"""Light: a clip's pictures bright enough to tell colours, and in the light of the first of them.

What stones may look like holds for ice that is nearly white. In a picture that was taken or coded
too dark, colours lie nearer to each other and to grey, by as much: it is brightened first.

The white balance and the exposure of a camera wander, and so does the light: then caps no longer
have the colours that were learned. Ice and paint keep theirs. So each place on the ice is compared
with itself, and what most of them say is how the light has changed.
"""

from __future__ import annotations

from math import nan

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.detection.appearance import Colour
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.picture import Image, Picture, brightened, colours_at

Array = NDArray[np.float64]

PLACES = np.stack(np.meshgrid(np.arange(-2, 2.1, 0.4), np.arange(-4.4, 9, 0.4)), -1).reshape(-1, 2)
"""Places on the ice that are compared, m."""

LEAST_PLACES = 8
"""Of fewer that are known and in view, half may be behind a stone and a sweeper."""

DARKEST, LIGHTEST = 40, 250
"""Coded colours that tell of the light: below is mostly noise, above something may be cut off."""

CHANGED = 0.04
"""Least change of the light, a share, that is made good: learned colours hold within that, and
a light that stays leaves the pictures as they are."""


DIM, BRIGHT = 160, 210
"""Coded white of the ice below which a picture is brightened, and to which; broadcasts show 205 to
245."""

MOST_BRIGHTENED = 5.0
"""Most by which a picture is brightened: of a darker one noise and coding have left no colours."""

GRANITE, DARKENED = 0.47, 0.27
"""Code of granite as a share of the code of the ice's white, and below which share dark tones are
lifted: 0.40 to 0.56 in 31 real pictures and 0.43 to 0.53 in drawn ones; where all codes were taken
to the power 2.2, as of recordings whose tones are linear, 0.17 to 0.26."""


def brightening(picture: Picture, camera: Camera) -> float:
    """Tell by how much a picture is to be brightened; 1 where its ice is white enough."""
    white = _white(picture, camera)
    return min(BRIGHT / max(white, 1.0), MOST_BRIGHTENED) if white < DIM else 1.0


def tones(picture: Picture, camera: Camera, granite: Colour | None) -> Image | None:
    """Tell by which codes those of a picture are to be replaced, shape (256,): see `toned`.

    None where granite is as light beside the ice as it is wont to be, or is not known.
    """
    white = _white(picture, camera)
    share = nan if granite is None else max(granite.bgr) / max(white, 1.0)
    if not 0 < share < DARKENED:
        return None
    codes = white * (np.arange(256) / white) ** (np.log(GRANITE) / np.log(share))
    return np.asarray(np.clip(np.round(codes), 0, 255), np.uint8)


def _white(picture: Picture, camera: Camera) -> float:
    """Code of the white of the ice; NaN where too little of it is in view."""
    _, colours = _colours(picture, camera)
    return float(np.percentile(colours.max(1), 90)) if len(colours) >= LEAST_PLACES else nan


class Balance:
    """Remembers how places on the ice look in the light of one picture.

    Parameters
    ----------
    picture, camera : Picture, Camera
        That picture, and its camera.
    """

    def __init__(self, picture: Picture, camera: Camera):
        self._ice = np.full((len(PLACES), 3), np.nan)
        self._gain = np.ones(3)
        self.look(picture, camera)

    def look(self, picture: Picture, camera: Camera) -> None:
        """See how the light is now, and what the ice is like that was not in view so far."""
        places, colours = _seen(picture, camera)
        before = self._ice[places]
        known = np.isfinite(before[:, 0])
        if known.sum() >= LEAST_PLACES:
            gain = np.median(before[known] / colours[known], axis=0)
            if np.abs(gain / self._gain - 1).max() > CHANGED:
                self._gain = gain
        self._ice[places[~known]] = colours[~known] * self._gain

    def evened(self, picture: Picture) -> Picture:
        """Give a picture, taken in the light that was seen last, in that of the first one."""
        return brightened(picture, self._gain)


def _seen(picture: Picture, camera: Camera) -> tuple[NDArray[np.intp], Array]:
    """Tell which of the places a picture shows by whose colours the light is told, and these."""
    places, colours = _colours(picture, camera)
    tells = ((colours > DARKEST) & (colours < LIGHTEST)).all(1)
    return places[tells], colours[tells]


def _colours(picture: Picture, camera: Camera) -> tuple[NDArray[np.intp], Array]:
    """Tell which of the places a picture shows, and their colours, blue, green and red."""
    depth = PLACES @ camera.homography[2, :2] + camera.homography[2, 2]
    pixels = camera.project(PLACES)
    inside = (depth > 0) & ((pixels >= 0) & (pixels <= np.array(camera.size) - 1)).all(1)
    x, y = pixels[inside].astype(np.float32).T[..., None]
    if not len(x):
        return np.empty(0, np.intp), np.empty((0, 3))
    return np.flatnonzero(inside), colours_at(picture, x, y)[:, 0].astype(float)
