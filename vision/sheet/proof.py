"""Whether circles that fit a house are one: by what else a house shows, and what it does not."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE
from curlshot.vision.optics.paint import EIGHT, TWELVE
from curlshot.vision.optics.pose import View, pictured
from curlshot.vision.sheet.lines import clearness
from curlshot.vision.sheet.marks import Evidence
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]

WHOLE = 0.6
"""Share of what is visible of a circle that is nearly all of it, with people over it."""

LEAST_SUPPORT = 0.3
"""The same for an inner circle that is there at all."""

LEAST_OUTER, LEAST_COVERED = 0.35, 0.12
"""The same for the 12-ft circle, of which a piece alone may be seen; and the least such piece."""

IN_VIEW = 0.05
"""Share of a circle that is visible, if it may be asked for."""

DIMMEST, GREYEST = 80.0, 0.6
"""Least of the three colours of ice, in grey levels and as a share of the greatest."""

UNPAINTED = ((0.72, 1.1), (1.32, 1.7), (1.95, 6.0))
"""From where to where there is no edge of a circle, m; the third holds the rings of a house of
which the 4-ft circle and the button were taken for all."""

AROUND, LEAST_AROUND = 1.05 * HOUSE.twelve_foot * HOUSE.eight_foot / HOUSE.four_foot, 0.2
"""Just beyond where the 8-ft circle is if the 4-ft one was taken for the 12-ft, m; and the share of
a circle there that must be in view to tell that it was not, where no 8-ft circle is seen."""

LEAST_STEP, LEAST_CONTRAST, WHOLE_AROUND = 20.0, 0.15, 0.7
"""By how much an edge stands out, in grey levels and as a share of what the 12-ft circle does, and
in what share of its directions, for a circle that is there: a lens that leaves corners dark makes
steps all around, of 10 to 20 levels where paint makes 200."""

ENOUGH_SEEN = 0.5
"""Share of such a circle that must be in view. Without an 8-ft circle `LEAST_COVERED` is enough:
the 4-ft circle may have been taken for the 12-ft one, and most around it may be out of view."""

BARE = 0.35
"""How far what is within the 8-ft circle may be from the ice's colour and be bare, in steps from
ice to paint."""

ALIKE = 12.0
"""Difference of such colours that tells nothing, grey levels: where outlines alone are drawn, paint
is ice as well."""

CROSSED = 2.3
"""How much more centre and tee line must stand out than other lines through the tee to prove a
house; spokes of a wheel do by up to 2."""


def worth(evidence: Evidence) -> float:
    """How much of a house this is, up to 3.5; 0 where it is none."""
    support, covered = evidence.support, evidence.covered
    if covered[0] < LEAST_COVERED or support[0] < LEAST_OUTER:
        return 0.0
    seen = evidence.visible > IN_VIEW
    # Edges of other things rarely stand as 3 : 2; where there are but 3 : 1, they must be whole
    # and what is around them ice. Of a sliver of the house the 8-ft circle looks like the 4-ft.
    inner = support[1] > LEAST_SUPPORT or (support[2] > LEAST_SUPPORT and not seen[1])
    ice = evidence.palette[TWELVE, 0]
    icy = ice.min() >= max(GREYEST * ice.max(), DIMMEST)
    whole = min(support[0], support[2], evidence.visible[0]) >= WHOLE
    if not inner and not (whole and icy):
        return 0.0
    return float(covered.sum() + 0.5 * support[seen].mean())


def is_house(image: Image, evidence: Evidence, view: View, rig: Array) -> bool:
    """Say whether circles that fit belong to a house, not to a target, a wheel or an eye.

    Three circles with bare ice between the paint, or the lines through the tee, tell it.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    evidence : Evidence
        Of the circles, as fitted.
    view, rig : View, ndarray
        The camera.
    """
    ice, paint = evidence.palette[TWELVE]
    within = evidence.palette[EIGHT, 1]
    most = max(BARE * float(np.linalg.norm(paint - ice)), ALIKE)
    bare = bool(np.linalg.norm(within - ice) < most)
    ringed = bare and evidence.support.min() > WHOLE
    if not ringed and clearness(image, view, rig) < CROSSED:
        return False
    return stands_alone(image, evidence, view, rig)


def stands_alone(image: Image, evidence: Evidence, view: View, rig: Array) -> bool:
    """Whether there are no other circles about those of a house, and that can be told."""
    if evidence.support[1] > LEAST_SUPPORT:
        least = ENOUGH_SEEN
    elif _shown(image, view, rig, AROUND) > LEAST_AROUND:
        least = LEAST_COVERED
    else:
        return False
    ice, paint = evidence.palette[TWELVE]
    step = max(LEAST_STEP, LEAST_CONTRAST * float(np.linalg.norm(paint - ice)))
    return not _is_target(image, view, rig, least, step)


def _shown(image: Image, view: View, rig: Array, radius: float) -> float:
    """Share of a circle about the tee that is in the picture."""
    angle = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    place = radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return float(pictured(place, view.vector, rig, (image.shape[1], image.shape[0]))[1].mean())


def _is_target(image: Image, view: View, rig: Array, least: float, least_step: float) -> bool:
    """Whether there are whole circles where a house has none: between its own or around them.

    Of each, `least` of it must be in view, and its edge a step by that many grey levels.
    """
    angle = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    size = (image.shape[1], image.shape[0])
    for first, last in UNPAINTED:
        radius = np.exp(np.arange(np.log(first), np.log(last), 0.01))
        place, seen = pictured(radius[:, None, None] * way, view.vector, rig, size)
        x, y = np.where(seen[..., None], place, 0.0).astype(np.float32).transpose(2, 0, 1)
        colour = cv2.remap(image, x, y, cv2.INTER_LINEAR).astype(float)
        within = seen[8:] & seen[:-8]
        step = (colour[8:] - colour[:-8]) * within[..., None]
        count = np.maximum(within.sum(1), 1)
        usual = step.sum(1) / count[:, None]
        square = (usual**2).sum(-1)
        alike = np.maximum(0.5 * square, least_step * np.sqrt(square))
        there = within & ((step * usual[:, None]).sum(-1) > alike[:, None])
        whole = there.sum(1) > WHOLE_AROUND * count
        if (whole & (count > least * len(angle))).any():
            return True
    return False
