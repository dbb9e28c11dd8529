"""Follow the house through a clip: one camera place, pan, tilt, roll and zoom per frame.

The house is found once. From then on each frame is predicted, its edges are measured along
their normals and the view is refined. Where that fails, the picture before is recognised in it,
and last the house is found anew. What all frames share is fitted when the clip has been read.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from data.errors import SceneError
from data.progress import Progress, no_progress
from data.sheet import HOUSE
from vision.adjust import ViewSolution, solve, solve_view
from vision.camera import Camera
from vision.clip import Clip, Frame
from vision.house import SHARING, HouseFit, find_house
from vision.joint import HouseTrack, Seen, fit_clip
from vision.landmarks import Keyframe, keyframe, recognise
from vision.marks import Evidence, measure_along
from vision.normals import Normals, lay_out
from vision.outline import Rim
from vision.paint import CIRCLES, joined
from vision.picture import Picture, image_of
from vision.placed import Placed, nobody
from vision.pose import View, camera
from vision.replay import EVERY, Glimpse, glimpse, is_nearer, is_replay
from vision.rig import ANYWHERE, OVERHEAD, R4, R8, Prior

Array = NDArray[np.float64]

FIND_EVERY, FIND_RARELY = 5, 15
"""Frames from one attempt to find the house to the next: one more after each failure, till the
second. What is found then is followed back through the frames kept."""

LOOK_BACK = 30
"""Frames kept while the house has not been found, to be followed backwards from the first find."""

PATIENCE = 12
"""Frames in a row that may fail before following gives up and only finding is left."""

MOST_NORMALS = 48
"""Normals on each circle."""

REACH, LEAST_REACH = 0.007, 6.0
"""Half length of the normals in widths of the picture, and the least, px."""

MARK_SD = 0.2
"""Least standard deviation of a mark, px."""

WIDTH = 6.0
"""Width of the robust loss, in standard deviations, while the shared part is provisional."""

SETTLED = 0.4
"""Correction below which the edges need not be measured anew, half lengths of the normals."""

LEAST_ARC = 1.2
"""Length of circle that must be seen to fix a view, m."""

LEAST_SUPPORT = 0.3
"""Of the circles that are in the picture, this part must be seen."""

LEARNING = 0.1
"""How fast the colours of the edges are learned anew."""

REFINE_AT = (8, 40, 160)
"""Numbers of frames at which what they share is fitted anew on the way."""

REFINE_FRAMES = 6

FREE = (np.inf, np.inf, 0.02, np.inf)
"""How far a view may be turned from its prediction: the roll is free where no line is seen."""

MOST_DRIFT = 0.25
"""A view carried so far astray is given up, m."""

SAME_RMS_PX = 0.3
"""How much worse another piece's camera may explain a house that it shows as well, px."""


@dataclass
class _Piece:
    """Frames of one camera, and what was found of it first."""

    rig: Array
    prior: Prior
    palette: Array
    edge: Rim
    seen: list[Seen] = field(default_factory=list)
    picture: Picture | None = None
    cov: Array = field(default_factory=lambda: np.zeros((4, 4)))
    key: Keyframe | None = None
    normals: Normals | None = None
    lost: int = 0
    glimpses: list[Glimpse] = field(default_factory=list)

    @property
    def found(self) -> int:
        """Number of frames that fixed their camera themselves."""
        return sum(s.found for s in self.seen)


