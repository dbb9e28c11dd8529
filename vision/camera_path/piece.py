"""A piece of a clip: frames of one camera, each followed from the one before.

Each frame is predicted and refined on the edges of the house
(`curlshot.vision.camera_path.edge_tracker`). Where that fails, the picture before is recognised in
it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.camera_path.edge_tracker import HELD, LONGEST_STRIDE, EdgeTracker, put_right
from curlshot.vision.camera_path.egomotion import foretold
from curlshot.vision.camera_path.ice_tracker import IceTracker
from curlshot.vision.camera_path.joint import Seen, spread
from curlshot.vision.camera_path.leap import leapt
from curlshot.vision.camera_path.replay import EVERY, Glimpse, cut_among, glimpse, shows_again
from curlshot.vision.camera_path.shutter import LEAST_SMEAR, more_light
from curlshot.vision.optics.adjust import SHARING, Solution, solve
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.lean import fit_leaning
from curlshot.vision.optics.linear import Observations
from curlshot.vision.optics.paint import (
    CENTRE_LINE,
    CIRCLES,
    EIGHT,
    FOUR,
    TEE_LINE,
    TWELVE,
    Marks,
    joined,
)
from curlshot.vision.optics.pose import ROLL, View, camera
from curlshot.vision.optics.predict import MEMORY, predict
from curlshot.vision.optics.resection import solve_view, solve_views
from curlshot.vision.optics.rig import Prior
from curlshot.vision.sheet.house_fit import TILT_GAIN, HouseFit
from curlshot.vision.video.disk_cache import Cached, DiskCache
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Picture

Array = NDArray[np.float64]

REFINE_AT = (8, 40, 160)
"""Numbers of frames at which what they share is fitted anew on the way."""

MOST_HELD = 16
"""Frames that wait for the first such fit, at most: by a camera that changes with it, all that is
on the ice would seem to move."""

REFINE_ZOOM = 0.2
"""Change of log focal length beyond what was seen by then after which it is due as well: the lens
goes with the zoom, and what it is beyond that is not known."""

REFINE_FRAMES = 6
"""Of all frames so many, spread over them, say what they share on the way."""

MOST_MISSED = 25
"""Frames in a row that may be carried to where rings should be in view, and are not, till these are
seen. Of 71 clips 65 have none and two have one; in four another picture is blended or cut in, and
what is fixed to the ice is of that."""

WHOLE, LOOK_TWICE = 0.75, 6
"""Share of the 12-ft circle in view from which on a house that is found needs no second look, and
frames followed after which there is one, before any is given: the first ones of a dissolve hide
more of the house in the middle than of one beside that is cut."""

MOST_BLUR = 0.004
"""Blur of a picture beyond which it would not look like a sharp one of the same, widths of it."""

SHAKEN = 0.0014
"""How far a view may be from how the views before went on, widths of the picture: half of what
spares a second look at the edges."""

LEAPT = 0.03
"""How far from where it should have gone on a view has leapt, widths of the picture."""

CUT_TIMES, CUT_PX, CUT_LOOKS = 10.0, 0.6, 4
"""A sharp picture whose edges are so many times as far off the camera as they were as a rule in so
many looks before, and by more than that, px, is another camera's, whose house is nearly where this
one's was. Of 164 clips that have no such cut none is ended so."""

MOST_SMEARED, LEAST_SMEARED = 0.0025, 0.1
"""Blur of a picture beyond which a pan is on its way, widths of it; and the least share of a turn
by which a pan so fast would smear the next: no cut smears pictures."""

LEAST_EXPLAINED, SAME_RMS_PX = 0.8, 0.3
"""How much of a house, and of the frames before, one camera must explain to be the same; and by
how much worse than another's it may explain the house, px."""


