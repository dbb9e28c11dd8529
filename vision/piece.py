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
from vision.linear import Frame as MarksOfFrames
from vision.marks import Evidence, measure_along
from vision.normals import Normals, lay_out
from vision.outline import Rim
from vision.paint import CIRCLES, FIXED, Marks, joined
from vision.picture import Picture
from vision.pose import View, camera
from vision.replay import EVERY, Glimpse, glimpse
from vision.resection import ViewSolution, solve_view, solve_views
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

ROUNDS = 3
"""How often the edges of a frame are measured at most."""

LONGEST_STRIDE = 4
"""Most frames that are predicted and followed together: it costs half as much."""

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
    stride : int
        How many frames may be followed together: the more, the better they are predicted.
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
    stride: int = 1
    _refined: int = 0
    _picture: Picture | None = None
    _fit: ViewSolution | None = None
    _key: Keyframe | None = None
    _normals: Normals | None = None

    def follow(self, frames: Sequence[Frame]) -> list[Seen]:
        """Follow into the next frames, of which there should be no more than `stride`.

        Returns
        -------
        list of Seen
            The first of them, as many as went well; none where the first shows neither the
            house nor its ice.
        """
        seen = self._settle(frames, [self._predicted(frame) for frame in frames])
        if seen:
            self._key, self.missed = None, 0
            return seen
        self.stride = 1
        carried = self._carried(frames[0])
        return [] if carried is None else [carried]

    def take(self, frames: Sequence[Frame], seen: Sequence[Seen]) -> list[tuple[Frame, Camera]]:
        """Take in frames that were followed; give them back with provisional cameras."""
        for frame, new in zip(frames, seen, strict=True):
            self._add(new, frame.picture)
            self._remember(frame.picture)
        self._refine()
        return [
            (frame, self.camera(new))
            for frame, new in zip(frames, self.seen[-len(frames) :], strict=True)
        ]

    def _add(self, seen: Seen, picture: Picture) -> None:
        self.seen.append(seen)
        self.found += seen.found
        self._picture, self.lost = picture, 0

    def _remember(self, picture: Picture) -> None:
        """Keep now and then what the house looks like."""
        last = self.seen[-1]
        if last.found and (not self.glimpses or last.t - self.glimpses[-1].t > EVERY):
            self.glimpses.append(glimpse(picture, last.view, self.rig, last.t))

    def _refine(self) -> None:
        """Fit anew what the frames share, at first often, so that the way on is more precise."""
        due = REFINE_AT[self._refined :]
        if not due or not self.seen[-1].found or self.found < due[0]:
            return
        self._refined += 1
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
        before, self.seen, self._key, self.stride = self.seen, [], None, 1
        settled = self._settle([frame], [view])
        first = settled[0] if settled else Seen(frame.index, frame.t, view, marks, True)
        self._add(first, frame.picture)
        placed = [(frame, first)]
        left = [*reversed(waiting)]
        while left and (followed := self.follow(left[: self.stride])):
            for earlier, seen in zip(left, followed, strict=False):
                self._add(seen, earlier.picture)
                placed.append((earlier, seen))
            del left[: len(followed)]
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
        if not 0 < ahead <= LONGEST_STRIDE:
            return last.view
        return View(last.view.vector + ahead * (last.view.vector - before.view.vector))

    def _settle(self, frames: Sequence[Frame], views: Sequence[View]) -> list[Seen]:
        """Refine predicted views on the rings; those of the first frames for which that goes."""
        again = False
        for _ in range(ROUNDS):
            normals, standing = self._laid(views)
            if not _enough(self.rig, normals.visible, normals.visible):
                return []
            evidence = self._measured([frame.picture for frame in frames], normals, standing)
            seen = [_enough(self.rig, e.visible, e.covered) for e in evidence]
            evidence = evidence[: [*seen, False].index(False)]
            if not evidence:
                return []
            marks = [e.marks for e in evidence]
            fits = solve_views(
                MarksOfFrames(joined(marks), self.size, counts=[len(m) for m in marks]),
                views[: len(marks)], self.rig, view_sd=FREE, width=WIDTH, iterations=6,
            )  # fmt: skip
            settled = [self._is_settled(*both) for both in zip(views, evidence, fits, strict=False)]
            count = [*settled, False].index(False)
            if count:
                break
            frames, views, again = frames[:1], [fits[0].view], True
        else:
            if not _enough(self.rig, evidence[0].visible, _explained(evidence[0], fits[0])):
                return []
            count = 1
        whole = count == len(frames) and not again
        self.stride = min(2 * count, LONGEST_STRIDE) if whole else max(count // 2, 1)
        self._fit = fits[count - 1]
        self._learn(evidence[count - 1].palette, count)
        return [
            Seen(
                frame.index,
                frame.t,
                fit.view,
                e.marks.pick(fit.inliers),
                True,
            )
            for frame, e, fit in zip(frames, evidence[:count], fits, strict=False)
        ]

    def _is_settled(self, before: View, evidence: Evidence, fit: ViewSolution) -> bool:
        """Whether a view was predicted so well that the edges need not be measured anew."""
        shift = np.abs(fit.view.vector - before.vector)[:3].max() * fit.view.focal
        near = shift < SETTLED * REACH * self.size[0]
        explained = _explained(evidence, fit)
        return bool(near) and _enough(self.rig, evidence.visible, explained, GOOD_SUPPORT)

    def _learn(self, palette: Array, frames: int) -> None:
        """Take in the colours of the edges in the last of so many frames."""
        kept = (1 - LEARNING) ** frames
        mixed = kept * self.palette + (1 - kept) * palette
        mixed = np.where(np.isfinite(mixed), mixed, palette)
        self.palette = np.where(np.isfinite(mixed), mixed, self.palette)

    def _laid(self, views: Sequence[View]) -> tuple[Normals, Array]:
        """Give normals and where they stand in views: where they were laid out not far from there.

        These may be fewer than the views; the first is among them.
        """
        if self._normals is not None:
            standing = self._moved(self._normals, views)
            if len(standing) == len(views):
                return self._normals, np.array(standing)
        reach = max(REACH * self.size[0], LEAST_REACH)
        normals = lay_out(views[0].vector, self.rig, self.size, reach=reach, most=MOST_NORMALS)
        self._normals = normals
        return normals, np.array([normals.standing, *self._moved(normals, views[1:])])

    def _moved(self, normals: Normals, views: Sequence[View]) -> list[Array]:
        found = []
        for view in views:
            point = normals.moved(view.vector, self.rig, self.size)
            if point is None:
                break
            found.append(point)
        return found

    def _measured(
        self, pictures: Sequence[Picture], normals: Normals, standing: Array
    ) -> list[Evidence]:
        return measure_along(
            pictures[: len(standing)], normals, standing,
            least_sd=MARK_SD, palette=self.palette, level=self.edge.level,
        )  # fmt: skip

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
        normals, standing = self._laid([view])
        expected = _enough(self.rig, normals.visible, normals.visible)
        if expected and (seen := self._settle([frame], [view])):
            self._key, self.missed = None, 0
            return seen[0]
        self.missed = self.missed + 1 if expected else 0
        lines = self._measured([frame.picture], normals, standing)[0].marks
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