class HouseFollower:
    """Follows the house frame by frame, in one pass.

    Parameters
    ----------
    size : tuple of int
        Width and height of the pictures, px.
    first : HouseFit, optional
        The house in the frame of its camera: what shows that one is the shot. Else it is looked
        for, and the longest piece is the shot.
    """

    def __init__(self, size: tuple[int, int], first: HouseFit | None = None) -> None:
        self._size = size
        self._first = first
        self._pieces: list[_Piece] = []
        self._piece: _Piece | None = None
        self._waiting: deque[Frame] = deque(maxlen=LOOK_BACK)
        self._between = FIND_EVERY
        self._since_find = FIND_EVERY

    def look(self, frame: Frame) -> Sequence[tuple[Frame, Camera]]:
        """Place one more frame.

        Returns
        -------
        sequence of (Frame, Camera)
            Frames placed thereby, in order, with provisional cameras: as a rule this one;
            after a find also those before it; none where no house is seen.
        """
        piece = self._piece
        if piece is not None:
            seen = _next(piece, frame)
            if seen is not None and piece.lost and self._is_elsewhere(piece, seen, frame):
                seen, piece.lost = None, PATIENCE
            if seen is not None:
                _add(piece, seen, frame.picture)
                _remember(piece, seen, frame.picture)
                _refine(piece, self._size)
                self._waiting.clear()
                return [(frame, self._provisional(piece, seen))]
            piece.lost += 1
            if piece.lost == 1:
                self._since_find = self._between = FIND_EVERY
            if piece.lost > PATIENCE:
                self._piece = None
        house = self._find(frame)
        if house is not None:
            return self._start(frame, house)
        self._waiting.append(frame)
        return []

    def _is_elsewhere(self, piece: _Piece, seen: Seen, frame: Frame) -> bool:
        """Whether a frame after a cut is a replay, or goes on with what was before a replay."""
        now = glimpse(frame.picture, seen.view, piece.rig, frame.t)
        others = [p.glimpses[-1] for p in self._pieces if p is not piece and p.glimpses]
        return is_replay(now, piece.glimpses) or (
            bool(piece.glimpses) and is_nearer(now, others, piece.glimpses[-1])
        )

    def _find(self, frame: Frame) -> HouseFit | None:
        """Look for the house, now and then; the first is the one given, if one is."""
        if self._first is not None and not self._pieces:
            return self._first if frame.index == self._first.camera.frame else None
        self._since_find += 1
        if self._since_find < self._between:
            return None
        self._since_find, self._between = 0, min(self._between + 1, FIND_RARELY)
        # Not the frame's own picture in colour: that would be kept as long as the frame.
        return find_house(image_of(frame.picture), frame=frame.index, t=frame.t)

    def finish(self) -> HouseTrack | None:
        """Fit what all frames of the shot share; None where no house was seen."""
        pieces = [p for p in self._pieces if p.found]
        if not pieces:
            return None
        if self._first is None:
            best, which = max(pieces, key=lambda p: p.found), "the longest"
        else:
            best, which = pieces[0], "the one given"
        track = fit_clip(best.seen, best.rig, best.prior, self._size)
        return replace(track, warnings=(*_left_out(best, pieces, which), *track.warnings))

    def _provisional(self, piece: _Piece, seen: Seen) -> Camera:
        return camera(
            seen.view, piece.rig, self._size, frame=seen.index, t=seen.t, found=seen.found
        )

    def _start(self, frame: Frame, house: HouseFit) -> list[tuple[Frame, Camera]]:
        """Begin a piece, or go on with one that shows the same; then follow it back."""
        piece, view = self._same(house, frame)
        if piece is None:
            prior = OVERHEAD if house.overhead else ANYWHERE
            piece, view = _Piece(house.rig, prior, house.evidence.palette, house.edge), house.view
            self._pieces.append(piece)
        self._piece, piece.lost, piece.key = piece, 0, None
        before, piece.seen = piece.seen, []
        first = _settle(piece, frame, view)
        if first is None:
            first = Seen(frame.index, frame.t, view, house.evidence.marks, True)
        _add(piece, first, frame.picture)
        placed = [(frame, first)]
        for earlier in reversed(self._waiting):
            seen = _next(piece, earlier)
            if seen is None:
                break
            _add(piece, seen, earlier.picture)
            placed.append((earlier, seen))
        self._waiting.clear()
        placed.reverse()
        piece.seen = [*before, *(seen for _, seen in placed)]
        piece.picture, piece.key = frame.picture, None
        return [(f, self._provisional(piece, s)) for f, s in placed]

    def _same(self, house: HouseFit, frame: Frame) -> tuple[_Piece | None, View]:
        """Find the piece whose camera explains a house as well, and its view in this frame.

        What that piece showed long before it was cut is shown again; it does not go on.
        """
        marks = house.evidence.marks
        now = glimpse(frame.picture, house.view, house.rig, frame.t)
        for piece in self._pieces:
            if not _alike(piece.palette, house.evidence.palette):
                continue
            if is_replay(now, piece.glimpses):
                continue
            view = solve_view(marks, house.view, piece.rig, self._size, width=1e3, iterations=30)
            fit = solve_view(marks, view.view, piece.rig, self._size)
            enough = fit.inliers.sum() > 0.8 * len(marks)
            if enough and fit.rms < 1.3 * house.rms_px + SAME_RMS_PX:
                return piece, fit.view
        return None, house.view


