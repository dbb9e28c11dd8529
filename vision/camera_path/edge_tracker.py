"""Views refined on the edges of a house: predicted, measured along normals, fitted.

Frames that can be predicted are measured and fitted together: most of what one costs is the same
for several.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE
from curlshot.vision.camera_path.joint import Seen
from curlshot.vision.camera_path.shutter import ShutterLight, Smeared
from curlshot.vision.camera_path.smear import Shutter, reach_beyond, smear
from curlshot.vision.optics.linear import Observations
from curlshot.vision.optics.paint import CIRCLES, EIGHT, FIXED, TWELVE, Marks, joined
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.resection import ViewSolution, solve_views
from curlshot.vision.optics.rig import R4, R8
from curlshot.vision.sheet.edges import MIN_CONTRAST
from curlshot.vision.sheet.marks import Evidence, measure_along, measure_marks
from curlshot.vision.sheet.mixing import lit
from curlshot.vision.sheet.normals import OUTSIDE, Normals, lay_out
from curlshot.vision.sheet.outline import PaintEdge, find_edge
from curlshot.vision.sheet.stations import THIN
from curlshot.vision.video.disk_cache import Cached
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Picture

Array = NDArray[np.float64]

MOST_NORMALS = 48
"""Normals on each circle: paint is ragged, and by 32 the camera is placed .4 mm aside of what the
whole circles tell, by these .3 mm; more gain little."""

TOO_SHORT = 2.0
"""Where a picture is smeared so that normals should be this much longer, a pan has begun faster
than the frame before could tell."""

MARK_SD = 0.2
"""Least standard deviation of a mark, px."""

PROVISIONAL_WIDTH = 6.0
"""Width of the robust loss, in standard deviations, while the shared part is provisional."""

SETTLED, LEAST_SETTLED = 0.4, 0.1
"""Correction below which the edges need not be measured anew, half lengths of the normals; and in
however fast a pan."""

ROUNDS = 6
"""How often the edges of a frame are measured at most."""

LEAST_ARC = 1.2
"""Length of circle that must be seen to fix a view, m."""

LEAST_SUPPORT, GOOD_SUPPORT = 0.3, 0.5
"""Of the circles that are in the picture, this part must be seen; where it is less than the
second, edges of others may have been taken for theirs, and are measured anew."""

LEARNING = 0.1
"""How fast the colours of the edges are learned anew."""

MOST_MOVED = 0.3
"""Where the light that a shutter blurs moves edges by more than was known, px, they are measured
anew."""

SHARPER, RESTING, AS_MUCH = 1.25, 1.5, 0.6
"""Where circles are in their profiles was told in a smeared frame if the 12-ft edge is so much
steeper now; it is told anew where no pan smears by more, px, and so much of the 12- and 8-ft
circles is seen of what was seen there."""

EDGE_ROUNDS = 2
"""Measurements by which such a frame tells it: the first shows how the profiles lie."""

UNSURE = 0.5
"""Part of that by which such a frame moves circles that is in doubt in the frames before, for these
are smeared."""

LONGEST_STRIDE = 8
"""Most frames that are followed together."""

FREE, HELD = (np.inf, np.inf, 0.02, np.inf), (np.inf, np.inf, 0.002, np.inf)
"""How far a view may lie from its prediction, and where no line is seen: circles alone would turn
it on and on, for the camera's place is not known exactly."""


