"""The shot again: stones glide, hit each other and come to rest, event by event.

Nothing is stepped through time. Each stone's path to rest is known in closed form (see
`curlshot.physics.simulator.motion.Path`); the first moment at which two paths come within two radii
is found by bounds on how far a path can leave its chord, so that no contact is stepped over however
fast the stones are; a hit gives two stones new paths.
"""

from __future__ import annotations

import math
from itertools import combinations

from curlshot.data.errors import InputError
from curlshot.data.results import StoneState
from curlshot.physics.impact import Before, Number
from curlshot.physics.simulator.approach import first_contact
from curlshot.physics.simulator.bounds import leaves_at
from curlshot.physics.simulator.event_queue import EventQueue
from curlshot.physics.simulator.motion import Motion, Path, Point
from curlshot.physics.simulator.simulation import HitEvent, Rest, Shot, Simulation, check_shot

TOUCHING = 1e-9
"""Gap up to which two stones touch, m."""
PRESSED = 1e-6
"""Overlap at which stones that lean on each other are set apart again, m."""
SLOW = 1e-3
"""Closing speed up to which two touching stones lean on each other and do not hit, m/s."""
SIMULTANEOUS = 1e-10
"""Contacts this close in time count as one moment, s."""
MAX_IMPULSES = 200_000
"""More than any shot needs."""


def simulate(shot: Shot, *, until: float | None = None) -> Simulation:
    """Let the stones of a shot glide and hit each other until all rest.

    Stones that touch are hit one pair at a time, in the order of the shot's stones where two
    pairs meet at one moment, until none of them closes. Stones that lean on each other
    without hitting (they touch and close by less than `SLOW`) push each other by small
    impulses, which are not listed as hits. Stones placed a little closer than two radii are taken
    to touch where they are, which gives no energy to either. A stone that leaves the shot's
    bounds is in nobody's way from then on.

    Parameters
    ----------
    shot : Shot
        Stones and laws.
    until : float, optional
        Time at which to end, s; else when all stones rest.

    Raises
    ------
    InputError
        Where stones share a name or lie in one another (`LARGEST_OVERLAP`), numbers make no sense,
        or a stone that is hit lacks the spin after the hit which the model needs.
    ValueError
        Where `until` lies before 0.
    """
    if until is not None and not until >= 0:
        raise ValueError(f"a simulation starts at t = 0: it cannot end at {until} s")
    check_shot(shot)
    return _Run(shot).run(math.inf if until is None else until)


_Now = tuple[Point, float, float]
"""Where a stone is, and its velocity, m/s."""


