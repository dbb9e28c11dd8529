"""A camera fitted to the circles and lines of a house in one picture.

First to the circles alone, roughly, from a hypothesis of where the house is; then at full
resolution, with the lines, whether or not the camera hangs over the tee.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE
from curlshot.vision.optics.adjust import SHARING, Solution, solve
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.lean import fit_leaning
from curlshot.vision.optics.paint import TWELVE, Marks
from curlshot.vision.optics.pose import DOWN, View, aim, camera, rescaled, rotation_vector
from curlshot.vision.optics.resection import ROUND
from curlshot.vision.optics.rig import (
    ANYWHERE,
    BENT,
    OVERHEAD,
    POSITION,
    Prior,
    distortion,
    start_rig,
)
from curlshot.vision.sheet.hog_line import by_hog_line, may_be_in_view
from curlshot.vision.sheet.lines import lesser_side_step, sides, upright
from curlshot.vision.sheet.marks import Evidence, measure_marks
from curlshot.vision.sheet.mixing import lit
from curlshot.vision.sheet.outline import HALF_WAY, PaintEdge, find_edge
from curlshot.vision.sheet.proof import worth
from curlshot.vision.sheet.rings import Guess
from curlshot.vision.sheet.straight import LEAST, by_sides
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]

AS_WELL = 1.3
"""How many times as far off, r.m.s., the edges of a house may be that is explained as well."""

ASIDE = 2.0
"""What a house loses when its centre is one picture's width aside: neighbours are at the sides."""

ROUGH = 0.5
"""What a house loses per pixel of residual in the small picture."""

LEAST_MARKS = 30
"""Edge points without which there is no camera; three whole circles give hundreds."""

ROUNDS, SETTLED = 4, 0.1
"""How often circles are measured anew, and how well they tell half an outline's width then, px."""

TILT_GAIN = 3.0
"""By how much the log likelihood must rise for a camera that does not hang over the tee: odds of
twenty. Lens and paint can make up for 10 to 15° of tilt but for so little; in no real still from
overhead does it rise by as much."""

LENS_ROUNDS = 3
"""Fits with a wide lens: k2 is expected to go with the k1 of the fit before."""

PARTLY = 0.6
"""Share of the 12-ft circle in view below which it hardly tells to which side a camera leans: some
that do by 15° seemed to hang over the tee, or to lean the other way. Then the sheet's sides say it,
where they are straight for one of the two, and later frames."""

USUAL = 2.0
"""How far from where cameras hang over a tee one may be to be one of them, standard deviations."""


@dataclass(frozen=True)
class HouseFit:
    """The house in one picture.

    Attributes
    ----------
    camera : Camera
    view, rig : View, ndarray
        The camera's parts (see `curlshot.vision.optics.rig` and `curlshot.vision.optics.pose`).
    evidence : Evidence
        The marks it rests on.
    rms_px : float
    prior : Prior
        What was known of the rig beforehand.
    edge : PaintEdge
        Where the circles are in the profiles across them.
    vague : bool
        Whether circles and the sheet's sides tell at best roughly how the camera leans.
    """

    camera: Camera
    view: View
    rig: Array
    evidence: Evidence
    rms_px: float
    prior: Prior
    edge: PaintEdge
    vague: bool = False


@dataclass(frozen=True)
class RoughFit:
    """A hypothesis after the fit, in the small picture, and the circles there."""

    view: View
    rig: Array
    score: float
    evidence: Evidence


def fit_roughly(
    image: Image, view: View, rig: Array, prior: Prior, scale: float, centre: float
) -> RoughFit | None:
    """Fit a camera to the circles of a small picture.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    view, rig, prior : View, ndarray, Prior
        Where to begin, and what is known of the rig.
    scale : float
        Size of the house, px per m.
    centre : float
        Where its middle is, px from the picture's left.

    Returns
    -------
    RoughFit or None
        None where the edges do not bear it out.
    """
    size = (image.shape[1], image.shape[0])
    thickness = scale * (HOUSE.twelve_foot - HOUSE.eight_foot)
    rms = np.nan
    for k, share in enumerate((0.3, 0.2, 0.15)):
        reach = max(share * thickness, 3.0)
        evidence = measure_marks(image, view.vector, rig, reach=reach, spacing=4, lines=False)
        # Rings without any of a 12-ft circle once they were fitted are no house, and most are such.
        if len(evidence.marks) < LEAST_MARKS or (k > 0 and evidence.covered[TWELVE] == 0):
            return None
        solution = solve([evidence.marks], [view], rig, size, prior=prior, view_sd=ROUND)
        view, rig, rms = solution.views[0], solution.rig, float(solution.rms[0])
    evidence = measure_marks(image, view.vector, rig, reach=5.0, spacing=4, lines=False)
    explained = worth(evidence)
    aside = ASIDE * abs(centre / size[0] - 0.5)
    score = explained - aside - ROUGH * float(np.nan_to_num(rms, nan=9.0))
    return RoughFit(view, rig, score, evidence) if explained > 0 else None