@dataclass
class EdgeTracker:
    """What is known of the edges of a house, from frame to frame.

    Attributes
    ----------
    size : tuple of int
        Width and height of the pictures, px.
    palette : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge.
    edge : PaintEdge
        Where the circles are in the profiles across them.
    told : Evidence, optional
        What the frame has shown that told that.
    stride : int
        How many frames may be followed together: the more, the better they are predicted.
    fit : ViewSolution, optional
        The last one.
    sweep : ndarray, shape (2,)
        How far a pan smears edges along x and along y in the frames asked for last, px.
    smeared : float
        How far the edges of the last frame are smeared, by what they look like, px.
    moved : ndarray, shape (3,)
        How far beyond where frames before the last had them circles are found to be, along their
        normals, px; whoever makes good for that sets it to 0.
    """

    size: tuple[int, int]
    palette: Array
    edge: PaintEdge
    told: Evidence | None = None
    stride: int = 1
    fit: ViewSolution | None = None
    sweep: Array = field(default_factory=lambda: np.zeros(2))
    smeared: float = 0.0
    moved: Array = field(default_factory=lambda: np.zeros(CIRCLES))
    _shutter: Shutter = field(default_factory=Shutter)
    light: ShutterLight = field(init=False)
    _last: tuple[View, Array, Normals, Array] | None = None
    _focal: float = 0.0

    def __post_init__(self) -> None:
        self.light = ShutterLight.of(self.edge, self.palette)

    def settle(
        self, frames: Sequence[Frame], views: Sequence[View], rig: Array, last: View
    ) -> list[Seen]:
        """Refine predicted views.

        Parameters
        ----------
        frames, views : sequences of Frame and View
            One or more frames, and where they are expected.
        rig : ndarray, shape (15,)
        last : View
            That of the frame before them.

        Returns
        -------
        list of Seen
            The first of the frames, as many as went well; none where the first does not show
            enough of the circles.
        """
        self._zoom(last.focal, views[0].focal)
        again, smeared, known = False, 0.0, self.light
        for _ in range(ROUNDS):
            steps = [now.sweep(old) for now, old in zip(views, [last, *views], strict=False)]
            self.sweep = self._shutter.exposure * max(steps, key=np.linalg.norm)
            self.sweep *= max(1.0, smeared / max(self.blur, 1e-3))
            normals, standing = self._laid(views, rig)
            if not _enough(rig, normals.visible, normals.visible):
                return []
            share = self.light.share
            evidence = self._measured([frame.picture for frame in frames], normals, standing)
            evidence = evidence[: _leading([_enough(rig, e.visible, e.covered) for e in evidence])]
            if not evidence:
                return []
            fits = self._fitted([e.marks for e in evidence], views, rig)
            each = zip(views, evidence, fits, strict=False)
            count = _leading([self._is_settled(*one, rig) for one in each])
            stays = again and fits[0].view.aside(views[0]) < LEAST_SETTLED * self._reach
            moved = self._learn_light(evidence[0].marks, fits[0].view, rig, known)
            if (count or stays) and moved < MOST_MOVED:
                break
            smeared = smear(evidence[0].slope)
            frames, views, again = frames[:1], [fits[0].view], True
        if not count:
            if not _enough(rig, evidence[0].visible, _explained(evidence[0], fits[0])):
                return []
            count = 1
        whole = count == len(frames) and not again
        self.stride = min(2 * count, LONGEST_STRIDE) if whole else max(count // 2, 1)
        self.fit, shown = fits[count - 1], evidence[count - 1]
        self.smeared = smear(shown.slope)
        self._learn(shown.palette, count)
        if self._is_sharper(shown):
            self._tell_edge(frames[count - 1].picture, rig)
        rim = normals.normal[:, normals.kinds.get(TWELVE, slice(0))]
        self._shutter.learn(shown.slope, self.fit.view.sweep([last, *views][count - 1]) @ rim)
        return [
            self._seen(frame, fit, e.marks.pick(fit.inliers), share)
            for frame, e, fit in zip(frames, evidence[:count], fits, strict=False)
        ]

    def _seen(self, frame: Frame, fit: ViewSolution, marks: Marks, share: float) -> Seen:
        """Give a frame with its marks, which were measured with a share of light."""
        by_light = self._pan.by_light(marks)
        return Seen(
            frame.index, frame.t, fit.view, Cached(marks), True,
            smeared=self.blur, share=share, by_light=by_light if by_light.any() else None,
        )  # fmt: skip

    def expects(self, view: View, rig: Array) -> bool:
        """Whether a view should show enough of the circles to be refined."""
        visible = self._laid([view], rig)[0].visible
        return _enough(rig, visible, visible)

    def lines(self, pictures: Sequence[Picture], views: Sequence[View], rig: Array) -> list[Marks]:
        """Measure the straight lines near where views have them, as far as they are known.

        A wide line whose colours no frame with the rings has told lies where none has told.

        Returns
        -------
        list of Marks
            Of the first of the pictures, as many as can be measured together; one at least.
        """
        measured = self._measured(pictures, *self._laid(views, rig))
        known = np.isfinite(self.palette[:, 0, 0])
        known[[*THIN]], known[:CIRCLES] = True, False
        return [e.marks.pick(known[e.marks.line]) for e in measured]

    def looks_like(self, palette: Array) -> bool:
        """Whether the circles have the same colours in a palette, as far as both know them.

        In a picture that has faded all of them are brighter or darker by one factor.
        """
        own, other = self.palette[:CIRCLES], palette[:CIRCLES]
        both = np.isfinite(own) & np.isfinite(other)
        own = own * ((own * other)[both].sum() / max(float((own[both] ** 2).sum()), 1.0))
        contrast = np.linalg.norm(own[:, 0] - own[:, 1], axis=1)
        away = np.linalg.norm(own - other, axis=2).max(1)
        known = np.isfinite(contrast) & np.isfinite(away)
        return bool((away < np.maximum(0.5 * contrast, MIN_CONTRAST))[known].all())

    def relit(self, seen: Seen) -> Seen:
        """Move the edges of a frame that a pan smears to where they lie by what is known by now."""
        more = self.light.share - seen.share
        if seen.by_light is None or not more:
            return seen
        marks = seen.marks.get()
        pixel = marks.pixel + marks.normal * (more * seen.by_light)[:, None]
        return replace(seen, marks=Cached(replace(marks, pixel=pixel)), share=self.light.share)

    @property
    def blur(self) -> float:
        """How far a pan smears edges, px."""
        return math.hypot(*self.sweep)

    @property
    def _reach(self) -> float:
        """Half length of the normals, px."""
        return reach_beyond(self.blur, self.size[0]) + self.edge.reach

    def _laid(self, views: Sequence[View], rig: Array) -> tuple[Normals, Array]:
        """Give normals and where they stand in views, of which at least the first has them.

        What was asked last is kept: where the circles are not in view, lines are looked for next.
        """
        if self._last is not None:
            view, known, normals, standing = self._last
            if view is views[0] and known is rig and len(standing) >= len(views):
                return normals, standing[: len(views)]
        normals, standing = self._lay(views, rig)
        # Where a pan smears a narrow band wider than it is, its edges are no longer half way.
        if normals.kinds:
            across = np.minimum(np.abs(self.sweep @ normals.normal), normals.wanted)
            standing = np.where(normals.reach < across, OUTSIDE, standing)
        self._last = views[0], rig, normals, standing
        return normals, standing

    def _lay(self, views: Sequence[View], rig: Array) -> tuple[Normals, Array]:
        """Take the same normals as before, or where these are too far away new ones."""
        normals = None if self._last is None else self._last[2]
        if normals is not None and normals.kinds and 0.8 < self._reach / normals.wanted < 1.25:
            moved = self._moved(normals, views, rig)
            if len(moved) == len(views):
                return normals, np.array(moved)
        normals = lay_out(views[0].vector, rig, self.size, reach=self._reach, most=MOST_NORMALS)
        return normals, np.array([normals.standing, *self._moved(normals, views[1:], rig)])

    def _moved(self, normals: Normals, views: Sequence[View], rig: Array) -> list[Array]:
        """Give where normals stand in the first of the views, up to one that is too far away."""
        found = []
        for view in views:
            standing = normals.moved(view.vector, rig, self.size)
            if standing is None:
                break
            found.append(standing)
        return found

    def _measured(
        self, pictures: Sequence[Picture], normals: Normals, standing: Array
    ) -> list[Evidence]:
        return measure_along(
            pictures[: len(standing)], normals, standing,
            least_sd=MARK_SD, palette=self.palette, edge=self.edge,
            levels=self._pan.levels(normals.line, normals.normal.T, self.light.share),
        )  # fmt: skip

    def _fitted(
        self, marks: Sequence[Marks], views: Sequence[View], rig: Array
    ) -> list[ViewSolution]:
        observed = Observations(joined(marks), self.size, counts=[len(m) for m in marks])
        start, lines = views[: len(marks)], all((m.line >= CIRCLES).any() for m in marks)
        view_sd = FREE if lines else HELD
        return solve_views(
            observed, start, rig, view_sd=view_sd, width=PROVISIONAL_WIDTH, iterations=6
        )

    def _is_settled(
        self, expected: View, evidence: Evidence, fit: ViewSolution, rig: Array
    ) -> bool:
        """Whether a view was predicted so well that the edges need not be measured anew.

        The colours beside an edge are those at the outer quarters of a normal. Where a pan blurs
        edges into these, an edge is drawn to where it was expected.
        """
        free = 0.5 * (self._reach - self.blur)
        most = np.clip(free, LEAST_SETTLED * self._reach, SETTLED * self._reach)
        near = fit.view.aside(expected) < most
        near &= reach_beyond(smear(evidence.slope), self.size[0]) < TOO_SHORT * self._reach
        return near and _enough(rig, evidence.visible, _explained(evidence, fit), GOOD_SUPPORT)

    def _zoom(self, before: float, now: float) -> None:
        """Take outlines drawn alone to be as much wider as the view has zoomed since it was told.

        `before` is the focal length with which that was, if no frame was seen yet.
        """
        if self.edge.within:
            wider = now / (self._focal or before)
            self.edge = replace(self.edge, within=self.edge.within * wider)
        self._focal = now

    @property
    def _pan(self) -> Smeared:
        return Smeared(self.sweep, self.palette, self.edge)

    def _learn_light(self, marks: Marks, view: View, rig: Array, known: ShutterLight) -> float:
        """Tell by a frame what the shutter blurs, and how far that moves its edges anew, px.

        `known` is what the frames before told; what was told by this one before is forgotten.
        """
        used = self.light.share
        told = self._pan.told(marks, view, rig, self.size, used)
        if told is None:
            return 0.0
        share, sd, most = told
        self.light = known.taking(share, sd)
        return abs(self.light.share - used) * most

    def _is_sharper(self, shown: Evidence) -> bool:
        """Whether a frame would tell the edge better than the one that has told it."""
        if self.told is None or self.blur > RESTING:
            return False
        both, told = [TWELVE, EIGHT], self.told
        as_much = (shown.covered[both] > AS_MUCH * told.covered[both]).all()
        return bool(as_much) and shown.steepness > SHARPER * told.steepness

    def _tell_edge(self, picture: Picture, rig: Array) -> None:
        """Tell by a frame that is sharper than those before where circles are in profiles."""
        assert self.fit is not None
        before, view, least = self.edge, self.fit.view.vector, reach_beyond(0.0, self.size[0])
        for _ in range(EDGE_ROUNDS):
            reach = least + self.edge.reach
            shown = measure_marks(picture, view, rig, reach=reach, lines=False, edge=self.edge)
            edge = find_edge(shown.profile, shown.step)
            self.edge = lit(edge, picture, self.fit.view, rig, shown)
        self._focal, self.told, slope = self.fit.view.focal, shown, shown.steepness
        self.moved = self.moved + self.edge.aside(slope) - before.aside(slope)
        self.light = ShutterLight.of(self.edge, self.palette)

    def _learn(self, palette: Array, frames: int) -> None:
        """Take in the colours of the edges in the last of so many frames."""
        kept = (1 - LEARNING) ** frames
        mixed = kept * self.palette + (1 - kept) * palette
        mixed = np.where(np.isfinite(mixed), mixed, palette)
        self.palette = np.where(np.isfinite(mixed), mixed, self.palette)


def put_right(marks: Marks, way: Array) -> Marks:
    """Move what was measured on circles so far along their normals, (3,), px."""
    along = np.append(way, np.zeros(FIXED + 1 - CIRCLES))[marks.line]
    pixel = marks.pixel + marks.normal * along[:, None]
    return replace(marks, pixel=pixel, sd=np.hypot(marks.sd, UNSURE * along))


def _leading(good: Sequence[bool]) -> int:
    """Count those before the first that is False."""
    return [*good, False].index(False)


def _explained(evidence: Evidence, fit: ViewSolution) -> Array:
    """Part of each circle that is covered by edges which the view explains."""
    line = evidence.marks.line
    on, good = (np.bincount(line[which], minlength=FIXED)[:CIRCLES] for which in (..., fit.inliers))
    return np.asarray(evidence.covered * good / np.maximum(on, 1))


def _length(rig: Array, share: Array) -> float:
    """Length of such shares of the circles, m."""
    around = 2 * np.pi * np.array([HOUSE.twelve_foot, rig[R8], rig[R4]])
    return float(share @ around)


def _enough(rig: Array, visible: Array, covered: Array, least: float = LEAST_SUPPORT) -> bool:
    """Whether so much of the circles is covered, of what is visible, that they fix a view."""
    arc = _length(rig, covered)
    return arc > LEAST_ARC and arc > least * _length(rig, visible)
