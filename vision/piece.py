"""A piece of a clip: frames of one camera, each followed from the one before.

Each frame is predicted, its edges are measured along their normals and the view is refined.
Where that fails, the picture before is recognised in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE
from vision.adjust import solve
from vision.camera import Camera
from vision.clip import Frame
from vision.house_fit import SHARING
from vision.joint import Seen
from vision.landmarks import Keyframe, keyframe, recognise
from vision.marks import Evidence, measure_along
from vision.normals import Normals, lay_out
from vision.outline import Rim
from vision.paint import CIRCLES, FIXED, Marks, joined
from vision.picture import Picture
from vision.pose import View, camera
from vision.replay import EVERY, Glimpse, glimpse
from vision.resection import ViewSolution, solve_view
from vision.rig import R4, R8, Prior

Array = NDArray[np.float64]

MOST_NORMALS = 32
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

LEAST_SUPPORT, GOOD_SUPPORT = 0.3, 0.5
"""Of the circles that are in the picture, this part must be seen; where it is less than the
second, edges of others may have been taken for theirs, and are measured anew."""

LEARNING = 0.1
"""How fast the colours of the edges are learned anew."""

REFINE_AT = (8, 40, 160)
"""Numbers of frames at which what they share is fitted anew on the way."""

REFINE_FRAMES = 6

FREE = (np.inf, np.inf, 0.02, np.inf)
"""How far a view may be turned from its prediction: the roll is free where no line is seen."""

MOST_DRIFT = 0.25
"""A view carried so far astray is given up, m."""


@dataclass
class Piece:
    """Frames of one camera, and what is known of it.

    Attributes
    ----------
    size : tuple of int
        Width and height of the pictures, px.
    rig, prior : ndarray, Prior
        What the frames share, provisionally, and what is known of it beforehand.
    palette : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge.
    edge : Rim
        Where the 12-ft circle ends in the profiles across it.
    seen : list of Seen
        The frames so far.
    glimpses : list of Glimpse
        What the house looked like now and then.
    found : int
        How many of them fixed their camera themselves.
    lost : int
        Frames since the last that was followed.
    missed : int
        Frames in a row that were carried to where rings should be in view, and are not.
    """

    size: tuple[int, int]
    rig: Array
    prior: Prior
    palette: Array
    edge: Rim
    seen: list[Seen] = field(default_factory=list)
    glimpses: list[Glimpse] = field(default_factory=list)
    found: int = 0
    lost: int = 0
    missed: int = 0
    _picture: Picture | None = None
    _fit: ViewSolution | None = None
    _key: Keyframe | None = None
    _normals: Normals | None = None

    def follow(self, frame: Frame) -> Seen | None:
        """Follow into one more frame; None where the house is not to be seen, nor its ice."""
        seen = self._settle(frame, self._predicted(frame))
        if seen is None:
            return self._carried(frame)
        self._key, self.missed = None, 0
        return seen

    def add(self, seen: Seen, picture: Picture) -> None:
        """Take in a frame that was followed."""
        self.seen.append(seen)
        self.found += seen.found
        self._picture, self.lost = picture, 0

    def remember(self, picture: Picture) -> None:
        """Keep now and then what the house looks like."""
        last = self.seen[-1]
        if last.found and (not self.glimpses or last.t - self.glimpses[-1].t > EVERY):
            self.glimpses.append(glimpse(picture, last.view, self.rig, last.t))

    def refine(self) -> None:
        """Fit anew what the frames share, at first often, so that the way on is more precise."""
        if not self.seen[-1].found or self.found not in REFINE_AT:
            return
        good = [s for s in self.seen if s.found]
        at = np.unique(np.round(np.linspace(0, len(good) - 1, REFINE_FRAMES)).astype(int))
        chosen = [good[i] for i in at]
        joint = solve(
            [s.marks for s in chosen], [s.view for s in chosen], self.rig, self.size,
            prior=self.prior, iterations=10, sharing=SHARING,
        )  # fmt: skip
        self.rig = joint.rig
        for i in (-2, -1):
            seen = self.seen[i]
            view = solve_view(seen.marks, seen.view, self.rig, self.size).view
            self.seen[i] = replace(seen, view=view)

    def enter(
        self, frame: Frame, view: View, marks: Marks, waiting: Sequence[Frame]
    ) -> list[tuple[Frame, Seen]]:
        """Begin, or go on after a gap, at a frame of known view and marks.

        Parameters
        ----------
        frame : Frame
        view, marks : View, Marks
            Of its house, as found.
        waiting : sequence of Frame
            Those before it, in order.

        Returns
        -------
        list of (Frame, Seen)
            This frame and, before it, those to which it could be followed back through frames
            that wait, in order.
        """
        before, self.seen, self._key = self.seen, [], None
        first = self._settle(frame, view)
        if first is None:
            first = Seen(frame.index, frame.t, view, marks, True)
        self.add(first, frame.picture)
        placed = [(frame, first)]
        for earlier in reversed(waiting):
            seen = self.follow(earlier)
            if seen is None:
                break
            self.add(seen, earlier.picture)
            placed.append((earlier, seen))
        placed.reverse()
        self.seen = [*before, *(seen for _, seen in placed)]
        self._picture, self._key, self.missed = frame.picture, None, 0
        return placed

    def looks_like(self, palette: Array) -> bool:
        """Whether the circles have the same colours in a palette, as far as both know them."""
        contrast = np.linalg.norm(self.palette[:CIRCLES, 0] - self.palette[:CIRCLES, 1], axis=1)
        away = np.linalg.norm(self.palette[:CIRCLES] - palette[:CIRCLES], axis=2).max(1)
        known = np.isfinite(contrast) & np.isfinite(away)
        return bool((away[known] < 0.5 * contrast[known]).all())

    def camera(self, seen: Seen) -> Camera:
        """Give the provisional camera of a frame."""
        return camera(seen.view, self.rig, self.size, frame=seen.index, t=seen.t, found=seen.found)

    def _predicted(self, frame: Frame) -> View:
        """View at constant velocity."""
        last = self.seen[-1]
        if len(self.seen) < 2:
            return last.view
        before = self.seen[-2]
        if last.key is not before.key or abs(last.index - before.index) > 2:
            return last.view
        ahead = (frame.t - last.t) / (last.t - before.t)
        if not 0 < ahead < 3:
            return last.view
        return View(last.view.vector + ahead * (last.view.vector - before.view.vector))

    def _settle(self, frame: Frame, view: View) -> Seen | None:
        """Refine a predicted view on the rings; None where they are not there."""
        for _ in range(3):
            normals, point = self._laid(view)
            if not _enough(self.rig, normals.visible, normals.visible):
                return None
            evidence = self._measured(frame.picture, normals, point)
            if not _enough(self.rig, evidence.visible, evidence.covered):
                return None
            fit = solve_view(
                evidence.marks, view, self.rig, self.size, view_sd=FREE, width=WIDTH, iterations=6
            )
            shift = np.abs(fit.view.vector - view.vector)
            view, explained = fit.view, _explained(evidence, fit)
            settled = shift[:3].max() * view.focal < SETTLED * REACH * self.size[0]
            if settled and _enough(self.rig, evidence.visible, explained, GOOD_SUPPORT):
                break
        if not _enough(self.rig, evidence.visible, explained):
            return None
        known = np.isfinite(self.palette)
        new = np.isfinite(evidence.palette)
        mixed = (1 - LEARNING) * self.palette + LEARNING * evidence.palette
        self.palette = np.where(known & new, mixed, np.where(known, self.palette, evidence.palette))
        self._fit = fit
        return Seen(frame.index, frame.t, view, evidence.marks.pick(fit.inliers), True)

    def _laid(self, view: View) -> tuple[Normals, Array]:
        """Give normals and where they stand: those of the frame before, if not far from there."""
        if self._normals is not None:
            point = self._normals.moved(view.vector, self.rig, self.size)
            if point is not None:
                return self._normals, point
        reach = max(REACH * self.size[0], LEAST_REACH)
        self._normals = lay_out(view.vector, self.rig, self.size, reach=reach, most=MOST_NORMALS)
        return self._normals, self._normals.point

    def _measured(self, picture: Picture, normals: Normals, point: Array) -> Evidence:
        return measure_along(
            picture, normals, point, least_sd=MARK_SD, palette=self.palette, level=self.edge.level
        )

    def _carried(self, frame: Frame) -> Seen | None:
        """Place a frame that does not show the rings by points of the ice that are known."""
        last, view = self.seen[-1], self._predicted(frame)
        if self._key is None and self._picture is not None:
            cov = np.zeros((4, 4)) if self._fit is None else self._fit.cov
            self._key = keyframe(last.index, self._picture, last.view, self.rig, cov)
        key = self._key
        if key is None or key.drift > MOST_DRIFT:
            return None
        landmarks = recognise(key, frame.picture, view, self.rig)
        if landmarks is None:
            return None
        view = solve_view(
            landmarks, view, self.rig, self.size, width=10.0, view_sd=np.full(4, np.inf)
        ).view
        seen = self._settle(frame, view)
        if seen is not None:
            self._key, self.missed = None, 0
            return seen
        normals, point = self._laid(view)
        expected = _enough(self.rig, normals.visible, normals.visible)
        self.missed = self.missed + 1 if expected else 0
        lines = self._measured(frame.picture, normals, point).marks
        marks = joined([landmarks, lines.pick(lines.line >= CIRCLES)])
        fit = solve_view(marks, view, self.rig, self.size, view_sd=(1, 1, 0.02, 0.1))
        if len(landmarks) < len(key.ice):  # half of its corners are gone: two marks each
            self._key = keyframe(frame.index, frame.picture, fit.view, self.rig, fit.cov, key.drift)
        return Seen(frame.index, frame.t, fit.view, marks, False, key)


def _explained(evidence: Evidence, fit: ViewSolution) -> Array:
    """Part of each circle that is covered by edges which the view explains."""
    line = evidence.marks.line
    on, good = (np.bincount(line[which], minlength=FIXED)[:CIRCLES] for which in (..., fit.inliers))
    return np.asarray(evidence.covered * good / np.maximum(on, 1))


def _enough(rig: Array, visible: Array, covered: Array, least: float = LEAST_SUPPORT) -> bool:
    """Whether so much of the circles is covered, of what is visible, that they fix a view."""
    around = 2 * np.pi * np.array([HOUSE.twelve_foot, rig[R8], rig[R4]])
    arc, whole = float(covered @ around), float(visible @ around)
    return arc > LEAST_ARC and arc > least * whole