def follow_house(
    clip: Clip,
    progress: Progress = no_progress,
    first: HouseFit | None = None,
    placed: Placed = nobody,
) -> HouseTrack:
    """Follow the house through a clip.

    Parameters
    ----------
    clip : Clip
        Read once, in order; a single picture is a clip of one frame.
    progress : Progress
    first : HouseFit, optional
        As for `HouseFollower`.
    placed : Placed
        Told of each frame that has a camera, and of the camera as it is known by then.

    Raises
    ------
    SceneError
        No house can be made out in any frame.
    """
    follower = HouseFollower(clip.size, first)
    for count, frame in enumerate(clip):
        progress("house", count + 1, clip.expected)
        for seen, provisional in follower.look(frame):
            placed(seen, provisional)
    progress("camera", 0, 1)
    track = follower.finish()
    progress("camera", 1, 1)
    if track is None:
        raise SceneError(
            f"{clip.files[0]}: no house in view; point at it with --house, or for another scene"
            " with a still camera use --stick X1,Y1,X2,Y2,METRES"
        )
    return track


def _add(piece: _Piece, seen: Seen, picture: Picture) -> None:
    piece.seen.append(seen)
    piece.picture, piece.lost = picture, 0


def _remember(piece: _Piece, seen: Seen, picture: Picture) -> None:
    """Keep now and then what the house looks like."""
    if seen.found and (not piece.glimpses or seen.t - piece.glimpses[-1].t > EVERY):
        piece.glimpses.append(glimpse(picture, seen.view, piece.rig, seen.t))


def _next(piece: _Piece, frame: Frame) -> Seen | None:
    """Follow into one more frame; None where the house is not to be seen, nor its ice."""
    last = piece.seen[-1]
    seen = _settle(piece, frame, _predicted(piece, frame))
    if seen is not None:
        piece.key = None
        return seen
    if piece.key is None and piece.picture is not None:
        piece.key = keyframe(last.index, piece.picture, last.view, piece.rig, piece.cov)
    if piece.key is None or piece.key.drift > MOST_DRIFT:
        return None
    landmarks = recognise(piece.key, frame.picture, last.view, piece.rig)
    if landmarks is None:
        return None
    size = (frame.picture.shape[1], frame.picture.shape[0])
    view = solve_view(
        landmarks, last.view, piece.rig, size, width=10.0, view_sd=np.full(4, np.inf)
    ).view
    seen = _settle(piece, frame, view)
    if seen is not None:
        piece.key = None
        return seen
    lines = _look(piece, frame.picture, _normals(piece, frame.picture, view)).marks
    marks = joined([landmarks, lines.pick(lines.line >= CIRCLES)])
    fit = solve_view(marks, view, piece.rig, size, view_sd=(1, 1, 0.02, 0.1))
    key = piece.key
    if len(landmarks) < len(key.ice):  # half of its corners are gone: two marks each
        piece.key = keyframe(frame.index, frame.picture, fit.view, piece.rig, fit.cov, key.drift)
    return Seen(frame.index, frame.t, fit.view, marks, False, key)


def _predicted(piece: _Piece, frame: Frame) -> View:
    """View at constant velocity."""
    last = piece.seen[-1]
    if len(piece.seen) < 2 or not (last.found and piece.seen[-2].found):
        return last.view
    before = piece.seen[-2]
    if abs(last.index - before.index) > 2:
        return last.view
    ahead = (frame.t - last.t) / (last.t - before.t)
    if not 0 < ahead < 3:
        return last.view
    return View(last.view.vector + ahead * (last.view.vector - before.view.vector))


def _normals(piece: _Piece, picture: Picture, view: View) -> Normals:
    """Give the normals for a view: those of the frame before, if they have not moved far."""
    size = (picture.shape[1], picture.shape[0])
    normals = piece.normals and piece.normals.moved(view.vector, piece.rig, size)
    if normals is None:
        reach = max(REACH * size[0], LEAST_REACH)
        normals = lay_out(view.vector, piece.rig, size, reach=reach, most=MOST_NORMALS)
        piece.normals = normals
    return normals


