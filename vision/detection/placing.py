"""From measures to detections: where a camera places them, and what errors they share."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import STONE, Stone
from curlshot.vision.detection.appearance import GREY
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.measure import Measures
from curlshot.vision.detection.patch import handle_radii
from curlshot.vision.detection.rays import Look
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.cameras import Cameras
from curlshot.vision.spin.handle import cap_spectrum
from curlshot.vision.video.colour import chroma
from curlshot.vision.video.disk_cache import Cached

Array = NDArray[np.float64]

UNCOVERED = 0.75
"""Share of a cap that must be seen for its angle to be measured."""

CAP_END_SD = (0.06, 0.15, 0.35, 0.9, 1.1), (0.008, 0.0045, 0.003, 0.003, 0.005)
"""Slants of the view, and how well the height of what ends at the edge of a cap is known, m: by so
much times the slant a place is off along the view, and not across it. Granite is 0.1143 m high or
more (rule C1), its cap ends some mm above it. From above either end of the cap's side may be
taken for its edge; from where on the far shoulder hides behind the cap, other things end there.
Beyond what their cameras were, drawn stones of 44 clips of three makers were off along the view by
as much as 6.4 mm of height make at slants below 0.12, 2.4 to 3.4 up to 0.95 and 5.2 from there on;
of 12 clips with caps that end at 0.12 m, 1 mm and 2.7."""

MIXED_SD = 0.003
"""How much less well that is known of caps without hue, m: what pixels mix of cap, granite and ice
at their far edges depends on how full the granite's shoulders are, and on where light was blurred
(`curlshot.vision.detection.mixture`). 27 drawn ones were off along the view by what 4 mm of height
make."""

HIDES = (STONE.radius - STONE.cap_radius) / (STONE.cap_height - STONE.rim_height)
"""Slant from which on a usual cap, too, has no granite left to be seen at its far edge."""

ASTRAY = 0.15
"""How far the map of a house is wrong, in residuals of its camera's edges per metre from the tee:
beyond what the camera states, and beside what a slant hides, which from above looks much like it.
Between nothing, as round stones on plain rings say, and half of them, as outlined rings do."""

GIVEN_ASTRAY = 0.35
"""How far a map may be wrong of which no error is stated, in residuals of the camera's edges."""

USUAL_RMS_PX = 0.3
"""What that residual is taken for where it is not known, px."""


def detections(
    seen: Measures, looks: Sequence[Look], chosen: NDArray[np.intp], disc: Stone
) -> list[Detection]:
    """Give detections of places that were measured; what they share is not told yet.

    Parameters
    ----------
    seen : Measures
    looks : sequence of Look
        What was measured, in the same order.
    chosen : ndarray of int
        Which of the places, ascending.
    disc : Stone
        Size of the discs.
    """
    ends = np.cumsum([0, *(len(look.places) for look in looks)])
    parts = zip(looks, np.split(chosen, np.searchsorted(chosen, ends[1:-1])), strict=True)
    pixels = [look.camera.project(seen.centre[i], disc.cap_height) for look, i in parts if len(i)]
    spectra = cap_spectrum(seen.handle[chosen], handle_radii(disc))
    columns = (
        seen.centre[chosen], seen.sd[chosen], seen.visible[chosen], seen.evidence[chosen],
        seen.outline[chosen], seen.wall[chosen], seen.bends[chosen],
        np.concatenate([np.empty((0, 2)), *pixels]), seen.uncovered[chosen] >= UNCOVERED,
        seen.light[chosen], seen.swept[chosen],
    )  # fmt: skip
    rows = zip(seen.colour[chosen], spectra, *(column.tolist() for column in columns), strict=True)
    return [
        Detection(
            x, y, sd_x, sd_y, (nan, nan), colour, visible, score, tuple(outline), wall,
            tuple(bends), (u, v), nan, (light_x, light_y),
            Cached(spectrum.copy()) if told else None, swept=swept,
        )
        for colour, spectrum, (x, y), (sd_x, sd_y), visible, score, outline, wall, bends, (u, v),
        told, (light_x, light_y), swept in rows
    ]  # fmt: skip


def placed_by(
    cameras: Sequence[Camera], seen: Sequence[Sequence[Detection]], disc: Stone
) -> list[list[Detection]]:
    """Give detections the places that cameras of their pictures give them, with what they share.

    Parameters
    ----------
    cameras : sequence of Camera
        Of pictures of one size.
    seen : sequence of sequence of Detection
        What was seen in the picture of each.
    disc : Stone
        Size of the discs, their caps as large as they show.
    """
    each = [[*one] for one in seen]
    flat = [detection for one in each for detection in one]
    if not flat:
        return each
    by = Cameras.of(cameras, [len(one) for one in each])
    places = by.ice(np.array([detection.pixel for detection in flat]), disc.cap_height)
    size = 1 / by.scale_at(places)
    grey = chroma(np.array([detection.colour for detection in flat])) < GREY
    shared = _shared_errors(by, places, size, disc, grey)
    told = zip(flat, places.tolist(), shared.tolist(), size.tolist(), strict=True)
    placed = iter(
        detection._replace(x=x, y=y, sd_place=(sd_x, sd_y), pixel_size=pixel)
        for detection, (x, y), (sd_x, sd_y), pixel in told
    )
    return [[next(placed) for _ in one] for one in each]


def _shared_errors(
    by: Cameras, places: Array, pixel: Array, disc: Stone, grey: NDArray[np.bool_]
) -> Array:
    """Give the standard errors that no filter averages out, (n, 2), m: by camera and slant.

    Less granite is left around a cap that is larger than usual, and pixels mix it with what lies
    beyond: by about as much as such a cap is larger, times the slant, places are off along the view
    (in 12 drawn clips with caps of 0.109 m and more: 9 mm for caps 9 mm larger), up to where a
    usual one has none left either.
    """
    rms, given = np.array([(c.rms_px, c.error is None) for c in by.each])[by.row].T
    rms = np.where(np.isfinite(rms), rms, USUAL_RMS_PX)
    slant = by.slants(places)
    tilt = np.hypot(*slant.T)
    larger = max(disc.cap_radius - STONE.cap_radius, 0.0) * HIDES / np.maximum(tilt, HIDES)
    height = np.hypot(np.interp(tilt, *CAP_END_SD), larger)
    height = np.hypot(height, grey * MIXED_SD)
    aslant = height[:, None] * slant if disc.cap_height else 0 * slant
    astray = np.where(given > 0, GIVEN_ASTRAY, ASTRAY * np.hypot(*places.T))
    off = np.hypot(aslant, (pixel * astray * rms)[:, None])
    stated = np.diagonal(by.shared_place_cov(places, disc.cap_height), axis1=1, axis2=2)
    return np.asarray(np.sqrt(off**2 + stated))
