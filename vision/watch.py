"""The stones of a clip, frame by frame: known ones measured where expected, the rest sought.

Searching a picture for stones costs ten times what measuring them does. So each stone that is
known is measured where it is expected to be; where it is not, as after a hit, it is sought
nearby; and now and then all of the ice is searched. What such a search finds anew is followed
back through the last pictures, so that nothing is lost by searching rarely.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from math import hypot, inf

import numpy as np
from numpy.typing import NDArray

from data.sheet import STONE, Stone
from vision.appearance import CONVINCING, Appearance, colour_difference, learn
from vision.camera import Camera
from vision.clip import Frame
from vision.handle import cap_spectrum
from vision.lead import Lead
from vision.patch import handle_radii, is_plain
from vision.seek import Bounds
from vision.sighting import Sighting
from vision.still import portraits, unchanged
from vision.stones import FOLLOWING, Search, look_at, placed_by, search_picture

Array = NDArray[np.float64]

HANDLE_VISIBLE = 0.75
"""Share of a stone that must be seen for its angle to be measured."""

STILL = 0.03
"""How far from where it rests a stone may be seen, in radii."""

UNLIKE = 30.0
"""Difference of cap colours (L*a*b* units) from which a colour is a new one."""


@dataclass(frozen=True)
class Pace:
    """How often the ice is searched.

    Attributes
    ----------
    memory : int
        Pictures that are kept to learn from and to follow stones back through.
    lesson : int
        Each how manieth of them is looked at to learn what the stones look like.
    every : float
        Time from one search of all the ice to the next, s.
    colours : float
        Time from one search for stones of any colour to the next, s.
    patience : float
        Time for which a stone is still looked for where it is expected, s.
    trust : float
        Time from one measurement of a stone that looks unchanged to the next, s.
    reach : float
        How far, in radii, a stone may be from where it is expected or from where it was.
    """

    memory: int = 24
    lesson: int = 8
    every: float = 0.4
    colours: float = 0.8
    patience: float = 0.3
    trust: float = 0.25
    reach: float = 1.5


@dataclass(frozen=True)
class _View:
    frame: Frame
    camera: Camera
    sightings: list[Sighting] = field(default_factory=list)

    @property
    def places(self) -> Array:
        return _places(self.sightings)


class Watch:
    """Looks at the frames of a clip in their order.

    Parameters
    ----------
    disc : Stone
        Size of the stones, or `vision.stones.plain_disc`.
    """

    def __init__(self, disc: Stone = STONE, search: Search = FOLLOWING, pace: Pace = Pace()):
        self.appearance: Appearance | None = None
        self.disc, self._search, self._pace = disc, search, pace
        self._radii = handle_radii(disc)
        self._lessons: list[Sighting] = []
        self._waiting: list[_View] = []
        self._recent: deque[_View] = deque(maxlen=pace.memory)
        self._leads: list[Lead] = []
        self._searched = -np.inf
        self._checked = -np.inf
        self._seen: list[tuple[int, float, Camera, list[Sighting]]] = []

    def look(self, frame: Frame, camera: Camera) -> None:
        """Take in a frame; the first ones wait until the look of the stones is learned."""
        view = _View(frame, camera)
        self._waiting.append(view)
        self._seen.append((frame.index, frame.t, camera, view.sightings))
        if self._knows or len(self._waiting) >= self._pace.memory:
            self._catch_up()

    @property
    def begun(self) -> bool:
        """Whether a frame has been looked at."""
        return bool(self._seen)

    def finish(
        self, cameras: Sequence[Camera] | None = None
    ) -> list[tuple[int, float, list[Sighting]]]:
        """Give the number, the time and the sightings of each frame.

        Parameters
        ----------
        cameras : sequence of Camera, optional
            What is known of the cameras by now: it places the stones; frames without one are
            left out. Else the cameras stand with which the frames were looked at.
        """
        self._catch_up()
        if cameras is None:
            return [(frame, t, seen) for frame, t, _, seen in self._seen]
        final = {camera.frame: camera for camera in cameras}
        placed = []
        for frame, t, camera, seen in self._seen:
            if frame in final:
                known = final[frame]
                anew = seen if known is camera else placed_by(known, seen, self.disc)
                placed.append((frame, t, anew))
        return placed

    @property
    def _knows(self) -> bool:
        return self.appearance is not None or is_plain(self.disc)

    def _catch_up(self) -> None:
        if not self._knows:
            self._recent.clear()
            self._learn(self._waiting)
        for view in self._waiting:
            self._see(view)
        self._waiting = []

    def _learn(self, views: Iterable[_View]) -> None:
        for view in list(views)[:: self._pace.lesson]:
            self._lessons += self._convincing(view, np.empty((0, 2)))
        self.appearance = learn(self._lessons)

    def _convincing(self, view: _View, known: Array) -> list[Sighting]:
        """Stones of any colour."""
        found = search_picture(
            view.frame.picture, view.camera, None, self.disc, self._search, None, known
        )
        return [stone for stone in found.stones if stone.score > CONVINCING]

    def _see(self, view: _View) -> None:
        t = view.frame.t
        self._leads = self._follow(view, self._leads)
        if t - self._searched >= self._pace.every:
            self._searched = t
            self._look_for_colours(view)
            fresh = self._sought(view, None, view.places)
            leads = [Lead.to(sighting, t) for sighting in fresh]
            view.sightings.extend(map(self._reduced, fresh))
            self._leads += leads
            for past in reversed(self._recent):
                if not leads:
                    break
                leads = self._follow(past, leads)
        self._recent.append(view)

    def _look_for_colours(self, view: _View) -> None:
        """See now and then whether there are stones of a colour that is not known yet."""
        if self.appearance is None or view.frame.t - self._checked < self._pace.colours:
            return
        self._checked = view.frame.t
        caps = [cap.mean for cap in self.appearance.caps]
        if any(
            min(colour_difference(cap, stone.colour) for cap in caps) > UNLIKE
            for stone in self._convincing(view, view.places)
        ):
            self._learn([*self._recent, view])

    def _sought(self, view: _View, bounds: Bounds | None, known: Array) -> tuple[Sighting, ...]:
        return search_picture(
            view.frame.picture,
            view.camera,
            self.appearance,
            self.disc,
            self._search,
            bounds,
            known,
        ).stones

    def _follow(self, view: _View, leads: Sequence[Lead]) -> list[Lead]:
        """Add to a view the stones to which the leads point; return where these lead on to."""
        t = view.frame.t
        if not leads or (self.appearance is None and not is_plain(self.disc)):
            return []
        apart = 1.6 * self.disc.radius
        near, still = 0.15 * self.disc.radius, STILL * self.disc.radius
        expected = np.array([lead.at(t) for lead in leads])
        found = self._measured(view, leads, expected)
        going: list[tuple[Lead, Sighting | None]] = []
        lost: list[Lead] = []
        # The best first: of two leads to one stone, the other is lost.
        for index in sorted(range(len(leads)), key=lambda i: -_score(found[i])):
            lead, sighting = leads[index], found[index]
            if _nearest(view.sightings, *expected[index].tolist()) < 0.5 * self.disc.radius:
                continue  # it leads to a stone that is followed already
            if sighting is None or _nearest(view.sightings, sighting.x, sighting.y) < apart:
                lost.append(lead)
                continue
            view.sightings.append(sighting)
            going.append((lead.on(sighting, t, near, still), sighting))
        for lead in lost:
            nearby = None if lead.missed else self._near(view, lead)
            if nearby is not None:
                view.sightings.append(self._reduced(nearby))
                going.append((lead.on(nearby, t, near, still), nearby))
            elif abs(t - lead.t) < self._pace.patience:
                going.append((replace(lead, missed=True), None))
        return self._portrayed(view, going)

    def _measured(
        self, view: _View, leads: Sequence[Lead], expected: Array
    ) -> list[Sighting | None]:
        """Look at each stone where it is expected; what rests and looks as it did, only briefly."""
        picture, camera = view.frame.picture, view.camera
        found: list[Sighting | None] = [None] * len(leads)
        resting = [
            (index, lead.portrait)
            for index, lead in enumerate(leads)
            if lead.portrait and abs(view.frame.t - lead.portrait.t) < self._pace.trust
        ]
        alike = unchanged(picture, camera, [portrait for _, portrait in resting], self.disc)
        for (index, _), sighting in zip(resting, alike, strict=True):
            found[index] = sighting
        others = [index for index, sighting in enumerate(found) if sighting is None]
        if others:
            measured = look_at(
                picture, camera, expected[others], self.appearance, self.disc, self._search
            )
            for index, sighting in zip(others, measured, strict=True):
                found[index] = sighting and self._reduced(sighting)
        return found

    def _portrayed(self, view: _View, going: Sequence[tuple[Lead, Sighting | None]]) -> list[Lead]:
        """Take the portraits of the stones at rest that have just been measured."""
        leads = [lead for lead, _ in going]
        due = [
            (index, sighting)
            for index, (lead, sighting) in enumerate(going)
            if lead.rests and sighting is not None and sighting.measured
        ]
        taken = portraits(
            view.frame.picture, view.camera, view.frame.t, [s for _, s in due], self.disc
        )
        for (index, _), portrait in zip(due, taken, strict=True):
            leads[index] = replace(leads[index], portrait=portrait)
        return leads

    def _near(self, view: _View, lead: Lead) -> Sighting | None:
        """Seek a stone that is not where it is expected about there and about its last place."""
        either = np.array([lead.at(view.frame.t), lead.place])
        reach = self._pace.reach * self.disc.radius
        low, high = either.min(0) - reach - self.disc.radius, either.max(0) + reach
        high = high + self.disc.radius
        bounds = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
        found = self._sought(view, bounds, view.places)
        away = [min(float(np.hypot(*(place - e))) for e in either) for place in _places(found)]
        if not away or min(away) > reach:
            return None
        return found[int(np.argmin(away))]

    def _reduced(self, sighting: Sighting) -> Sighting:
        """Reduce the pictures of a sighting to what the angle needs."""
        seen_well = sighting.visible >= HANDLE_VISIBLE
        return replace(
            sighting,
            handle=np.empty((0, 0, 3), np.uint8),
            spectrum=cap_spectrum(sighting.handle, self._radii) if seen_well else None,
            cap_samples=np.empty((0, 3)),
            granite_samples=np.empty((0, 3)),
        )


def _nearest(sightings: Sequence[Sighting], x: float, y: float) -> float:
    """Distance from a place to the nearest of the stones seen, m."""
    return min((hypot(s.x - x, s.y - y) for s in sightings), default=inf)


def _score(sighting: Sighting | None) -> float:
    return -1.0 if sighting is None else sighting.score


def _places(sightings: Sequence[Sighting]) -> Array:
    return np.array([(s.x, s.y) for s in sightings]).reshape(-1, 2)