def _look(piece: _Piece, picture: Picture, normals: Normals) -> Evidence:
    return measure_along(
        picture, normals, least_sd=MARK_SD, palette=piece.palette, level=piece.edge.level
    )


def _settle(piece: _Piece, frame: Frame, view: View) -> Seen | None:
    """Refine a predicted view on the rings; None where they are not there."""
    size = (frame.picture.shape[1], frame.picture.shape[0])
    for _ in range(3):
        normals = _normals(piece, frame.picture, view)
        if not _enough(piece.rig, normals.visible, normals.visible):
            return None
        evidence = _look(piece, frame.picture, normals)
        if not _enough(piece.rig, evidence.visible, evidence.covered):
            return None
        fit = solve_view(
            evidence.marks, view, piece.rig, size, view_sd=FREE, width=WIDTH, iterations=6
        )
        shift = np.abs(fit.view.vector - view.vector)
        view = fit.view
        if shift[:3].max() * view.focal < SETTLED * REACH * size[0]:
            break
    if not _enough(piece.rig, evidence.visible, _explained(evidence, fit)):
        return None
    known = np.isfinite(piece.palette)
    new = np.isfinite(evidence.palette)
    mixed = (1 - LEARNING) * piece.palette + LEARNING * evidence.palette
    piece.palette = np.where(known & new, mixed, np.where(known, piece.palette, evidence.palette))
    piece.cov = fit.cov
    return Seen(frame.index, frame.t, view, evidence.marks.pick(fit.inliers), True)


def _explained(evidence: Evidence, fit: ViewSolution) -> Array:
    """Part of each circle that is covered by edges which the view explains."""
    line = evidence.marks.line
    share = [
        float(fit.inliers[line == kind].mean()) if (line == kind).any() else 0.0
        for kind in range(CIRCLES)
    ]
    return evidence.covered * share


def _enough(rig: Array, visible: Array, covered: Array) -> bool:
    """Whether so much of the circles is covered, of what is visible, that they fix a view."""
    around = 2 * np.pi * np.array([HOUSE.twelve_foot, rig[R8], rig[R4]])
    arc, whole = float(covered @ around), float(visible @ around)
    return arc > LEAST_ARC and arc > LEAST_SUPPORT * whole


def _alike(one: Array, other: Array) -> bool:
    """Whether the circles have the same colours in two palettes, as far as both know them."""
    contrast = np.linalg.norm(one[:CIRCLES, 0] - one[:CIRCLES, 1], axis=1)
    away = np.linalg.norm(one[:CIRCLES] - other[:CIRCLES], axis=2).max(1)
    known = np.isfinite(contrast) & np.isfinite(away)
    return bool((away[known] < 0.5 * contrast[known]).all())


def _refine(piece: _Piece, size: tuple[int, int]) -> None:
    """Fit anew what the frames share, at first often, so that the way on is more precise."""
    if not piece.seen[-1].found or piece.found not in REFINE_AT:
        return
    good = [s for s in piece.seen if s.found]
    at = np.unique(np.round(np.linspace(0, len(good) - 1, REFINE_FRAMES)).astype(int))
    chosen = [good[i] for i in at]
    joint = solve(
        [s.marks for s in chosen], [s.view for s in chosen], piece.rig, size, prior=piece.prior,
        iterations=10, sharing=SHARING,
    )  # fmt: skip
    piece.rig = joint.rig
    for i in (-2, -1):
        seen = piece.seen[i]
        view = solve_view(seen.marks, seen.view, piece.rig, size).view
        piece.seen[i] = replace(seen, view=view)


def _left_out(best: _Piece, pieces: Sequence[_Piece], which: str) -> tuple[str, ...]:
    if len(pieces) == 1:
        return ()
    first, last = best.seen[0].index, best.seen[-1].index
    others = ", ".join(f"{p.seen[0].index} to {p.seen[-1].index}" for p in pieces if p is not best)
    return (
        f"the house is shown in {len(pieces)} separate pieces; only {which} is used, frames"
        f" {first} to {last}; left out: {others}",
    )
