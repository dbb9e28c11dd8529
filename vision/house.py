"""Find the house in one picture, whatever its colours.

Hypotheses of concentric rings are fitted with a camera in a small picture and judged by how much
of the circles they explain; the best is refined at full resolution, with the lines.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE
from vision.adjust import solve
from vision.camera import Camera
from vision.lines import sides, upright
from vision.marks import Evidence, measure
from vision.outline import Rim, find_rim
from vision.picture import Image
from vision.pose import DOWN, View, aim, camera, rescaled, rotation_vector
from vision.proof import is_house, worth
from vision.rig import ANYWHERE, OVERHEAD, Prior, start_rig
from vision.rings import Guess, guesses

Array = NDArray[np.float64]

WORK_WIDTH = 640
"""Width of the picture in which hypotheses are fitted, px."""

GUESS_WIDTH = 320
"""Width of the picture in which they are made, px."""
SHARING = 20.0
"""Edge points of one frame that share an error of the paint, about 30° of a circle."""

ENOUGH = 2.8
"""A judgement at which nothing farther from the middle is tried: all of three circles, nearly."""

ASIDE = 2.0
"""What a house loses when its centre is one picture's width aside: neighbours are at the sides."""

ROUGH = 0.5
"""What a house loses per pixel of residual in the small picture."""

TILT_GAIN = 8.0
"""By how much the log likelihood must rise for a camera that does not hang over the tee."""


@dataclass(frozen=True)
class HouseFit:
    """The house in one picture.

    Attributes
    ----------
    camera : Camera
    view, rig : View, ndarray
        The camera's parts (see `vision.rig` and `vision.pose`).
    evidence : Evidence
        The marks it rests on.
    rms_px : float
    overhead : bool
        Whether it looks like a camera that hangs over the tee.
    edge : Rim
        Where the 12-ft circle ends in the profiles across it.
    """

    camera: Camera
    view: View
    rig: Array
    evidence: Evidence
    rms_px: float
    overhead: bool
    edge: Rim


def find_house(image: Image, *, frame: int = 0, t: float = 0.0) -> HouseFit | None:
    """Find the house in a picture.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)

    Returns
    -------
    HouseFit or None
        The most complete house; None where no house can be made out.
    """
    factor = min(WORK_WIDTH / image.shape[1], 1.0)
    small = _reduced(image)
    hypotheses = [_enlarged(g, 1 / factor) for g in _guesses(small)]
    for found in _fits(image, small, hypotheses, frame, t):
        if is_house(image, found.evidence, found.view, found.rig, found.camera):
            return found
    return None


def fit_house(
    image: Image, hypotheses: Sequence[Guess], *, frame: int = 0, t: float = 0.0
) -> HouseFit | None:
    """Fit a house to a picture from hypotheses of where it is, in px of that picture.

    Returns
    -------
    HouseFit or None
        From the hypothesis that explains most; None where the edges bear out none of them.
    """
    return next(_fits(image, _reduced(image), hypotheses, frame, t), None)


def _reduced(image: Image) -> Image:
    """Make the picture in which hypotheses are fitted."""
    factor = min(WORK_WIDTH / image.shape[1], 1.0)
    small = cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.uint8)


def _enlarged(guess: Guess, factor: float) -> Guess:
    """Give the same hypothesis in a picture `factor` times as large."""
    return replace(guess, centre=(guess.centre + 0.5) * factor - 0.5, scale=guess.scale * factor)


def _fits(
    image: Image, small: Image, hypotheses: Sequence[Guess], frame: int, t: float
) -> Iterator[HouseFit]:
    """Fit hypotheses: what they become, that which explains most first."""
    factor = min(WORK_WIDTH / image.shape[1], 1.0)
    fits: list[_Fitted] = []
    aside = [abs(guess.centre[0] - image.shape[1] / 2) for guess in hypotheses]
    for k, guess in enumerate(hypotheses):
        fitted = _fit(small, _enlarged(guess, factor))
        if fitted is not None:
            fits.append(fitted)
            if fitted.score > ENOUGH and aside[k] <= min(aside[k:]):
                break
    for fitted in sorted(fits, key=lambda fit: -fit.score):
        found = _refine(image, fitted, factor, frame, t)
        if found is not None:
            yield found


