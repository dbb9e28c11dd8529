"""Graphics laid over the picture, as the icons of a score: no stones, though they look like some.

What rests or glides on the ice and what stays in the picture are told apart by which of the two the
detections bear out, once the ice moves in the picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.association.follow import Track
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.cameras import Cameras

Array = NDArray[np.float64]

LEAST_SD = 0.15
"""Standard error that a detection has at least, px: what films do to a picture that stays, and what
cameras are off by from picture to picture. Icons and stones at rest stray by .1 to .3."""

ASTRAY = 9.0
"""Most that a detection counts, in squares of its error: one farther off is of something else."""

TOLD = 1.0
"""By how much a detection must bear out picture rather than ice on average, in such squares.
Ten icons of eight drawn clips have 2.6 to 8.8 of 9, stones of those and 13 more .15 at most."""

IN_THE_OPEN = 1.6
"""Evidence of a stone up to which it is not held to glide along with a camera."""

SLOWING = 0.03, 0.4
"""By how much ice slows stones, m/s²: from a third of what is usual, before brooms, to four times
that. A camera that pans evenly, or starts to, draws what it shows over the ice as none is."""

ASIDE = 0.1
"""Largest acceleration across the way, m/s²: curling by 1 to 2 m in 25 s takes about .01."""


def is_graphic(track: Track, cameras: Sequence[Camera], disc: Stone) -> bool:
    """Whether what was taken for a stone stays where it is in the picture and not on the ice.

    Compares the squares of residuals in standard errors of three places: one that stays in the
    picture, one that stays on the ice, and a glide on it. Under a camera that stands still the
    first two are the same. What shows as much as a stone may be one that a camera goes along with.
    A graphic stays for most of the time: a stone that is hit may come to rest as the camera does,
    and neither one place on the ice nor one glide is all of its path.

    Parameters
    ----------
    track : Track
    cameras : sequence of Camera
        With those of its frames.
    disc : Stone
        Size of the discs.
    """
    x, y, sd_x, sd_y, score = track.detections.columns("x", "y", "sd_x", "sd_y", "score")
    by_frame = {camera.frame: camera for camera in cameras}
    by = Cameras.of([by_frame[frame] for frame in track.frames], [1] * len(x))
    places = np.column_stack([x, y])
    rest = np.broadcast_to(np.median(places, 0), places.shape)
    gliding = glide(np.array(track.times), places)
    seen, *on_ice = np.moveaxis(
        by.project(np.stack([places, rest, gliding], 1), disc.cap_height), 1, 0
    )
    rms = np.array([by_frame[frame].rms_px for frame in track.frames])
    sd = np.hypot(np.sqrt(sd_x * sd_y) * by.scale_at(places), np.fmax(rms, LEAST_SD))
    away = [((seen - where) ** 2).sum(1) for where in (np.median(seen, 0), *on_ice)]
    faint = bool(np.percentile(score, 75) <= IN_THE_OPEN)
    if not _stays(away, sd, faint):
        return False
    # A still camera is astray by more where people cover much of what tells it: stones at rest
    # then seem to move on the ice, and stay in the picture.
    own = [
        by_frame[frame].own_place_cov(place)
        for frame, place in zip(track.frames, places, strict=True)
    ]
    own_sd = np.sqrt(np.trace(own, axis1=1, axis2=2) / 2) * by.scale_at(places)
    return _stays(away, np.hypot(sd, own_sd), faint)


def _stays(away: list[Array], sd: Array, faint: bool) -> bool:
    """Whether squares of residuals, px², bear out the picture rather than rest or glide on ice."""
    off = [squares / sd**2 for squares in away]
    stays, rests, glides = (float(np.mean(np.minimum(squares, ASTRAY))) for squares in off)
    if faint:
        glides = np.inf
    return bool(np.median(off[0]) < ASTRAY) and min(rests, glides) - stays > TOLD


def glide(times: Array, places: Array) -> Array:
    """Give the places of a glide on ice that fits best, (n, 2), m: it slows down as stones do.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s.
    places : ndarray, shape (n, 2)
        m.
    """
    powers = np.vander(times - times.mean(), 3)
    line = powers[:, 1:]
    acceleration = 2 * np.linalg.lstsq(powers, places, rcond=None)[0][0]
    velocity = np.linalg.lstsq(line, places, rcond=None)[0][0]
    way = velocity / max(float(np.hypot(*velocity)), 1e-9)
    across = np.array([-way[1], way[0]])
    slowing = np.clip(-acceleration @ way, *SLOWING)
    aside = np.clip(acceleration @ across, -ASIDE, ASIDE)
    bend = 0.5 * np.outer(powers[:, 0], aside * across - slowing * way)
    return np.asarray(bend + line @ np.linalg.lstsq(line, places - bend, rcond=None)[0])
