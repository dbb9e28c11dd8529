"""The cameras of a clip, from what its frames have measured.

What the frames share is fitted to some of them (`curlshot.vision.optics.bundle`), then every view
with that held. Each camera says how well it is known: by its own marks, and by what all frames
share.

Assumed: the principal point is the middle of the picture, pixels are square, the camera stays
where it is or moves slowly, and the 12-ft circle has its nominal radius.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE
from curlshot.vision.camera_path.keyframe import Keyframe, replaced
from curlshot.vision.camera_path.shutter import LEAST_SMEAR
from curlshot.vision.optics.astray import astray, motion
from curlshot.vision.optics.bundle import LOST, NOISE_TRUST, bundle
from curlshot.vision.optics.camera import Camera, CameraError
from curlshot.vision.optics.lean import fit_leaning
from curlshot.vision.optics.linear import (
    Linear,
    Observations,
    by_measure,
    by_rig,
    linearised,
    view_equations,
)
from curlshot.vision.optics.paint import CIRCLES, FIXED, MEASURED, Marks, joined
from curlshot.vision.optics.pose import VIEW_SIZE, View, camera, turning
from curlshot.vision.optics.projection import PARAMETERS
from curlshot.vision.optics.quality import ARC, edges_off, quality, warnings
from curlshot.vision.optics.resection import solve_views
from curlshot.vision.optics.rig import (
    K1,
    K1_BEND,
    K1_ZOOM,
    K2,
    POSITION,
    R4,
    R8,
    RIG_SIZE,
    SURELY_BENT,
    Prior,
    distortion,
    zoom,
)
from curlshot.vision.optics.robust import WIDTH, inverse
from curlshot.vision.optics.shared import Bundle, family, piece_of, sensitivity
from curlshot.vision.sheet.outline import HALF_WAY, PaintEdge
from curlshot.vision.video.disk_cache import Cached

Array = NDArray[np.float64]
Index = NDArray[np.int64]

JOINT_FRAMES = 12
"""Frames to which the shared part is fitted."""

TOGETHER = 32
"""Most frames whose views are fitted in one go; one left alone would seem to stand still."""

FROM_PROVISIONAL_SD = (np.inf, np.inf, 0.05, np.inf)
"""How far a view may lie from the provisional one: the roll is free where no line is seen."""

LONG_RANGE = 1.4
"""Errors of paint, and what compression does to edges, are alike over longer stretches than single
pieces and marks tell: so much larger than these say are the standard errors, as clips with truth
show."""


LENS_ROUNDS = 2
"""Fits with a wide lens, if it is one: k2 is expected to go with the k1 of the fit before."""

RAGGED = 0.002
"""How ragged circles are from which on the camera may lean to another side than it was thought to,
m: with cameras that did they were learned to be so by 3.6 to 5 mm, with others by 0.2 to 1.4."""

UNPLACED = 0.02
"""How unsure it is where a line lies, m, from which on it tells nothing of a view: no frame of the
joint fit shows it, and rules say where its middle is, about."""

CROPPED = 5.0
"""By how much more they are larger in pictures that seem to be cropped or stretched, whose places
were 3 to 9 of their errors off."""


@dataclass(frozen=True)
class HouseTrack:
    """The cameras of a clip.

    Attributes
    ----------
    cameras : tuple of Camera
        One per frame in which the house is known, in order; found is False where carried.
    radii : ndarray, shape (3,)
        Radii of the painted 12-, 8- and 4-ft edges, m; the first is the yardstick.
    position_sd : ndarray, shape (3,)
        Standard deviation of the camera's place, m; of a moving one's mean place.
    warnings : tuple of str
    """

    cameras: tuple[Camera, ...]
    radii: Array
    position_sd: Array
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Seen:
    """One followed frame.

    Attributes
    ----------
    index, t : int, float
        Index in the clip and time, s.
    view : View
        Provisional.
    marks : Cached of Marks
        What was measured in it.
    found : bool
        Whether its circles fix its view; else it is carried by fixed points of the ice.
    key : Keyframe, optional
        Where its fixed points are known from, if there are any.
    smeared : float
        How far a pan smears its edges, px.
    share : float
        Of light in what the shutter blurs, with which they were measured, and `by_light` how far
        all of it would move them, (n,), px; None where nothing is smeared.
    """

    index: int
    t: float
    view: View
    marks: Cached[Marks]
    found: bool
    key: Keyframe | None = None
    smeared: float = 0.0
    share: float = 0.0
    by_light: Array | None = None


def fit_clip(
    seen: Sequence[Seen],
    rig: Array,
    prior: Prior,
    size: tuple[int, int],
    edge: PaintEdge = HALF_WAY,
) -> HouseTrack:
    """Fit the cameras of a clip.

    Parameters
    ----------
    seen : sequence of Seen
        The frames in order, at least one of them found.
    rig : ndarray, shape (15,)
        Start values of what they share.
    prior : Prior
    size : tuple of int
        Width and height of the picture, px.
    edge : PaintEdge
        The outer edge of the 12-ft circle: as well as it is made out, all lengths are known.
    """
    chosen = spread([s for s in seen if s.found], JOINT_FRAMES)
    times = [s.t for s in chosen]
    marks, views = [s.marks.get() for s in chosen], [s.view for s in chosen]
    shared, _ = bundle(marks, times, views, rig, size, prior)
    for _ in range(LENS_ROUNDS):
        k1, _ = distortion(shared.rig, float(views[-1].vector[3]), size)
        if k1 > SURELY_BENT:
            break
        prior = prior.wide(k1)
        shared, _ = bundle(marks, times, views, shared.rig, size, prior)
    if shared.ragged > RAGGED:
        anywhere = prior.anywhere()
        lean = fit_leaning(marks, views, shared.rig, size, prior=anywhere)
        other, _ = bundle(marks, times, lean.views, lean.rig, size, anywhere)
        if other.ragged < shared.ragged / 2:
            shared, prior = other, anywhere
    cameras = _cameras(seen, shared, size, edge.sd)
    sd = _spread_of(shared) * np.sqrt(np.diag(shared.cov)[:RIG_SIZE])
    place, scale = shared.rig[POSITION], _scale_sd(chosen[-1].view, shared.rig, edge.sd)
    sd[POSITION] = np.hypot(sd[POSITION], scale * place)
    lined = any(_shows_a_line(s.marks.get()) for s in seen)
    return HouseTrack(
        tuple(cameras),
        np.array([HOUSE.twelve_foot, *shared.rig[[R8, R4]]]),
        sd[POSITION],
        warnings(cameras, float(place[2]), float(sd[2]), prior, lined, shared.cropped),
    )


def _cameras(
    seen: Sequence[Seen], shared: Bundle, size: tuple[int, int], edge_sd: float
) -> list[Camera]:
    """Fit all frames; what is known from a keyframe is placed by that one's final camera."""
    done: dict[int, Camera] = {}
    ready, waiting = [s for s in seen if s.key is None], [s for s in seen if s.key is not None]
    while ready:
        cameras: list[Camera] = []
        moved: list[float] = []
        for part in np.array_split(np.arange(len(ready)), math.ceil(len(ready) / TOGETHER)):
            fresh = [ready[k] for k in part]
            known = [_carried(s, s.key, done[s.key.frame]) if s.key else s for s in fresh]
            fitted, motions = _fit_frames(known, shared, size, edge_sd)
            cameras += fitted
            moved += motions.tolist()
        done.update({camera.frame: camera for camera in _put_aside(cameras, np.array(moved))})
        ready = [s for s in waiting if s.key is not None and s.key.frame in done]
        waiting = [s for s in waiting if s.key is not None and s.key.frame not in done]
    return [done[s.index] for s in seen if s.index in done]