def at_height(fit: HouseFit, prior: Prior) -> tuple[View, Array]:
    """Begin from a camera of a house that hangs as high as its prior says: view and rig.

    Where it explains the house as well: from far away a fit may come to rest on the way.
    """
    zoom, rig = float(prior.mean[POSITION][2] / fit.rig[POSITION][2]), fit.rig.copy()
    rig[POSITION] *= zoom  # along the line to the tee: the house stays about as it is
    view = View(fit.view.vector + np.array([0.0, 0.0, 0.0, np.log(zoom)]))
    size = fit.camera.size
    near = solve([fit.evidence.marks], [view], rig, size, prior=prior)
    if float(near.rms[0]) > AS_WELL * fit.rms_px:
        return fit.view, fit.rig
    return near.views[0], near.rig


def start(guess: Guess, size: tuple[int, int]) -> tuple[View, Array, Prior]:
    """Start over the tee or, if circles look foreshortened, anywhere: view, rig and its prior."""
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


def _with_wide_lens(
    circles: Marks, anywhere: Solution, size: tuple[int, int]
) -> tuple[Solution, Prior] | None:
    """Fit a camera with a wide lens, and give its prior; None where a usual one explains more."""
    fit, prior = anywhere, ANYWHERE
    for _ in range(LENS_ROUNDS):
        view = fit.views[0]
        k1, _ = distortion(fit.rig, float(view.vector[3]), size)
        prior = prior.wide(k1)
        fit = solve([circles], [view], fit.rig, size, prior=prior, view_sd=ROUND)
    k1, _ = distortion(fit.rig, float(fit.views[0].vector[3]), size)
    return (fit, prior) if k1 < BENT and fit.cost < anywhere.cost else None


def refine(image: Image, best: RoughFit, factor: float, frame: int, t: float) -> HouseFit | None:
    """Fit at full resolution: the circles, then with the lines.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    best : RoughFit
        In a picture `factor` times as large.
    factor : float
    frame, t : int, float
        Index and time, s, of the picture.

    Returns
    -------
    HouseFit or None
        None where the edges do not bear it out.
    """
    size = (image.shape[1], image.shape[0])
    view, rig = rescaled(best.view, 1 / factor), best.rig
    circles = measure_marks(image, view.vector, rig, reach=max(4 / factor, 6.0), lines=False)
    if len(circles.marks) < LEAST_MARKS:
        return None

    over = solve([circles.marks], [view], rig, size, prior=OVERHEAD, view_sd=ROUND)
    anywhere = fit_leaning([circles.marks], [view], rig, size, view_sd=ROUND, iterations=12)
    overhead = (over.cost - anywhere.cost) / SHARING < TILT_GAIN
    fit = over if overhead else anywhere
    wide = None if overhead else _with_wide_lens(circles.marks, anywhere, size)
    if wide is not None:
        fit = wide[0]
    view, rig = upright(image, fit.views[0], fit.rig)
    partly = bool(circles.visible[TWELVE] < PARTLY)
    vague = partly and lesser_side_step(image, view, rig) < LEAST
    if vague:
        straight = by_sides(image, circles.marks, anywhere, TILT_GAIN * SHARING)
        if straight is not None:
            view, rig = straight
            off = (rig - OVERHEAD.mean)[POSITION] / OVERHEAD.sd[POSITION]
            overhead = bool(np.abs(off).max() < USUAL)
    prior = OVERHEAD if overhead else ANYWHERE
    if not vague and may_be_in_view(view, rig, size):
        circles = measure_marks(image, view.vector, rig, reach=6.0, lines=False)
        told = by_hog_line(image, circles.marks, view, rig, prior)
        if told is not None:
            view, rig, prior, wide = told.view, told.rig, told.prior, None
    if wide is not None and prior is ANYWHERE:
        prior = wide[1]
    rig = sides(image, view, rig)
    edge = HALF_WAY
    for reach in (8.0, *ROUNDS * (6.0,)):
        evidence = measure_marks(image, view.vector, rig, reach=reach + edge.reach, edge=edge)
        if len(evidence.marks) < LEAST_MARKS:
            return None
        fit = solve([evidence.marks], [view], rig, size, prior=prior)
        view, rig = fit.views[0], fit.rig
        if any(edge.light):
            break
        before, edge = edge, find_edge(evidence.profile, evidence.step)
        if reach < 8.0 and abs(edge.within - before.within) < SETTLED:
            edge = lit(edge, image, view, rig, evidence)
            if not any(edge.light):
                break
    rms = float(fit.rms[0])
    found = camera(view, rig, size, frame=frame, t=t, rms_px=rms)
    if worth(evidence) == 0:
        return None
    return HouseFit(found, view, rig, evidence, rms, prior, edge, vague)
