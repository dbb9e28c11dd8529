"""The stones of a clip, frame by frame: known ones followed, new ones sought now and then.

Searching a picture for stones costs ten times what measuring them does. So known stones are
followed (`curlshot.vision.association.follower`), and now and then all of the ice is searched. What
such a search finds anew is followed back through the last pictures, so that nothing is lost by
searching rarely.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from curlshot.data.sheet import STONE, Stone
from curlshot.vision.association.again import measure_again
from curlshot.vision.association.follower import BLOCK, Follower, StoneView
from curlshot.vision.association.lead import Lead
from curlshot.vision.association.rows import Rows
from curlshot.vision.detection.appearance import (
    MOST_COLOURS,
    UNLIKE,
    Appearance,
    by_colour,
    convincing,
    learn,
)
from curlshot.vision.detection.balance import Balance, brightening, tones
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.patch import is_plain
from curlshot.vision.detection.placing import placed_by
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import FOLLOWING, SEARCH, Search
from curlshot.vision.detection.strangers import strangers
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.disk_cache import Cached, DiskCache
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Image, brightened, toned

AT_ONCE = 64
"""Pictures whose stones are placed together in the end: more take memory, and no less time each."""

MOST_KEPT = 24 * 1920 * 1080
"""Pixels that the pictures kept may have together: beyond that there are fewer of them."""

MEMORY = 24
"""Pictures that are kept to learn from and to follow stones back through, fewer if they are very
large; when so many are new, the last of them is searched."""

HURRY = 8
"""The same while a stone that rested is hidden: hit unseen, it may show for a moment only; and
while none is seen of those that are known: they may come at any time."""

LESSON, DOUBTFUL_LESSON = 8, 2
"""One in so many of them is looked at to learn what the stones look like, and one in so many where
those show a stone, but none that convinces."""

MOST_LESSONS = 200
"""After so many detections that taught, none of another colour is learned from."""


ROOM = 1000
"""Pictures of caps, 7 kB each, and pictures' detections, 2 kB, that need not be put aside."""