def _carried(seen: Seen, key: Keyframe, by: Camera) -> Seen:
    """Give a frame that is carried by a keyframe the places that its camera tells, with errors."""
    marks = replaced(seen.marks.get(), key, by)
    if by.error is None or marks.across is None:
        return replace(seen, marks=Cached(marks))
    known = marks.line == FIXED
    ice = np.stack([marks.along[known], marks.across[known]], axis=-1)
    own = by.own_place_cov(ice)
    square = float(np.trace(own, axis1=-2, axis2=-1).mean()) / 2
    drift = float(np.hypot(np.sqrt(square), by.error.drift))
    return replace(seen, marks=Cached(marks), key=replace(key, drift=drift))


def _put_aside(cameras: Sequence[Camera], moved: Array) -> list[Camera]:
    """Add to the errors of cameras what a film may put their pictures aside; see `astray`."""
    found = []
    for one, aside in zip(
        cameras, astray(moved, np.array([c.rms_px for c in cameras])), strict=True
    ):
        assert one.error is not None
        own = one.error.own.copy()
        own[[0, 1], [0, 1]] += (aside / one.f_px) ** 2
        found.append(replace(one, error=replace(one.error, own=own)))
    return found


def _fit_frames(
    seen: Sequence[Seen], shared: Bundle, size: tuple[int, int], edge_sd: float
) -> tuple[list[Camera], Array]:
    """Fit the views of a few frames together, with what all frames share held.

    `edge_sd` is the standard error of the 12-ft circle's edge, px.

    Returns
    -------
    cameras : list of Camera
        With their errors, but for what a film puts whole pictures aside.
    moved : ndarray, shape (frames,)
        How far the edges move from one frame to the next, px.
    """
    each = [_on_known(s.marks.get(), shared) for s in seen]
    marks = joined(each)
    marks = replace(marks, sd=marks.sd * shared.noise[family(marks.line)])
    offset, piece = shared.offsets(marks)
    observed = Observations(marks, size, offset, [len(m) for m in each])
    times = np.array([s.t for s in seen])
    away = shared.moved(times)
    observed.foot -= observed.each(away.T)
    fits = solve_views(observed, [s.view for s in seen], shared.rig, view_sd=FROM_PROVISIONAL_SD)
    views = np.array([fit.view.vector for fit in fits])
    at = linearised(observed, observed.points(shared.rig), views, shared.rig)
    moved = motion(observed, at, views, away, np.array([s.index for s in seen]))
    common, own = _covariances(observed, at, views, piece, shared, times)
    identity, on_circle = piece_of(marks, ARC), marks.line < CIRCLES
    rigs = _rigs(shared, times)
    found = []
    for k, (s, fit, part, rig) in enumerate(zip(seen, fits, observed.parts, rigs, strict=True)):
        error = CameraError(
            common[k].copy(),
            own[k].copy(),
            _scale_sd(fit.view, rig, edge_sd),
            0.0 if s.key is None else s.key.drift,
        )
        good = fit.inliers & on_circle[part]
        pixel, on = _pixel(fit.view, rig), np.arange(part.start, part.stop)[good]
        sd = pixel * marks.sd[on]
        off = edges_off(sd * at.residual[on], offset[on], sd) if s.found else math.nan
        found.append(
            camera(
                fit.view, rig, size, frame=s.index, t=s.t, found=s.found, error=error,
                rms_px=fit.rms if s.found else math.nan,
                quality=quality(identity[part][good], off, fit.view, rig, size),
            )
        )  # fmt: skip
    return found, moved


