"""Known stones through the pictures of a clip: each measured where it is expected to be.

A stone that is not where it is expected, as after a hit, is sought nearby. What the next few
pictures show of stones that keep their course, or their rest, is measured for all of these
pictures at once, which costs a third of doing it picture by picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import dist, hypot, inf

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.association.expected import ON_COURSE, SETTLED, look_beside, look_on_course
from curlshot.vision.association.hits import MOTION_TOLD, struck
from curlshot.vision.association.lead import DOUBTFUL, Lead
from curlshot.vision.association.still import portraits, unchanged
from curlshot.vision.detection.appearance import Appearance, colour_difference, other_stone
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.seek import Bounds
from curlshot.vision.detection.stones import NEAREST, Search, search_picture
from curlshot.vision.optics import projection
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.disk_cache import DiskCache
from curlshot.vision.video.frame import Frame

Array = NDArray[np.float64]

Place = tuple[float, float]

Foreseen = tuple[Place, Detection | None]
"""Where a stone was expected some pictures before, and what was seen there, if one was."""

STILL = 0.03
"""How far from where it rests a stone may be seen, in radii."""

BLOCK = 8
"""Pictures that are looked at together."""

WAIT = 0.3
"""Time for which a stone is still looked for where it is expected, s."""

WAIT_AT_REST = 2.0
"""The same for one that rested: who covers it may do so for long, and show it now and then."""

TRUST = 0.5
"""Time from one measurement of a stone that looks unchanged to the next, s; it is due when a block
begins."""

AT_STAKE = 3.0
"""How near to a stone at rest, in radii, another one is to pass for it to be due in every block:
they meet at two, and until it is measured anew a stone is as far aside as it was seen, by 0.5 mm
in films, which makes much of how they part."""

REACH = 1.5
"""How far, in radii, a stone may be from where it is expected or from where it was."""


@dataclass(frozen=True)
class StoneView:
    """A picture with its camera, the stones seen in it so far and the camera of that before it."""

    frame: Frame
    camera: Camera
    detections: list[Detection] = field(default_factory=list)
    before: Camera | None = None

    @property
    def places(self) -> Array:
        """Of the stones, m, shape (n, 2)."""
        return _places(self.detections)

    def put_aside(self, cache: DiskCache) -> None:
        """Put aside how the caps of its stones look."""
        for detection in self.detections:
            if detection.spectrum is not None:
                detection.spectrum.put_aside(cache)

    def look(self, places: Sequence[Place], drift: Sequence[Place] | None = None) -> Look:
        """Look at places on the ice in it; what is there drifts so far from picture to picture."""
        at = _array(places)
        moving = None if drift is None else self.drift_seen(at, _array(drift))
        return Look(self.frame.picture, self.camera, at, moving)

    def drift_seen(self, places: Array, drift: Array) -> Array:
        """Tell how far across the picture stones move that drift on the ice, (n, 2), m at places.

        That is by what they are smeared: a pan smears those at rest, and not one that it follows.
        """
        if self._onto is None or not len(places):
            return drift
        return drift + places - projection.apply_homography(self._onto, places)

    @cached_property
    def _onto(self) -> Array | None:
        """Where the picture before shows places, on the ice of this one: a homography."""
        if self.before is None:
            return None
        # Both pictures are distorted alike.
        return np.asarray(np.linalg.solve(self.camera.homography, self.before.homography))


@dataclass(frozen=True)
class Follower:
    """Follows stones of which it is known what they look like.

    Attributes
    ----------
    appearance : Appearance or None
        None for plain discs.
    disc : Stone
    search : Search
    """

    appearance: Appearance | None
    disc: Stone
    search: Search

    def follow(self, views: Sequence[StoneView], leads: Sequence[Lead]) -> list[Lead]:
        """Add to views, one after the other, the stones to which leads point.

        Parameters
        ----------
        views : sequence of StoneView
            In the order of the clip, or against it.
        leads : sequence of Lead
            To stones of the picture before.

        Returns
        -------
        list of Lead
            Where those in the last view lead on to.
        """
        for begin in range(0, len(views), BLOCK):
            block = views[begin : begin + BLOCK]
            step = _time_between(block, leads)
            ahead = self._ahead(block, leads, step)
            for k in range(len(block)):
                leads = self._step(block[k:], leads, ahead[k:], step)
        return list(leads)

    def _step(
        self,
        views: Sequence[StoneView],
        leads: Sequence[Lead],
        ahead: Sequence[list[Foreseen]],
        step: float,
    ) -> list[Lead]:
        """Add to the first of views the stones to which leads point; some were measured ahead."""
        if not leads:
            return []
        view, t = views[0], views[0].frame.t
        apart = NEAREST * self.disc.radius
        near, still = ON_COURSE * self.disc.radius, STILL * self.disc.radius
        expected = [lead.at(t) for lead in leads]
        found = self._measured(views, leads, expected, ahead, step)
        going: list[tuple[Lead, Detection | None]] = []
        lost: list[int] = []
        # The best first: of two leads to one stone, the other is lost.
        for index in sorted(range(len(leads)), key=lambda i: -_score(found[i])):
            lead, detection = leads[index], found[index]
            if _away(view.detections, *expected[index]) < 0.5 * self.disc.radius:
                continue  # it leads to a stone that is followed already
            if detection is None or _away(view.detections, detection.x, detection.y) < apart:
                lost.append(index)
                continue
            view.detections.append(detection)
            going.append((lead.on(detection, t, near, still), detection))
        hit = _struck(leads, t, self.disc.radius) if lost else {}
        for index in lost:
            lead = leads[index]
            nearby = None if lead.missed else self._near(view, lead)
            if nearby is not None:
                view.detections.append(nearby)
                going.append((lead.on(nearby, t, near, still), nearby))
                continue
            since = abs(t - lead.t)
            if since < (WAIT_AT_REST if lead.rests else WAIT):
                going.append((replace(lead, missed=True), None))
            if index in hit and not lead.missed and since < WAIT:
                going.append((lead.pushed(*hit[index], t), None))
        return self._portrayed(view, going, ahead[1] if len(views) > 1 else [])

    def _ahead(
        self, views: Sequence[StoneView], leads: Sequence[Lead], step: float
    ) -> list[list[Foreseen]]:
        """Measure at once what views show of stones that rest or keep their course."""
        if not leads:
            return [[] for _ in views]
        known = {
            i: lead.portrait for i, lead in enumerate(leads) if lead.portrait and not lead.missed
        }
        pictures = [(view.frame.picture, view.camera) for view in views]
        alike = [
            {i: detection for i, detection in zip(known, seen, strict=True) if detection}
            for seen in unchanged(pictures, list(known.values()), self.disc)
        ]
        # Now and then even what looks unchanged is measured, and oftener what may be hit.
        t, near = views[0].frame.t, AT_STAKE * self.disc.radius
        moving = [lead for lead in leads if not lead.rests]
        for i, portrait in known.items():
            at_stake = any(lead.nears(leads[i].place, t, near) for lead in moving)
            if at_stake or abs(t - portrait.t) >= TRUST:
                alike[0].pop(i, None)
        out: list[list[Foreseen]] = []
        looks = []
        for view, seen in zip(views, alike, strict=True):
            expected = [lead.at(view.frame.t) for lead in leads]
            others = [i for i in range(len(leads)) if i not in seen]
            out.append([(expected[i], detection) for i, detection in seen.items()])
            looks.append(_look_at(view, leads, expected, others, step))
        if any(len(look.places) for look in looks):
            measured = iter(look_on_course(looks, self.appearance, self.disc, self.search))
            for so_far, look in zip(out, looks, strict=True):
                so_far += [((x, y), next(measured)) for x, y in look.places.tolist()]
        return out

    def _measured(
        self,
        views: Sequence[StoneView],
        leads: Sequence[Lead],
        expected: Sequence[Place],
        ahead: Sequence[list[Foreseen]],
        step: float,
    ) -> list[Detection | None]:
        """Look at each stone where it is expected, unless it was measured ahead.

        One that has taken another course, as after a hit, is measured ahead anew.
        """
        view = views[0]
        nearest = [_nearest(ahead[0], place) for place in expected]
        course, settled = ON_COURSE * self.disc.radius, SETTLED * self.disc.radius
        found = [seen if away < course else None for away, seen in nearest]
        others = [
            index
            for index, (lead, (away, _)) in enumerate(zip(leads, nearest, strict=True))
            # What was missed before is not expected so precisely.
            if found[index] is None and away > (course if lead.missed else settled)
        ]
        if others:
            anew = self._ahead(views, [leads[i] for i in others], step)
            for so_far, more in zip(ahead, anew, strict=True):
                so_far += more
            for index in others:
                found[index] = _nearest(anew[0], expected[index])[1]
        astray = [
            index
            for index, (lead, detection) in enumerate(zip(leads, found, strict=True))
            if not lead.missed and _score(detection) < DOUBTFUL * lead.score
        ]
        if astray:
            look = _look_at(view, leads, expected, astray, step)
            seen = look_beside(
                look, [found[i] for i in astray], self.appearance, self.disc, self.search
            )
            for index, detection in zip(astray, seen, strict=True):
                if _score(found[index]) < DOUBTFUL * _score(detection):
                    found[index] = detection
        return found

    def _portrayed(
        self,
        view: StoneView,
        going: Sequence[tuple[Lead, Detection | None]],
        after: Sequence[Foreseen],
    ) -> list[Lead]:
        """Take the portraits of the stones at rest that were measured, and will not be next."""
        leads = [lead for lead, _ in going]
        measured = [seen for _, seen in after if seen is not None and seen.measured]
        due = [
            (index, detection)
            for index, (lead, detection) in enumerate(going)
            if lead.rests and detection is not None and detection.measured
            if _away(measured, detection.x, detection.y) > STILL * self.disc.radius
        ]
        taken = portraits(
            view.frame.picture, view.camera, view.frame.t, [s for _, s in due], self.disc
        )
        for (index, _), portrait in zip(due, taken, strict=True):
            leads[index] = replace(leads[index], portrait=portrait)
        return leads

    def _near(self, view: StoneView, lead: Lead) -> Detection | None:
        """Seek a stone that is not where it is expected about there and about its last place.

        What is there in another colour is no such stone, but another one, or a jersey's sleeve.
        """
        either = np.array([lead.at(view.frame.t), lead.place])
        reach = REACH * self.disc.radius
        low = either.min(0) - reach - self.disc.radius
        high = either.max(0) + reach + self.disc.radius
        bounds = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
        found = self.sought(view, bounds)
        if lead.colour is not None:
            other, known = other_stone(self.appearance), lead.colour
            found = [one for one in found if colour_difference(one.colour, known) < other]
        away = [min(float(np.hypot(*(place - e))) for e in either) for place in _places(found)]
        if not away or min(away) > reach:
            return None
        return found[int(np.argmin(away))]

    def sought(self, view: StoneView, bounds: Bounds | None = None) -> list[Detection]:
        """Stones on a part of the ice, or on all of it, that were not seen in the view so far."""
        found = search_picture(
            view.frame.picture,
            view.camera,
            self.appearance,
            self.disc,
            self.search,
            bounds,
            view.places,
        )
        return [detection.without_samples() for detection in found.stones]


def _look_at(
    view: StoneView,
    leads: Sequence[Lead],
    expected: Sequence[Place],
    which: Sequence[int],
    step: float,
) -> Look:
    """Look where some of the stones are expected that drift as their leads do."""
    return view.look([expected[i] for i in which], [leads[i].drift(step) for i in which])


def _struck(leads: Sequence[Lead], t: float, radius: float) -> dict[int, tuple[Array, Array]]:
    """Where stones are and how they move at a time that have met since: by ranks of their leads."""
    return struck(
        _array([lead.place for lead in leads]),
        _array([lead.velocity for lead in leads]),
        np.array([lead.t for lead in leads]),
        np.array([lead.rests or lead.along >= MOTION_TOLD for lead in leads]),
        t,
        radius,
    )


def _time_between(views: Sequence[StoneView], leads: Sequence[Lead]) -> float:
    """Time from one picture to the next, s; 0 where nothing tells it."""
    times = [view.frame.t for view in views]
    gaps = np.abs(np.diff(times)) if len(times) > 1 else [abs(times[0] - lead.t) for lead in leads]
    return float(np.min(gaps)) if len(gaps) else 0.0


def _away(detections: Sequence[Detection], x: float, y: float) -> float:
    """Distance from a place to the nearest of the stones seen, m."""
    return min((hypot(s.x - x, s.y - y) for s in detections), default=inf)


def _nearest(ahead: Sequence[Foreseen], place: Place) -> tuple[float, Detection | None]:
    """Give what was measured ahead nearest to a place, and how far from it, m."""
    away = [(dist(place, start), seen) for start, seen in ahead]
    return min(away, key=lambda found: found[0], default=(inf, None))


def _score(detection: Detection | None) -> float:
    return -1.0 if detection is None else detection.score


def _places(detections: Sequence[Detection]) -> Array:
    return _array([(s.x, s.y) for s in detections])


def _array(places: Sequence[Place]) -> Array:
    return np.array(places, float).reshape(-1, 2)