@dataclass(eq=False)
class Piece:
    """Frames of one camera, and what is known of it.

    Attributes
    ----------
    size : tuple of int
        Width and height of the pictures, px.
    rig, prior : ndarray, Prior
        What the frames share, provisionally, and what is known of it beforehand.
    edges : EdgeTracker
        Refines the views.
    cache : DiskCache
        Where marks and glimpses of the frames are put aside; the pieces of a clip share one.
    vague : bool
        Whether its first frame tells at best roughly how the camera leans.
    in_view : float
        Share of the 12-ft circle that its first frame shows; 1 after a second look.
    seen : list of Seen
        The frames so far.
    glimpses : list of Glimpse
        What the house looked like now and then.
    found : int
        How many of them fixed their camera themselves.
    lost : int
        Frames since the last that was followed.
    leapt : bool
        Whether the camera has turned farther than could be expected, and its pictures are sharp
        all the same: it may be a cut as well.
    """

    size: tuple[int, int]
    rig: Array
    prior: Prior
    edges: EdgeTracker
    cache: DiskCache = field(default_factory=DiskCache)
    vague: bool = False
    in_view: float = 1.0
    seen: list[Seen] = field(default_factory=list)
    glimpses: list[Glimpse] = field(default_factory=list)
    found: int = 0
    lost: int = 0
    leapt: bool = False
    _due: tuple[float, ...] = (*REFINE_AT, np.inf)
    _zooms: tuple[float, float] = (-np.inf, np.inf)
    _picture: Picture | None = None
    _ice: IceTracker = field(default_factory=IceTracker)
    _fresh: list[Picture] = field(default_factory=list)
    _held: list[Frame] = field(default_factory=list)
    _waiting: list[Frame] = field(default_factory=list)
    _shaken: bool = False
    _doubtful: int = 0
    _off: deque[float] = field(default_factory=lambda: deque(maxlen=CUT_LOOKS))

    @property
    def to_be_looked_at_twice(self) -> bool:
        """Whether its house is cut, and nobody has looked for a fuller one yet."""
        return self.in_view < WHOLE

    @property
    def missed(self) -> int:
        """Frames in a row that were carried to where rings should be in view, and are not."""
        return self._ice.missed

    def give_up_missed(self) -> None:
        """Leave out the last frames if they were carried so: nothing bears them out."""
        kept = len(self.seen) - self._doubtful
        left = {seen.index for seen in self.seen[kept:]}
        del self.seen[kept:]
        self._held = [frame for frame in self._held if frame.index not in left]
        self._doubtful = 0
        self._ice.forget()

    def goes_on_at(self, view: View) -> bool:
        """Whether a view is near where the last frame was, or was carried to."""
        return _length(view.sweep(self.seen[-1].view)) < LEAPT * self.size[0]

    def follow(self, frames: Sequence[Frame]) -> list[Seen]:
        """Follow into the next frames, of which there should be no more than `edges.stride`.

        Returns
        -------
        list of Seen
            The first of them, as many as went well; none where the first shows neither the
            house nor its ice.
        """
        expected = self._predicted(frames)
        views = self._foretold(frames) or expected
        last, before = self.seen[-1].view, self.edges.smeared
        seen = self._settle(frames[: len(views)], views)
        if len(seen) > 1 and self._is_cut(self._off_now(seen)):  # in one that comes later, maybe
            seen = self._settle(frames[:1], views[:1])
        off = self._off_now(seen)
        if self._is_cut(off):
            return []
        self._off += [] if off is None else [off]
        self._shaken = self._is_shaken(expected, views, seen)
        far = bool(seen) and _length(seen[0].view.sweep(expected[0])) > LEAPT * self.size[0]
        if not seen and self._picture is not None:
            view = leapt(self._picture, frames[0].picture, last, self.rig)
            seen = [] if view is None else self._settle(frames[:1], [view])
            far = bool(seen)
        sharp = before < MOST_SMEARED * self.size[0]
        self.leapt = (
            far and sharp and self.edges.smeared < LEAST_SMEARED * _length(seen[0].view.sweep(last))
        )
        return seen

    def _off_now(self, seen: Sequence[Seen]) -> float | None:
        """How far edges are off in the last of frames that were followed, px; None if smeared."""
        if not seen or not seen[-1].found or self.edges.blur > LEAST_SMEAR:
            return None
        return None if self.edges.fit is None else self.edges.fit.rms

    def _is_cut(self, off: float | None) -> bool:
        """Whether a frame whose edges are so far off, px, is another camera's."""
        if off is None or len(self._off) < CUT_LOOKS:
            return False
        return off > max(CUT_TIMES * float(np.median(self._off)), CUT_PX)

    def _foretold(self, frames: Sequence[Frame]) -> list[View]:
        """Tell the views of the next frames by their pictures, if how they went on does not."""
        last = self.seen[-1]
        if not self._shaken or self._picture is None or abs(frames[0].index - last.index) > 2:
            return []
        views = foretold(self._picture, last.view, [frame.picture for frame in frames])
        steps = [now.sweep(old) for now, old in zip(views, [last.view, *views], strict=False)]
        most = LEAPT * self.size[0]
        cuts = [_length(two - one) > most for one, two in pairwise(steps)]
        return views[: [*cuts, True].index(True) + 1]

    def _is_shaken(
        self, expected: Sequence[View], views: Sequence[View], seen: Sequence[Seen]
    ) -> bool:
        """Whether the next views are better told by their pictures than by how these went on.

        Parameters
        ----------
        expected, views : sequence of View
            How they should have gone on, and where they were looked for.
        seen : sequence of Seen
        """
        if not seen:
            return True
        near = zip(expected, seen, strict=False)
        if len(seen) == len(views) and all(
            one.view.aside(view) < SHAKEN * self.size[0] for view, one in near
        ):
            return False
        first = seen[0].view
        return views is expected or first.aside(views[0]) < first.aside(expected[0])

    def _settle(self, frames: Sequence[Frame], views: Sequence[View]) -> list[Seen]:
        """Place frames near where they are expected, by the house or else by its ice."""
        last = self.seen[-1]
        seen = self.edges.settle(frames, views, self.rig, last.view)
        if seen:
            self._ice.forget()
        elif self._picture is not None:
            seen = self._ice.settle(frames, views, last, self._picture, self.rig, self.edges)
            whole = len(seen) == len(frames)
            self.edges.stride = min(2 * len(seen), LONGEST_STRIDE) if whole else 1
        return seen

    def _make_good(self, *others: list[Seen]) -> None:
        """Move circles to where a sharper frame has told them, in all frames so far and others.

        What these share is fitted anew: by what told it before the next would be taken apart.
        """
        moved = self.edges.moved
        if not moved.any():
            return
        self.edges.moved = np.zeros(CIRCLES)
        for frames in (self.seen, *others):
            for k, seen in enumerate(frames):
                marks = Cached(put_right(seen.marks.get(), moved))
                marks.put_aside(self.cache)
                frames[k] = replace(seen, marks=marks)
        self.rig = self._joint(self._spread()).rig
        self._view_again(MEMORY)

    def relight(self) -> None:
        """Move edges that pans smear to where they lie by what all of them tell of the shutter."""
        smeared = [(k, s, s.by_light) for k, s in enumerate(self.seen) if s.by_light is not None]
        if not smeared:
            return
        rig = self.rig = self._joint(self._spread()).rig
        for _, seen, by_light in smeared:
            more = more_light(seen.marks.get(), seen.view, rig, self.size, by_light)
            if more is not None:
                self.edges.light = self.edges.light.taking(seen.share + more[0], more[1])
        for k, seen, _ in smeared:
            self.seen[k] = relit = self.edges.relit(seen)
            relit.marks.put_aside(self.cache)

    def take(self, frames: Sequence[Frame], seen: Sequence[Seen]) -> list[tuple[Frame, Camera]]:
        """Take in frames that were followed; give them back with provisional cameras.

        The first ones are held back till what they share has been fitted.
        """
        for frame, new in zip(frames, seen, strict=True):
            self._add(new, frame.picture)
        self._make_good()
        return self._held_back(frames)

    def _held_back(self, frames: Sequence[Frame]) -> list[tuple[Frame, Camera]]:
        """Give frames with cameras, and those that waited: once what they share has been fitted.

        Those that were carried to where rings should be in view wait until these are seen, and
        those of a house that is cut until it has been looked at twice.
        """
        self._held += frames
        self._refine()
        ready = self._due[0] > REFINE_AT[0] or len(self._held) > MOST_HELD
        waits = self._doubtful or self.to_be_looked_at_twice
        return self.let_go() if ready and not waits else []

    def let_go(self) -> list[tuple[Frame, Camera]]:
        """Give the frames that still wait, but for those that were left out since."""
        if self._waiting:
            self._begin_earlier()
        known = {seen.index: seen for seen in self.seen[-len(self._held) :]}
        held, self._held = self._held, []
        return [(f, self.camera(known[f.index])) for f in held if f.index in known]

    def taken_back(self) -> list[Frame]:
        """Take back the frames that were not given, in order: they are of another house."""
        frames, self._waiting, self._held = [*self._waiting, *self._held], [], []
        return frames

    def second_look_due(self, more: int) -> bool:
        """Whether there are enough frames, with so many more, to look for a fuller house."""
        many = self.found + more >= LOOK_TWICE or len(self._held) + more > MOST_HELD
        return self.to_be_looked_at_twice and many and not self.missed

    def _add(self, seen: Seen, picture: Picture) -> None:
        seen.marks.put_aside(self.cache)
        self.seen.append(seen)
        self._doubtful = 0 if seen.found or not self.missed else self._doubtful + 1
        self.found += seen.found
        self._picture, self.lost = picture, 0
        self._fresh = [*self._fresh, picture] if seen.found else []

    def glimpse_due(self) -> Glimpse | None:
        """Tell what the house looks like in the last frame, now and then."""
        last = self.seen[-1]
        if self._picture is None or not last.found or self.edges.blur > MOST_BLUR * self.size[0]:
            return None
        if self.glimpses and last.t - self.glimpses[-1].t <= EVERY:
            return None
        return glimpse(self._picture, last.view, self.rig, last.t)

    def keep(self, look: Glimpse) -> None:
        """Keep what the house looks like in the last frame; only it is asked for often."""
        for before in self.glimpses[-1:]:
            before.kept.put_aside(self.cache)
        self.glimpses.append(look)
        self._fresh = []

    def give_up_cut(self, like: Sequence[Glimpse]) -> bool:
        """Leave out frames since the last glimpse if a cut leads to what these show.

        Returns
        -------
        bool
            Whether one does.
        """
        fresh = self.seen[len(self.seen) - len(self._fresh) :]
        looks = [
            glimpse(picture, seen.view, self.rig, seen.t)
            for picture, seen in zip(self._fresh, fresh, strict=True)
        ]
        first = cut_among([self.glimpses[-1], *looks])
        if first is None or not shows_again(looks[-1], self.glimpses, like):
            return False
        left = len(fresh) - first + 1
        self.found -= left
        del self.seen[-left:]
        return True

    def _refine(self) -> None:
        """Fit anew what the frames share, at first often, so that the way on is more precise."""
        last = self.seen[-1]
        if not last.found:
            return
        log_f, (shortest, longest) = float(last.view.vector[3]), self._zooms
        enough = self.found >= self._due[0]
        if not enough and shortest - REFINE_ZOOM < log_f < longest + REFINE_ZOOM:
            return
        self._zooms = min(log_f, shortest), max(log_f, longest)
        self._due = self._due[enough:]
        spread = self._spread()
        fit = self._joint(spread)
        if self.vague:
            anywhere = self.prior.anywhere()
            lean = fit_leaning(
                [s.marks.get() for s in spread], [s.view for s in spread], self.rig, self.size,
                prior=anywhere,
            )  # fmt: skip
            if fit.cost - lean.cost > TILT_GAIN * SHARING:
                self.rig, self.prior = lean.rig, anywhere
                self._view_again(len(self.seen))
                return
        self.rig = fit.rig
        self._view_again(max(MEMORY, len(self._held)))  # by them the next are predicted

    def _view_again(self, count: int) -> None:
        """Fit the views of the last frames anew, with what is known by now of what they share."""
        last = self.seen[-count:]
        marks = [seen.marks.get() for seen in last]
        observed = Observations(joined(marks), self.size, counts=[len(m) for m in marks])
        fits = solve_views(observed, [seen.view for seen in last], self.rig, view_sd=HELD)
        self.seen[-count:] = [
            replace(seen, view=fit.view) for seen, fit in zip(last, fits, strict=True)
        ]

    def _spread(self) -> list[Seen]:
        """Give a few of the frames that fixed their camera, spread over all of them."""
        return spread([s for s in self.seen if s.found], REFINE_FRAMES)

    def _joint(self, frames: Sequence[Seen]) -> Solution:
        return solve(
            [s.marks.get() for s in frames], [s.view for s in frames], self.rig, self.size,
            prior=self.prior, iterations=10,
        )  # fmt: skip

    def explains(self, house: HouseFit) -> View | None:
        """Tell how the camera of this piece sees a house that was found; None if it does not.

        The frames of a piece may leave open where the camera is, but no two places explain all of
        them and the house as well.
        """
        marks = house.evidence.marks
        # Of a wide line, the other edge may have been found this time.
        marks = marks.pick(np.isin(marks.line, (TWELVE, EIGHT, FOUR, CENTRE_LINE, TEE_LINE)))
        near = solve_view(marks, house.view, self.rig, self.size, width=1e3, iterations=30)
        found = Seen(house.camera.frame, house.camera.t, near.view, Cached(marks), True)
        joint = self._joint([*self._spread(), found])
        well = min(good.mean() for good in joint.inliers) > LEAST_EXPLAINED
        if not well or joint.rms[-1] > 1.3 * house.rms_px + SAME_RMS_PX:
            return None
        self.rig = joint.rig
        return joint.views[-1]

    def enter(
        self, frame: Frame, view: View, marks: Marks, waiting: Sequence[Frame]
    ) -> list[tuple[Frame, Camera]]:
        """Begin, or go on after a gap, at a frame of known view and marks.

        Parameters
        ----------
        frame : Frame
        view, marks : View, Marks
            Of its house, as found.
        waiting : sequence of Frame
            Those before it, in order. At the beginning they wait for the first fit of what frames
            share: what is far from the rings would be sought in the wrong place.

        Returns
        -------
        list of (Frame, Camera)
            This frame and, before it, those to which it could be followed back through frames
            that wait, in order; as `take`.
        """
        before, self.seen, self.edges.stride = self.seen, [], 1
        self._zooms, self._doubtful = (float(view.vector[3]),) * 2, 0
        self._ice.forget()
        settled = self.edges.settle([frame], [view], self.rig, view)
        first = settled[0] if settled else Seen(frame.index, frame.t, view, Cached(marks), True)
        self._add(first, frame.picture)
        self._make_good(before)
        placed = [frame]
        if before:
            placed = [*self._followed_back(waiting, before, before[-1]), frame]
            self.seen = [*before, *reversed(self.seen)]
            self._picture = frame.picture
        else:
            self._waiting = [*waiting]
        self._fresh = []
        self._ice.forget()
        return self._held_back(placed)

    def _begin_earlier(self) -> None:
        """Follow back from the first frame to those before it, and go on from the last."""
        waiting, self._waiting = self._waiting, []
        after, self.seen = self.seen[1:], self.seen[:1]
        there = self._picture, self._ice, self._fresh, self._shaken, self.edges.stride
        self._picture, self._ice, self.edges.stride = self._held[0].picture, IceTracker(), 1
        self._held = [*self._followed_back(waiting, after), *self._held]
        self.seen = [*reversed(self.seen), *after]
        self._picture, self._ice, self._fresh, self._shaken, self.edges.stride = there

    def _followed_back(
        self, waiting: Sequence[Frame], others: list[Seen], before: Seen | None = None
    ) -> list[Frame]:
        """Follow back from the last frame through others, as far as it goes; these, in order.

        Frames that do not show rings where they should count if they lead to the one `before`.
        """
        left, placed = [*reversed(waiting)], []
        most = MOST_MISSED if before is None else 2 * MOST_MISSED
        while left and self.missed <= most and (followed := self.follow(left[: self.edges.stride])):
            for earlier, seen in zip(left, followed, strict=False):
                self._add(seen, earlier.picture)
                placed.append(earlier)
            self._make_good(others)
            del left[: len(followed)]
        if left or before is None or not self.goes_on_at(before.view):
            del placed[len(placed) - self._doubtful :]
            self.give_up_missed()
        self._doubtful = 0
        return placed[::-1]

    def camera(self, seen: Seen) -> Camera:
        """Give the provisional camera of a frame."""
        return camera(seen.view, self.rig, self.size, frame=seen.index, t=seen.t, found=seen.found)

    def _predicted(self, frames: Sequence[Frame]) -> list[View]:
        """Tell the views of the next frames by those of the last ones that followed each other."""
        last = self.seen[-MEMORY:]
        first = len(last) - 1
        while first > 0 and _follows(last[first], last[first - 1]):
            first -= 1
        last = last[first:]
        if abs(frames[-1].index - last[-1].index) > 2 * len(frames):
            return [last[-1].view] * len(frames)
        vectors = np.array([seen.view.vector for seen in last])
        ahead = predict([seen.t for seen in last], vectors, [frame.t for frame in frames])
        if not (last[-1].marks.get().line >= CIRCLES).any():
            ahead[:, ROLL] = vectors[-1, ROLL]  # circles do not tell it: it would run away
        return [View(vector) for vector in ahead]


def _length(way: Array) -> float:
    return float(np.linalg.norm(way))


def _follows(seen: Seen, before: Seen) -> bool:
    """Whether two frames are neighbours, or nearly."""
    return 0 < abs(seen.index - before.index) <= 2
