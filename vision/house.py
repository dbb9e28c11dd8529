"""Find the house in one picture, whatever its colours.

Hypotheses of concentric rings are fitted with a camera in a small picture and judged by how much
of the circles they explain; the best is refined at full resolution, with the lines.
"""

from __future__ import annotations

from collections.abc import Sequence
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
from vision.paint import TWELVE
from vision.picture import Image
from vision.pose import DOWN, View, aim, camera, rescaled, rotation_vector
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

WHOLE = 0.6
"""Share of what is visible of a circle that is nearly all of it, with people over it."""

UNPAINTED = ((0.72, 1.1), (1.32, 1.7), (1.95, 6.0))
"""From where to where there is no edge of a circle, m; the third holds the rings of a house of
which the 4-ft circle and the button were taken for all."""

LEAST_STEP, WHOLE_AROUND = 20.0, 0.7
"""Grey levels by which an edge stands out, and its share of a circle, for one that is there."""

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
    return _best(image, small, [_enlarged(g, 1 / factor) for g in _guesses(small)], frame, t)


def fit_house(
    image: Image, hypotheses: Sequence[Guess], *, frame: int = 0, t: float = 0.0
) -> HouseFit | None:
    """Fit a house to a picture from hypotheses of where it is, in px of that picture.

    Returns
    -------
    HouseFit or None
        From the hypothesis that explains most; None where the edges bear out none of them.
    """
    return _best(image, _reduced(image), hypotheses, frame, t)


def _reduced(image: Image) -> Image:
    """Make the picture in which hypotheses are fitted."""
    factor = min(WORK_WIDTH / image.shape[1], 1.0)
    small = cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.uint8)


def _enlarged(guess: Guess, factor: float) -> Guess:
    """Give the same hypothesis in a picture `factor` times as large."""
    return replace(guess, centre=(guess.centre + 0.5) * factor - 0.5, scale=guess.scale * factor)


def _best(
    image: Image, small: Image, hypotheses: Sequence[Guess], frame: int, t: float
) -> HouseFit | None:
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
            return found
    return None


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
    worth = judge(measure(image, view.vector, rig, reach=5.0, spacing=4, lines=False))
    aside = ASIDE * abs(guess.centre[0] / size[0] - 0.5)
    score = worth - aside - ROUGH * float(np.nan_to_num(rms, nan=9.0))
    return _Fitted(view, rig, score) if worth > 0 else None


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


def judge(evidence: Evidence) -> float:
    """How much of a house this is, up to 3.5; 0 where it is none."""
    support, covered = evidence.support, evidence.covered
    if covered[0] < 0.12 or support[0] < 0.35:
        return 0.0
    seen = evidence.visible > 0.05
    # Edges of other things rarely stand as 3 : 2; where there are but 3 : 1, they must be whole
    # and what is around them ice.
    inner = support[1] > 0.3 or (support[2] > 0.3 and not seen[1])
    ice = evidence.palette[TWELVE, 0]
    if not inner and (min(support[0], support[2]) < WHOLE or ice.min() < max(0.6 * ice.max(), 80)):
        return 0.0
    return float(covered.sum() + 0.5 * support[seen].mean())


def _is_target(image: Image, found: Camera) -> bool:
    """Whether there are whole circles where a house has none: between its own or around them."""
    angle = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    for first, last in UNPAINTED:
        radius = np.exp(np.arange(np.log(first), np.log(last), 0.01))
        place = found.project(radius[:, None, None] * way)
        seen = np.asarray(((place > 0) & (place < np.array(found.size) - 1)).all(-1))
        x, y = place.astype(np.float32).transpose(2, 0, 1)
        colour = cv2.remap(image, x, y, cv2.INTER_LINEAR).astype(float)
        within = seen[8:] & seen[:-8]
        step = (colour[8:] - colour[:-8]) * within[..., None]
        count = np.maximum(within.sum(1), 1)
        usual = step.sum(1) / count[:, None]
        square = (usual**2).sum(-1)
        alike = (step * usual[:, None]).sum(-1) > 0.5 * square[:, None]
        whole = (alike & within).sum(1) > WHOLE_AROUND * count
        if (whole & (square > LEAST_STEP**2) & (count > 0.5 * len(angle))).any():
            return True
    return False


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
    if judge(evidence) == 0 or _is_target(image, found):
        return None
    return HouseFit(found, view, rig, evidence, rms, overhead, edge)