@dataclass(frozen=True)
class _Fitted:
    """A hypothesis after the fit, in the small picture."""

    view: View
    rig: Array
    score: float


def _fit(image: Image, guess: Guess) -> _Fitted | None:
    """Fit a camera to the circles of a small picture, starting from a hypothesis."""
    size = (image.shape[1], image.shape[0])
    view, rig, prior = start(guess, size)
    thickness = guess.scale * (HOUSE.twelve_foot - HOUSE.eight_foot)
    rms = np.nan
    for share in (0.3, 0.2, 0.15):
        reach = max(share * thickness, 3.0)
        evidence = measure(image, view.vector, rig, reach=reach, spacing=4, lines=False)
        if len(evidence.marks) < 30:
            return None
        solution = solve([evidence.marks], [view], rig, size, prior=prior, sharing=SHARING)
        view, rig, rms = solution.views[0], solution.rig, float(solution.rms[0])
    explained = worth(measure(image, view.vector, rig, reach=5.0, spacing=4, lines=False))
    aside = ASIDE * abs(guess.centre[0] / size[0] - 0.5)
    score = explained - aside - ROUGH * float(np.nan_to_num(rms, nan=9.0))
    return _Fitted(view, rig, score) if explained > 0 else None


def _guesses(image: Image) -> list[Guess]:
    """Look for rings in a picture of half the size."""
    factor = min(GUESS_WIDTH / image.shape[1], 1.0)
    small = cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    return [_enlarged(guess, 1 / factor) for guess in guesses(np.asarray(small, np.uint8))]


def start(guess: Guess, size: tuple[int, int]) -> tuple[View, Array, Prior]:
    """Give the camera over the tee or, if circles look foreshortened, one anywhere: view, rig."""
    down = guess.foreshortening
    prior = OVERHEAD if down == 1 else ANYWHERE
    position = prior.mean[2] * np.array([0.0, -np.sqrt(1 - down**2), down])
    return _aimed(guess, position, size), start_rig(prior, position), prior


def _aimed(guess: Guess, position: Array, size: tuple[int, int]) -> View:
    """View of a camera that has the tee where the guess has it, and leans as it says."""
    middle = np.array([(size[0] - 1) / 2, (size[1] - 1) / 2])
    c, s = np.cos(guess.lean), np.sin(guess.lean)
    lean = np.array([[c, s], [-s, c]])
    level = aim(middle + lean.T @ (guess.centre - middle), guess.scale, position, size)
    turn = np.eye(3)
    turn[:2, :2] = lean
    vector = rotation_vector(turn @ level.rotation @ DOWN.T)
    return View(np.append(vector, level.vector[3]))


def _refine(image: Image, best: _Fitted, factor: float, frame: int, t: float) -> HouseFit | None:
    """Fit at full resolution: the circles, then with the lines."""
    size = (image.shape[1], image.shape[0])
    view, rig = rescaled(best.view, 1 / factor), best.rig
    circles = measure(image, view.vector, rig, reach=max(4 / factor, 6.0), lines=False)
    if len(circles.marks) < 30:
        return None
    fits = {
        kind: solve([circles.marks], [view], rig, size, prior=prior, sharing=SHARING)
        for kind, prior in ((True, OVERHEAD), (False, ANYWHERE))
    }
    overhead = (fits[True].cost - fits[False].cost) / SHARING < TILT_GAIN
    view, rig = fits[overhead].views[0], fits[overhead].rig
    view, rig = upright(image, view, rig)
    rig = sides(image, view, rig)
    prior = OVERHEAD if overhead else ANYWHERE
    edge = Rim()
    for reach in (8.0, 6.0):
        evidence = measure(image, view.vector, rig, reach=reach, level=edge.level)
        if len(evidence.marks) < 30:
            return None
        fit = solve([evidence.marks], [view], rig, size, prior=prior, sharing=SHARING)
        view, rig = fit.views[0], fit.rig
        edge = find_rim(evidence.profile, evidence.step)
    rms = float(fit.rms[0])
    found = camera(view, rig, size, frame=frame, t=t, rms_px=rms)
    if worth(evidence) == 0:
        return None
    return HouseFit(found, view, rig, evidence, rms, overhead, edge)