class _Run:
    """The state of a simulation under way."""

    def __init__(self, shot: Shot) -> None:
        self.shot = shot
        self.t = 0.0
        self.hits: list[HitEvent] = []
        self.hit_count = [0] * len(shot.stones)
        self.paths: list[list[Path]] = [[] for _ in shot.stones]
        self.leaves: dict[int, float] = {}
        self.gone: dict[int, float] = {}
        for k, stone in enumerate(shot.stones):
            motion = Motion(stone.x, stone.y, stone.theta, stone.vx, stone.vy, stone.omega)
            self._set_off(k, motion)
        # Stones that were placed too close keep the distance that they had.
        self.reach = {
            (i, j): min(2 * shot.radius, math.dist((a.x, a.y), (b.x, b.y)))
            for (i, a), (j, b) in combinations(enumerate(shot.stones), 2)
        }
        self.events = EventQueue()
        self.here: dict[int, _Now] = {}
        for k, stone in enumerate(shot.stones):
            if stone.vx or stone.vy:
                self._look_ahead(k)

    def run(self, until: float) -> Simulation:
        """Go from contact to contact."""
        for _ in range(MAX_IMPULSES):
            pair = self._next_pair(until)
            if pair is None:
                break
            self.t = max(self.t, self.events.time(pair))
            self._hit(*pair)
            self.here.clear()
            for k in pair:
                self._look_ahead(k)
        else:
            raise InputError(f"shot: more than {MAX_IMPULSES} impulses: set fewer stones to touch")
        names = [stone.name for stone in self.shot.stones]
        return Simulation(
            tuple(self.hits),
            {name: self._rest(k, until) for k, name in enumerate(names)},
            {name: tuple(paths) for name, paths in zip(names, self.paths, strict=True)},
            {names[k]: t for k, t in self.gone.items()},
        )

    def _set_off(self, k: int, motion: Motion) -> None:
        """Give stone `k` a new path from now on."""
        shot = self.shot
        path = Path(self.t, motion, shot.ice, shot.curl)
        paths = self.paths[k]
        if paths and paths[-1].start >= self.t:
            paths.pop()  # it never came into effect
        paths.append(path)
        if shot.bounds is not None:
            hit = self.hit_count[k] > 0
            self.leaves[k] = leaves_at(path, shot.bounds, shot.radius, hit=hit)

    def _look_ahead(self, k: int) -> None:
        """Bound the next contacts of stone `k`.

        Stones only get slower until they meet. And the rate at which two come nearer grows with
        their accelerations at most: that they pass each other sideways adds to their distance.
        """
        path = self.paths[k][-1]
        (x, y, speed, _), vx, vy = self._now(k)
        for other, paths in enumerate(self.paths):
            if other == k or other in self.gone:
                continue
            pair = (k, other) if k < other else (other, k)
            ahead = paths[-1]
            (x2, y2, speed2, _), vx2, vy2 = self.here.get(other) or self._now(other)
            dx, dy = x2 - x, y2 - y
            distance = math.hypot(dx, dy)
            gap = distance - self.reach[pair]
            fastest = speed + speed2
            if fastest == 0 or gap > path.length + ahead.length:
                self.events.drop(pair)
                continue
            rate = ((vx2 - vx) * dx + (vy2 - vy) * dy) / distance
            change = path.change + ahead.change
            if gap <= 0:
                soonest = 2 * rate / change if rate > 0 else 0.0
            else:
                root = math.sqrt(rate * rate + 2 * change * gap)
                soonest = (root + rate) / change if rate > 0 else 2 * gap / (root - rate)
                soonest = max(soonest, gap / fastest)
            self.events.expect(self.t + soonest, pair, exact=False)

    def _now(self, k: int) -> _Now:
        """Where stone `k` is at present; asked for once for each of the others."""
        now = self.here.get(k)
        if now is None:
            point = self.paths[k][-1].point(self.t)
            _, _, speed, heading = point
            now = point, speed * math.cos(heading), speed * math.sin(heading)
            self.here[k] = now
        return now

    def _next_pair(self, until: float) -> tuple[int, int] | None:
        """Return the pair that meets next; None where none does by then."""
        while True:
            first = self.events.first()
            if self.leaves:
                k = min(self.leaves, key=self.leaves.__getitem__)
                if self.leaves[k] <= min(first, until) and self.leaves[k] < math.inf:
                    self._take_away(k)
                    continue
            if first > until or first == math.inf:
                return None
            due = self.events.due(first + SIMULTANEOUS)
            if all(exact for _, _, exact in due):
                return min(pair for _, pair, _ in due)
            for _, pair, exact in due:
                if not exact:
                    self.events.expect(self._next_contact(*pair, until), pair, exact=True)

    def _take_away(self, k: int) -> None:
        """Take a stone that leaves the play off the sheet."""
        self.gone[k] = self.leaves.pop(k)
        self.events.drop_all_of(k)

    def _rest(self, k: int, until: float) -> Rest:
        """Place at which stone `k` came to rest, left the play or was at the end."""
        path = self.paths[k][-1]
        rest = max(path.rest, path.start) if path.rest > 0 else 0.0
        t = min(self.gone.get(k, rest), until)
        motion = path.at(t)
        return Rest(motion.x, motion.y, motion.theta, t, in_play=k not in self.gone)

    def _next_contact(self, i: int, j: int, until: float) -> float:
        """Time of the next contact of two stones, inf where there is none by then."""
        a, b = self.paths[i][-1], self.paths[j][-1]
        if a.stop <= self.t and b.stop <= self.t:
            return math.inf
        pa, pb = self._now(i)[0], self._now(j)[0]
        distance = math.dist(pa[:2], pb[:2])
        reach = self.reach[i, j]
        if distance - reach > a.length + b.length:
            return math.inf
        if distance <= reach + TOUCHING:
            if _closing(a.at(self.t), b.at(self.t)) > SLOW:
                return self.t
            reach = min(reach, distance) - PRESSED
        return first_contact(a, b, self.t, (pa, pb), reach, until)

    def _hit(self, i: int, j: int) -> None:
        """Resolve the contact of stones `i` and `j` at the present time."""
        shot = self.shot
        one, two = self.paths[i][-1].at(self.t), self.paths[j][-1].at(self.t)
        if math.hypot(two.vx, two.vy) > math.hypot(one.vx, one.vy):
            i, j, one, two = j, i, two, one
        first, second = shot.stones[i], shot.stones[j]
        dx, dy = two.x - one.x, two.y - one.y
        distance = math.hypot(dx, dy)
        n = (dx / distance, dy / distance)
        closing = _closing(one, two)
        listed = closing > SLOW
        if closing > 0:
            spins = (one.omega, two.omega)
            if listed:
                spins = self._spin_after(i, one.omega), self._spin_after(j, two.omega)
            sliding = (two.vx - one.vx) * n[1] - (two.vy - one.vy) * n[0]
            change = shot.impact.change(
                Before(
                    closing, sliding, one.omega, two.omega, first.mass, second.mass, shot.radius,
                    spins,
                )
            )  # fmt: skip
            new_one = _changed(one, n, change.along1, change.aside1, change.w1)
            new_two = _changed(two, n, change.along2, change.aside2, change.w2)
        else:
            new_one, new_two = one, two
        if listed:
            before = {first.name: _state(one), second.name: _state(two)}
            then = {first.name: _state(new_one), second.name: _state(new_two)}
            self.hits.append(HitEvent(self.t, (first.name, second.name), n, before, then))
            self.hit_count[i] += 1
            self.hit_count[j] += 1
        overlap = self.reach[min(i, j), max(i, j)] - distance
        if overlap > TOUCHING:
            # Set apart about their centre of mass.
            share = first.mass / (first.mass + second.mass)
            new_one = _moved(new_one, n, -overlap * (1 - share))
            new_two = _moved(new_two, n, overlap * share)
        if new_one is not one:
            self._set_off(i, new_one)
            self._set_off(j, new_two)

    def _spin_after(self, k: int, omega: float) -> float:
        """Spin of stone `k` after its present hit, as far as the model asks for it."""
        if not self.shot.impact.needs_spin_after:
            return omega
        stone = self.shot.stones[k]
        given = stone.omega_after
        if given is None or given == ():
            raise InputError(
                f"stone {stone.name} is hit at t = {self.t:.3f} s but has no omega_after:"
                " the rigid-body model needs its spin after the hit"
            )
        if isinstance(given, tuple):
            return given[min(self.hit_count[k], len(given) - 1)]
        return given


def _closing(one: Motion, two: Motion) -> float:
    """Speed at which two stones close, m/s."""
    dx, dy = two.x - one.x, two.y - one.y
    return ((one.vx - two.vx) * dx + (one.vy - two.vy) * dy) / math.hypot(dx, dy)


def _changed(
    motion: Motion, n: tuple[float, float], along: Number, aside: Number, omega: Number
) -> Motion:
    """Motion with its velocity changed along a normal and aside of it, and a new spin."""
    vx, vy = motion.vx + along * n[0] - aside * n[1], motion.vy + along * n[1] + aside * n[0]
    return motion._replace(vx=float(vx), vy=float(vy), omega=float(omega))


def _moved(motion: Motion, n: tuple[float, float], by: float) -> Motion:
    return motion._replace(x=motion.x + by * n[0], y=motion.y + by * n[1])


def _state(motion: Motion) -> StoneState:
    return StoneState(motion.x, motion.y, motion.vx, motion.vy, motion.omega)