def _covariances(
    observed: Observations, at: Linear, views: Array, piece: Index, shared: Bundle, times: Array
) -> tuple[Array, Array]:
    """Covariances of the parameters of cameras, each of shape (frames, 9, 9).

    Parameters
    ----------
    observed, at : Observations, Linear
        The marks, and their residuals in the end.
    views : ndarray, shape (frames, 4)
        As they were fitted.
    piece : ndarray of int, shape (n,)
        Which of the shared offsets is that of the paint under each mark; −1 for none.
    shared : Bundle
    times : ndarray, shape (frames,)
        s.

    Returns
    -------
    common, own : ndarray
        By the errors of what all frames share, with which the views go; by those of a frame's own
        marks.
    """
    weight = 1 / (1 + (at.residual / WIDTH) ** 2)
    # A frame may be noisier than most: fewer marks, people, blur.
    square = observed.summed(weight * at.residual**2) / LOST
    free = np.maximum(observed.summed(weight) - VIEW_SIZE, 0.0)
    noisier = (NOISE_TRUST + square) / (NOISE_TRUST + free)
    # Linearised at the same place as the rest: else errors would not cancel.
    normals, _ = view_equations(observed, at, weight)
    covs = inverse(normals + np.diag(1 / np.square(FROM_PROVISIONAL_SD)))
    by_view, by_shared = at.by_view * weight, by_rig(observed, at, views)
    by_offset, count = by_measure(observed, at), RIG_SIZE + len(shared.pieces)
    view_and_rig = np.zeros((len(times), VIEW_SIZE + RIG_SIZE, count))  # by rig and offsets
    view_and_rig[:, VIEW_SIZE:] = np.eye(RIG_SIZE, count)
    for follows, part, cov in zip(view_and_rig, observed.parts, covs, strict=True):
        follows[:VIEW_SIZE] = sensitivity(
            by_view[:, part], by_shared[:, part], by_offset[part], cov, piece[part], count
        )
    each = zip(views, _rigs(shared, times), strict=True)
    by_both = np.array([_parameters(view, rig, observed.size) for view, rig in each])
    common = _spread_of(shared) ** 2 * shared.covariances(by_both @ view_and_rig, times)
    own = by_both[..., :VIEW_SIZE]
    own = _spread_of(shared) ** 2 * noisier[:, None, None] * own @ covs @ np.swapaxes(own, 1, 2)
    return common, own