def pictures_kept(size: tuple[int, int]) -> int:
    """How many pictures of a size, px, are kept; never fewer than in a hurry."""
    width, height = size
    return min(MEMORY, max(MOST_KEPT // (width * height), HURRY))


class Watch:
    """Looks at the frames of a clip in their order.

    Parameters
    ----------
    disc : Stone
        Size of the stones, or `curlshot.vision.detection.stones.plain_disc`.
    search : Search
        Where stones are sought and what they must show.
    """

    def __init__(
        self, disc: Stone = STONE, search: Search = FOLLOWING, finer: Search = SEARCH
    ) -> None:
        self.appearance: Appearance | None = None
        self.disc, self._search, self._finer = disc, search, finer
        self._lessons: list[Detection] = []
        self._waiting: list[StoneView] = []
        self._recent: deque[StoneView] = deque()
        self._cache = DiskCache(ROOM)
        self._balance: Balance | None = None
        self._gain = np.ones(3)
        self._tones: Image | None = None
        self._before: Camera | None = None
        self._leads: list[Lead] = []
        self._since = self._most = MEMORY
        self._searched_first = False
        self._seen: dict[int, Cached[Sequence[Detection]]] = {}

    def look(self, frame: Frame, camera: Camera) -> None:
        """Take in a frame; it waits for some more, the first ones until the stones are learned."""
        self._most = pictures_kept(camera.size)
        if not self._knows:
            self._gain = np.full(3, brightening(frame.picture, camera))
        lit = brightened(frame.picture, self._gain)
        frame = replace(frame, picture=toned(lit, self._tones))
        if self._balance is not None:
            if not self._waiting:
                self._balance.look(frame.picture, camera)
            frame = replace(frame, picture=self._balance.evened(frame.picture))
        view = StoneView(frame, camera, before=self._before)
        self._before = camera
        self._waiting.append(view)
        # The next search goes back no farther: no more pictures than that are held at all.
        while self._recent and len(self._recent) + len(self._waiting) > self._most:
            self._put_aside(self._recent.popleft())
        self._seen[frame.index] = Cached(view.detections)
        if len(self._waiting) >= (BLOCK if self._knows else self._most):
            self._catch_up()

    @property
    def begun(self) -> bool:
        """Whether a frame has been looked at."""
        return bool(self._seen)

    def finish(self, cameras: Sequence[Camera]) -> Iterator[tuple[int, float, Sequence[Detection]]]:
        """Give the number, the time and the detections of each frame, once.

        Parameters
        ----------
        cameras : sequence of Camera
            As they are known by now, and at the times at which the frames were taken: they place
            the stones, and tell the errors that their detections share; frames without one are left
            out.
        """
        self._catch_up()
        if self._since and self._recent:
            self._search_for_new(self._recent[-1])
        self._recent.clear()  # no picture is looked at any more: they take a quarter of all memory
        return self._placed([camera for camera in cameras if camera.frame in self._seen])

    def _placed(self, known: Sequence[Camera]) -> Iterator[tuple[int, float, Sequence[Detection]]]:
        for begin in range(0, len(known), AT_ONCE):
            some = known[begin : begin + AT_ONCE]
            seen = [self._seen.pop(camera.frame).get() for camera in some]
            placed = placed_by(some, seen, self._shown)
            yield from ((one.frame, one.t, each) for one, each in zip(some, placed, strict=True))
        self._seen.clear()

    @property
    def _knows(self) -> bool:
        return self.appearance is not None or is_plain(self.disc)

    @property
    def _shown(self) -> Stone:
        """Size of the discs, their caps as large as they show."""
        share = 1.0 if self.appearance is None else self.appearance.outline[0]
        return replace(self.disc, cap_radius=share * self.disc.cap_radius)

    @property
    def _follower(self) -> Follower:
        return Follower(self.appearance, self.disc, self._search)

    def _catch_up(self) -> None:
        if self._waiting and not self._knows:
            self._recent.clear()
            self._learn(self._waiting)
            if self.appearance is not None and self._tones is None:
                self._lift(self.appearance)
            if self._knows:
                self._balance = Balance(self._waiting[-1].frame.picture, self._waiting[-1].camera)
        for begin in range(0, len(self._waiting), BLOCK):
            self._see(self._waiting[begin : begin + BLOCK])
        self._waiting = []
        if self._knows and self._recent and not self._searched_first:
            self._searched_first = True
            self._search_first()

    def _learn(self, views: Iterable[StoneView]) -> None:
        views = list(views)[::-1]
        found = self._of_any_colour(views[::LESSON], self._search.radius_px)
        if len(by_colour([*self._lessons, *convincing(found)])) < MOST_COLOURS:
            found = self._of_any_colour(views[::LESSON])
        if found and not convincing(found):
            # A stone far away convinces in some pictures only.
            found = self._of_any_colour(views[1::DOUBTFUL_LESSON])
        self._lessons += convincing(found)
        self.appearance = learn(self._lessons)

    def _lift(self, learned: Appearance) -> None:
        """Lift dark tones if what was learned shows that they are too dark, and learn anew."""
        last = self._waiting[-1]
        self._tones = tones(last.frame.picture, last.camera, learned.granite)
        if self._tones is None:
            return
        as_they_are = self._waiting, self._lessons
        self._waiting = [
            replace(view, frame=replace(frame, picture=toned(frame.picture, self._tones)))
            for view, frame in ((view, view.frame) for view in self._waiting)
        ]
        self._lessons = []
        self._learn(self._waiting)
        if self.appearance is None:  # what seemed to be granite belongs to no stone
            self._tones, self.appearance = None, learned
            self._waiting, self._lessons = as_they_are

    def _of_any_colour(
        self, views: Iterable[StoneView], radius_px: float | None = None
    ) -> list[Detection]:
        """Stones of any colour that were not seen in the views so far.

        A dull cap on vivid paint answers too faintly on a map much coarser than that of `SEARCH`.
        """
        # Too much on the ice answers faintly to any colour.
        fine = self._finer.radius_px
        radius_px = fine if radius_px is None else radius_px
        response = self._finer.min_response
        search = replace(self._search, min_response=response, radius_px=radius_px)
        looks = [Look(view.frame.picture, view.camera, view.places) for view in views]
        rough = radius_px < fine
        found, disc = strangers(looks, self.disc, search, bool(self._lessons), rough)
        stones = [stone for one in found for stone in one.stones]
        if convincing(stones):
            self.disc = disc
        return stones

    def _see(self, views: Sequence[StoneView]) -> None:
        """Follow what is known through views, and search the last of them if it is time."""
        if self._knows:
            self._leads = self._follower.follow(views, self._leads)
        self._recent.extend(views)
        self._since += len(views)
        if self._since >= (HURRY if self._misses(views[-1]) else self._most):
            self._search_for_new(views[-1])

    def _put_aside(self, view: StoneView) -> None:
        """Keep of a view that is done what takes little memory."""
        view.put_aside(self._cache)
        rows: Cached[Sequence[Detection]] = Cached(Rows(view.detections))
        rows.put_aside(self._cache)
        self._seen[view.frame.index] = rows

    def _misses(self, view: StoneView) -> bool:
        """Whether none of the known stones is followed, or a view shows where one is missed."""
        if not self._leads:
            return self._knows
        missed = np.array([lead.place for lead in self._leads if lead.missed]).reshape(-1, 2)
        seen = view.camera.project(missed, self.disc.cap_height)
        return bool(np.any(np.all((seen > 0) & (seen < view.camera.size), axis=1)))

    def _search_for_new(self, view: StoneView) -> None:
        """Search all the ice; follow what is found back through the last pictures."""
        not_searched, self._since = [*self._recent][-self._since - 1 :], 0
        fresh = self._find(view)
        if self._look_for_colours(view):
            fresh += self._find(view)
        leads = [Lead.to(detection, view.frame.t) for detection in fresh]
        if self._knows:
            before = self._follower.follow([*self._recent][-2::-1], leads)
            leads = [lead.if_rested(before) for lead in leads]
        self._leads += leads
        if self.appearance is not None:
            measure_again(not_searched, self.appearance, self.disc, self._search)

    def _search_first(self) -> None:
        """Search the first picture too: what lies there may be hidden in the next one searched."""
        first, *others = self._recent
        leads = [Lead.to(detection, first.frame.t) for detection in self._find(first)]
        self._leads += self._follower.follow(others, leads)

    def _find(self, view: StoneView) -> list[Detection]:
        """Add to a view the stones of known colours that were not seen in it so far.

        What lies there before any is known is sought on a finer map: it answers more clearly there.
        So are plain discs, of which nothing but a rim answers.
        """
        finer = not self._leads or is_plain(self.disc)
        radius_px = (self._finer if finer else self._search).radius_px
        search = replace(self._search, radius_px=radius_px)
        fresh = replace(self._follower, search=search).sought(view)
        view.detections.extend(fresh)
        return fresh

    def _look_for_colours(self, view: StoneView) -> bool:
        """See whether there are stones of a colour that is not known yet, and learn it."""
        if self.appearance is None or len(self._lessons) >= MOST_LESSONS:
            return False
        shown = {self.appearance.nearest(stone.colour)[0] for stone in view.detections}
        if len(shown) == MOST_COLOURS:
            return False  # one more would take the place of one that is on the ice
        new = any(
            self.appearance.nearest(stone.colour)[1] > UNLIKE
            for stone in convincing(self._of_any_colour([view]))
        )
        if new:
            self._learn(self._recent)
        return new
