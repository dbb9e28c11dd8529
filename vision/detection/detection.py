"""One stone seen in one picture."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.video.disk_cache import Cached

Array = NDArray[np.float64]


_NONE = np.empty((0, 3))


class Detection(NamedTuple):
    """One stone seen in one picture.

    Attributes
    ----------
    x, y : float
        Place on the ice under its centre by the camera at hand, m.
    sd_x, sd_y : float
        Standard error that is anew in each picture, m.
    sd_place : tuple of float
        Standard error, x and y, that the detections of a stone share by the camera and the slant of
        the view, m; NaN where it is not told yet.
    colour : ndarray, shape (3,)
        Colour of the cap, L*a*b*.
    visible : float
        Share of the circle that was seen, 0 to 1.
    score : float
        Evidence that it is a stone: 1 is little, 2.5 is much.
    outline : tuple of float
        Radii found for cap and granite (or the rim alone), as shares of the nominal ones.
    wall : float
        How high the wall of the cap is, m; means nothing where it is not seen.
    bends : tuple of float
        How the edge of cap or disc is bent (`curlshot.vision.detection.circles.Fits`), m.
    pixel : tuple of float
        Where the picture shows the middle of the cap, px.
    pixel_size : float
        How long a pixel is there by the camera at hand, m; NaN where it is not told yet.
    light : tuple of float
        Where the cap's centre lies by the lightness of its edge alone, less (x, y), m; NaN where
        it was not found.
    cap_samples, granite_samples : ndarray, shape (n, 3)
        Colours of the cap and of the granite, for learning.
    spectrum : Cached of ndarray or None
        How the cap looked around its centre (`curlshot.vision.spin.handle.cap_spectrum`); None
        where too little of it was seen to tell its angle.
    measured : bool
        Whether its edges were measured in this picture; else it looked as when they last were.
    swept : bool
        Whether its place goes by how far the motion smears its cap
        (`curlshot.vision.detection.smeared`).
    """

    x: float
    y: float
    sd_x: float
    sd_y: float
    sd_place: tuple[float, float]
    colour: Array
    visible: float
    score: float
    outline: tuple[float, ...]
    wall: float
    bends: tuple[float, ...]
    pixel: tuple[float, float]
    pixel_size: float
    light: tuple[float, float] = (nan, nan)
    spectrum: Cached[NDArray[np.complex64]] | None = None
    cap_samples: Array = _NONE
    granite_samples: Array = _NONE
    measured: bool = True
    swept: bool = False

    def without_samples(self) -> Detection:
        """Leave out what only learning needs."""
        return self._replace(cap_samples=_NONE, granite_samples=_NONE)


@dataclass(frozen=True, slots=True)
class Refusal:
    """A place that looked like a stone at first and was refused.

    Attributes
    ----------
    x, y : float
        Place on the ice, m.
    score : float
        Evidence for a stone, as far as it went.
    reason : str
        Why it is none.
    """

    x: float
    y: float
    score: float
    reason: str
