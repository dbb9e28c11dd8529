"""Find the house in one picture, whatever its colours.

Hypotheses of concentric rings are fitted with a camera in a small picture and judged by how much
of the circles they explain; the best is refined at full resolution, with the lines.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.pose import rescaled
from curlshot.vision.optics.rig import ANYWHERE, POSITION
from curlshot.vision.sheet.house_fit import HouseFit, RoughFit, fit_roughly, refine, start
from curlshot.vision.sheet.proof import is_house, stands_alone
from curlshot.vision.sheet.rings import Guess, guesses
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]

WORK_WIDTH = 640
"""Width of the picture in which hypotheses are fitted, px."""

GUESS_WIDTH = 320
"""Width of the picture in which they are made, px."""

ENOUGH = 2.8
"""A judgement at which nothing farther from the middle is tried: all of three circles, nearly."""

TWO, LESS = 2.3, 1.0
"""A judgement of what is in view at which hypotheses are not tried that were seen by so much less
than the best: two circles alone give less, and of a 4-ft circle taken for the 12-ft one there are
no more."""

ENOUGH_BESIDE = 2.5
"""The same for a house that lies just where a sheet beside has one; people stand on it."""

FAINT = 0.4
"""Least step of an edge, as a share of the usual one, where no house is found: pale paint, and
outlines that are thin in the small picture."""

BRIGHT, GREY, MOSTLY = 0.6, 0.2, 0.5
"""Least lightness of ice, as a share of a picture's brightest tenth; by what share of that its
colours differ; and how much of a picture must look so for pale paint to be looked for."""

SPACINGS = (4.7, 5.0, 4.4, 5.4, 5.8, 6.2)
"""How far apart the houses of neighbouring sheets may be, m: the width of a sheet (4.42 to 5.00 m
by the rules of World Curling) and what lies between two, within what a fit reaches."""

LEAST_NEARER = 0.05
"""By what share of the picture's width a house beside must be nearer to its middle, to the side or,
seen from beside the sheets, up or down."""

FLATTEST = np.tan(np.radians(66))
"""How far aside of the tee the camera may stand, in heights: one beside the players sees stones
from the side, and hardly any of them would be told."""

LEVEL, NEARLY_LEVEL = 0.96, 0.9
"""Foreshortening of circles from which on a camera is likely to hang over the tee, and may."""

FAR = 12.0
"""Height of a camera, m, from which on it may rather lean the other way, as where no fit comes to
a camera at all: ellipses do not tell on which side the ice is nearer, and what a fit cannot undo it
takes for a camera far away."""


def find_house(image: Image, *, frame: int = 0, t: float = 0.0) -> HouseFit | None:
    """Find the house in a picture.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    frame, t : int, float
        Index and time, s, of the picture.

    Returns
    -------
    HouseFit or None
        The most complete house, or a complete one on the sheet beside that is nearer to the
        middle of the picture; None where no house can be made out.
    """
    small, factor = _reduced(image, WORK_WIDTH)
    half, share = _reduced(small, GUESS_WIDTH)
    for least in (1.0, FAINT):
        if least < 1 and not _icy(half):
            break
        rings = guesses(half, least)
        hypotheses = [_enlarged(_enlarged(guess, 1 / share), 1 / factor) for guess in rings]
        for fitted in _rough_fits(small, factor, hypotheses):
            # The circles tell most of what is no house at once, what they cannot lines may.
            if stands_alone(small, fitted.evidence, fitted.view, fitted.rig):
                found = refine(image, fitted, factor, frame, t)
                if found is not None and _is_house(image, found):
                    return _middle_most(image, small, factor, found)
    return None


def _icy(image: Image) -> bool:
    """Whether most of a picture may be ice: as grey and nearly as bright as its brightest part."""
    blue, green, red = image[::2, ::2].astype(np.float32).transpose(2, 0, 1)
    most = np.maximum(np.maximum(blue, green), red)
    least = np.minimum(np.minimum(blue, green), red)
    bright = most > BRIGHT * np.percentile(most, 90)
    return float((bright & (most - least < GREY * most)).mean()) > MOSTLY


def _is_house(image: Image, found: HouseFit) -> bool:
    x, y, z = found.rig[POSITION]
    return bool(np.hypot(x, y) < FLATTEST * z) and is_house(
        image, found.evidence, found.view, found.rig
    )


def _middle_most(image: Image, small: Image, factor: float, found: HouseFit) -> HouseFit:
    """Give a complete house nearer to the middle on the sheet beside, where there is one."""
    for beside in _beside(small, factor, found):
        if beside.score > ENOUGH_BESIDE:
            other = refine(image, beside, factor, found.camera.frame, found.camera.t)
            if other is not None and _is_house(image, other):
                return other
    return found


def _beside(small: Image, factor: float, found: HouseFit) -> Iterator[RoughFit]:
    """Fit the houses beside the one found that are nearer to the middle of the picture."""
    size = np.array(found.camera.size)
    offsets = np.array([0.0, *(side * apart for apart in SPACINGS for side in (-1, 1))])
    centres = found.camera.project(np.stack([offsets, 0 * offsets], -1))
    ends = found.camera.project(np.stack([offsets + 0.5, 0 * offsets], -1))
    aside = np.hypot(*(centres - size / 2).T)
    nearer = aside < aside[0] - LEAST_NEARER * size[0]
    for offset, centre, end, near in zip(offsets.tolist(), centres, ends, nearer, strict=True):
        if near:
            rig = found.rig.copy()
            rig[POSITION] -= offset, 0.0, 0.0
            scale = 2 * factor * float(np.hypot(*(end - centre)))
            view = rescaled(found.view, factor)
            fitted = fit_roughly(small, view, rig, ANYWHERE, scale, float(factor * centre[0]))
            if fitted is not None:
                yield fitted


def fit_house(
    image: Image, hypotheses: Sequence[Guess], *, frame: int = 0, t: float = 0.0
) -> HouseFit | None:
    """Fit a house to a picture from hypotheses of where it is.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    hypotheses : sequence of Guess
        In px of that picture.
    frame, t : int, float
        Index and time, s, of the picture.

    Returns
    -------
    HouseFit or None
        From the hypothesis that explains most; None where the edges bear out none of them.
    """
    small, factor = _reduced(image, WORK_WIDTH)
    for fitted in _rough_fits(small, factor, hypotheses):
        found = refine(image, fitted, factor, frame, t)
        if found is not None:
            return found
    return None


def _reduced(image: Image, width: int) -> tuple[Image, float]:
    """Shrink a picture to a width, where it is wider, and say by what factor."""
    factor = min(width / image.shape[1], 1.0)
    small = cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.uint8), factor


def _enlarged(guess: Guess, factor: float) -> Guess:
    """Give the same hypothesis in a picture `factor` times as large."""
    return replace(guess, centre=(guess.centre + 0.5) * factor - 0.5, scale=guess.scale * factor)


def _ways(guess: Guess) -> tuple[Guess, ...]:
    """Ways in which a hypothesis may be seen, the likelier first: level, or tilted."""
    level = replace(guess, foreshortening=1.0, lean=0.0)
    if guess.foreshortening > LEVEL:
        return level, guess
    return (guess, level) if guess.foreshortening > NEARLY_LEVEL else (guess,)


def _from(small: Image, seen: Guess) -> RoughFit | None:
    """Fit one way in which a hypothesis may be seen."""
    there = start(seen, (small.shape[1], small.shape[0]))
    return fit_roughly(small, *there, seen.scale, float(seen.centre[0]))


def _in_view(fit: RoughFit) -> float:
    """Judge a fit as if the picture showed all of each circle of which it shows a part."""
    return fit.score + float((fit.evidence.support - fit.evidence.covered).sum())


def _rough_fits(small: Image, factor: float, hypotheses: Sequence[Guess]) -> list[RoughFit]:
    """Fit hypotheses in a small picture: what they become, that which explains most first."""
    fits: list[RoughFit] = []
    there = [_enlarged(guess, factor) for guess in hypotheses]
    aside = [abs(guess.centre[0] - small.shape[1] / 2) for guess in there]
    for k, here in enumerate(there):
        if here.score < there[0].score - LESS and any(_in_view(fit) > TWO for fit in fits):
            continue
        for seen in _ways(here):
            fitted = _from(small, seen)
            if fitted is not None:
                break
        if fitted is None or fitted.rig[POSITION][2] > FAR:
            other = _from(small, replace(here, lean=here.lean + np.pi))
            fitted = max(filter(None, (fitted, other)), key=lambda fit: fit.score, default=None)
        if fitted is not None:
            fits.append(fitted)
            if fitted.score > ENOUGH and aside[k] <= min(aside[k:]):
                break
    return sorted(fits, key=lambda fit: -fit.score)