def _rigs(shared: Bundle, times: Array) -> Array:
    """Give what frames share as it is at these times, shape (frames, 15): the camera may travel."""
    rigs = np.tile(shared.rig, (len(times), 1))
    rigs[:, POSITION] += shared.moved(times)
    return rigs


def _on_known(marks: Marks, shared: Bundle) -> Marks:
    """Give the marks on lines of which it is known where they are on the ice."""
    sd = np.append(np.sqrt(np.diag(shared.cov)[:RIG_SIZE]), 0.0)[MEASURED]
    return marks.pick(np.flatnonzero(sd[marks.line] < UNPLACED))


def _spread_of(shared: Bundle) -> float:
    """By how much errors are larger than marks tell."""
    return LONG_RANGE * CROPPED if shared.cropped else LONG_RANGE


def _scale_sd(view: View, rig: Array, edge_sd: float) -> float:
    """Tell how well all lengths are known, as shares: as well as the 12-ft circle's radius."""
    return edge_sd * _pixel(view, rig) / HOUSE.twelve_foot


def _pixel(view: View, rig: Array) -> float:
    """Length of a pixel at the tee, across the view, m."""
    return float(np.linalg.norm(rig[POSITION])) / view.focal


def _parameters(view: Array, rig: Array, size: tuple[int, int]) -> Array:
    """Change of a camera's parameters by view and rig, shape (9, 4 + 15)."""
    found = np.zeros((PARAMETERS, VIEW_SIZE + RIG_SIZE))
    found[:3, :3] = turning(view)
    found[3, 3] = 1.0
    found[4:7, VIEW_SIZE:][:, POSITION] = np.eye(3)
    z = zoom(view[3], size)
    found[7, 3] = rig[K1_ZOOM] + 2 * z * rig[K1_BEND]
    found[7, VIEW_SIZE + np.array([K1, K1_ZOOM, K1_BEND])] = 1.0, z, z * z
    found[8, VIEW_SIZE + K2] = 1.0
    return found


def _shows_a_line(marks: Marks) -> bool:
    return bool(((marks.line >= CIRCLES) & (marks.line != FIXED)).any())


def spread(seen: Sequence[Seen], count: int) -> list[Seen]:
    """Give some frames spread over all of them.

    Where a smeared edge lies depends on what the shutter blurs, light or codes, which is told
    beside a house that was sharp. Of one that comes into view in a pan those that no pan smears
    are given, if there are as many.
    """
    sharp = [s for s in seen if s.smeared < LEAST_SMEAR]
    if seen[0].smeared >= LEAST_SMEAR and len(sharp) >= count:
        seen = sharp
    at = np.unique(np.round(np.linspace(0, len(seen) - 1, count)).astype(int))
    return [seen[i] for i in at]
