"""Variants of a shot under way together; see `curlshot.physics.simulator.many`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.physics.curl import Curl
from curlshot.physics.ice import IceLaw
from curlshot.physics.impact import resolve
from curlshot.physics.simulator.approach import (
    SHORTEST,
    all_crossings,
    all_nearest,
    all_slack,
    velocity,
)
from curlshot.physics.simulator.bounds import all_leave_at
from curlshot.physics.simulator.paths import CurveTable, Index, Paths
from curlshot.physics.simulator.simulate import PRESSED, SIMULTANEOUS, SLOW, TOUCHING, simulate
from curlshot.physics.simulator.simulation import Shot, States

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

FEW = 8
"""The last variants under way, each with more impulses than the others, go one by one."""
LONGEST = 4.0
"""Step to begin with, s."""
AFTER_HIT = 0.01
"""Step after a hit, s."""
LONGER, SHORTER = 4.0, 0.25
"""Factors of a step that was clear and of one that was not."""


class Batch:
    """Variants under way; (s, i) is stone i of variant s, and s * stones + i its path."""

    def __init__(
        self,
        shot: Shot,
        states: States,
        laws: Sequence[tuple[IceLaw, Curl]],
        law: Index,
        radius: Array,
        vary: Mapping[str, Array],
    ) -> None:
        self.shot, self.states, self.laws, self.law, self.vary = shot, states, laws, law, vary
        self.radius = radius
        count, self.stones = states.x.shape
        self.mass = np.array([stone.mass for stone in shot.stones])
        self.spins_after = _spins_after(shot)
        table = CurveTable(laws, _top(shot, states))
        self.paths = Paths(table, np.repeat(law, self.stones))
        place = np.stack([states.x, states.y], axis=-1)
        velocity = np.stack([states.vx, states.vy], axis=-1)
        self.hits = np.zeros((count, self.stones), int)
        self.in_play = np.ones((count, self.stones), bool)
        # When stones stop or leave the play.
        self.ends, self.leaves = (
            np.zeros((count, self.stones)),
            np.full((count, self.stones), np.inf),
        )
        every = np.arange(count * self.stones)
        self._lay(
            every,
            np.zeros(len(every)),
            place.reshape(-1, 2),
            velocity.reshape(-1, 2),
            states.omega.ravel(),
        )
        self.t, self.step = np.zeros(count), np.full(count, LONGEST)
        self.now = self._points(every, np.zeros(len(every))).reshape(count, self.stones, 4)
        apart = np.linalg.norm(place[:, :, None] - place[:, None], axis=-1)
        # Stones that were placed too close keep the distance that they had.
        self.base = np.minimum(2 * radius[:, None, None], apart)
        self.reach = self.base.copy()
        self.waiting = np.zeros(apart.shape, bool)
        shots = np.arange(count)
        for k in range(self.stones):
            self._touch(shots, np.full(count, k))

    def run(self) -> None:
        """Go until all rest."""
        active = np.arange(len(self.t))
        while len(active) > FEW:
            waits = self.waiting[active].any(axis=(1, 2))
            if waits.any():
                self._hit_waiting(active[waits])
            under_way = np.ones(len(active), bool)
            under_way[~waits] = self._forward(active[~waits])
            active = active[under_way]
        for s in active.tolist():
            self._alone(s)

    def _forward(self, shots: Index) -> Mask:
        """Take one step in each variant; False where all stones rest after it."""
        count, stones = len(shots), self.stones
        t0, now = self.t[shots], self.now[shots]
        stop, leaves = self.ends[shots], self.leaves[shots]
        end = stop.max(axis=1)
        # No step goes past the moment at which a stone leaves the play.
        t1 = np.minimum(t0 + self.step[shots], np.maximum(end, t0))
        t1 = np.minimum(t1, np.where(self.in_play[shots], leaves, np.inf).min(axis=1))
        moving = stop > t0[:, None]
        s, i = np.nonzero(moving)
        then = now.copy()
        then[s, i] = self._points(shots[s] * stones + i, t1[s])
        s, i, j = self._near(shots, now, moving, s, i, t1 - t0)
        a0, b0, a1, b1 = now[s, i], now[s, j], then[s, i], then[s, j]
        step, reach = (t1 - t0)[s], self.reach[shots[s], i, j]
        slack = all_slack(a0, a1, b0, b1, step)
        unclear = all_nearest(b0 - a0, b1 - a1) - slack <= reach
        apart = np.hypot(b1[:, 0] - a1[:, 0], b1[:, 1] - a1[:, 1])
        contact = unclear & (apart <= reach) & (slack < 1e-3 * reach)
        vague, meets = np.zeros(count, bool), np.zeros(count, bool)
        vague[s[unclear & ~contact & (step >= SHORTEST)]] = True
        meets[s[contact]] = True
        meets &= ~vague
        clear = ~(vague | meets)
        self.step[shots[vague]] = SHORTER * (t1 - t0)[vague]
        self.step[shots[clear]] *= LONGER
        self.now[shots[clear]], self.t[shots[clear]] = then[clear], t1[clear]
        lanes = np.flatnonzero(contact & meets[s])
        if lanes.size:
            s, i, j = s[lanes], i[lanes], j[lanes]
            lane = shots[s] * stones
            when = all_crossings(self._points, lane + i, lane + j, t0[s], t1[s], reach[lanes])
            first = np.full(count, np.inf)
            np.minimum.at(first, s, when)
            i, j = np.minimum(i, j), np.maximum(i, j)
            # Of contacts at one moment the lowest pair comes first.
            order = np.lexsort((j, i, when > first[s] + SIMULTANEOUS, s))
            chosen = order[np.unique(s[order], return_index=True)[1]]
            self._hit(shots[s[chosen]], i[chosen], j[chosen], when[chosen])
        s, i = np.nonzero(clear[:, None] & (leaves <= t1[:, None]))
        self._take_away(shots[s], i)
        return np.asarray(~clear | (t1 < end))

    def _lay(self, which: Index, t: Array, place: Array, velocity: Array, omega: Array) -> None:
        """Give stones new paths from the times t on, and see when these leave the play."""
        self.paths.lay(which, t, place, velocity, omega)
        ends = self.paths.stop[which]
        if self.shot.bounds is not None:
            hit = self.hits.ravel()[which] > 0
            leaves = all_leave_at(
                self.paths.points, which, t, ends, self.shot.bounds, self.shot.radius, hit
            )
            self.leaves.ravel()[which] = leaves
            ends = np.minimum(ends, leaves)
        self.ends.ravel()[which] = ends

    def _points(self, which: Index, t: Array) -> Array:
        """Place, speed and direction of stones; of those that are gone, as they left."""
        return self.paths.points(which, np.minimum(t, self.leaves.ravel()[which]))

    def _take_away(self, shots: Index, i: Index) -> None:
        """Take stones that have left the play off the sheet: nothing reaches them any more."""
        self.in_play[shots, i] = False
        for reach in (self.reach, self.base):
            reach[shots, i] = reach[shots, :, i] = -np.inf

    def _near(
        self, shots: Index, now: Array, moving: Mask, s: Index, i: Index, step: Array
    ) -> tuple[Index, Index, Index]:
        """Pairs (variant, stone, other stone), the first moving, that might meet in a step."""
        x, y, speed = np.moveaxis(now[..., :3], -1, 0).copy()
        dx, dy = x[s] - x[s, i, None], y[s] - y[s, i, None]
        far = self.reach[shots[s], i] + step[s, None] * (speed[s] + speed[s, i, None])
        near = dx * dx + dy * dy <= np.maximum(far, 0.0) ** 2
        # Of two that move one is enough.
        near &= ~(moving[s] & (np.arange(self.stones) <= i[:, None]))
        k, j = np.nonzero(near)
        return s[k], i[k], j

    def _hit_waiting(self, shots: Index) -> None:
        """Resolve the first pair that touches and closes in each of these variants."""
        pair = self.waiting[shots].reshape(len(shots), -1).argmax(axis=1)
        self._hit(shots, pair // self.stones, pair % self.stones, self.t[shots])

    def _hit(self, shots: Index, i: Index, j: Index, t: Array) -> None:
        """Resolve contacts of stones i and j at times t, as `physics.simulator.simulate` does."""
        every = (shots[:, None] * self.stones + np.arange(self.stones)).ravel()
        self.now[shots] = self._points(every, np.repeat(t, self.stones)).reshape(-1, self.stones, 4)
        self.t[shots], self.step[shots] = t, AFTER_HIT
        swap = self.now[shots, j, 2] > self.now[shots, i, 2]
        i, j = np.where(swap, j, i), np.where(swap, i, j)
        a, b = self.now[shots, i], self.now[shots, j]
        v1, v2 = velocity(a), velocity(b)
        path1, path2 = shots * self.stones + i, shots * self.stones + j
        w1, w2 = self.paths.omega(path1, t), self.paths.omega(path2, t)
        offset = b[:, :2] - a[:, :2]
        distance = np.hypot(offset[:, 0], offset[:, 1])
        normal = offset / distance[:, None]
        closing = ((v1 - v2) * normal).sum(axis=1)
        listed = closing > SLOW
        spins = self._spin_after(shots, i, w1, listed), self._spin_after(shots, j, w2, listed)
        m1, m2 = self.mass[i], self.mass[j]
        after = resolve(
            self._impact(shots), v1, v2, w1, w2, normal, self.radius[shots],
            mass1=m1, mass2=m2, spin_after=spins,
        )  # fmt: skip
        hit = closing > 0
        v1, v2 = np.where(hit[:, None], after.v1, v1), np.where(hit[:, None], after.v2, v2)
        w1, w2 = np.where(hit, after.w1, w1), np.where(hit, after.w2, w2)
        self.hits[shots, i] += listed
        self.hits[shots, j] += listed
        overlap = self.base[shots, i, j] - distance
        overlap = np.where(overlap > TOUCHING, overlap, 0.0)[:, None] * normal
        # Set apart about their centre of mass.
        share = (m1 / (m1 + m2))[:, None]
        self._lay(path1, t, a[:, :2] - overlap * (1 - share), v1, w1)
        self._lay(path2, t, b[:, :2] + overlap * share, v2, w2)
        self.now[shots, i] = self._points(path1, t)
        self.now[shots, j] = self._points(path2, t)
        self._touch(shots, i)
        self._touch(shots, j)

    def _touch(self, shots: Index, i: Index) -> None:
        """See which stones the stones i, on new paths, touch: they hit or lean on them."""
        now = self.now[shots]
        one = self.now[shots, i]
        offset = now[..., :2] - one[:, None, :2]
        distance = np.hypot(offset[..., 0], offset[..., 1])
        relative = velocity(one)[:, None] - velocity(now)
        closing = (relative * offset).sum(axis=-1)
        base = self.base[shots, i]
        touching = distance <= base + TOUCHING
        touching[np.arange(len(shots)), i] = False
        closes = touching & (closing > SLOW * distance)
        leaning = np.minimum(base, distance) - PRESSED
        reach = np.where(touching & ~closes, leaning, base)
        self.reach[shots, i], self.reach[shots, :, i] = reach, reach
        self.waiting[shots, i], self.waiting[shots, :, i] = closes, closes

    def _impact(self, shots: Index) -> Any:
        """Model of impact with the parameters of these variants."""
        varied: dict[str, Any] = {key: value[shots] for key, value in self.vary.items()}
        return replace(self.shot.impact, **varied) if varied else self.shot.impact  # type: ignore[type-var]

    def _spin_after(self, shots: Index, i: Index, omega: Array, listed: Mask) -> Array:
        """Spins after a hit, as far as the model asks for them."""
        if not self.shot.impact.needs_spin_after:
            return omega
        rank = np.minimum(self.hits[shots, i], self.spins_after.shape[1] - 1)
        given = np.where(listed, self.spins_after[i, rank], omega)
        if np.isnan(given).any():
            name = self.shot.stones[i[np.isnan(given)][0]].name
            raise InputError(
                f"stone {name} is hit but has no omega_after:"
                " the rigid-body model needs its spin after the hit"
            )
        return given

    def _alone(self, s: int) -> None:
        """Simulate one variant by itself, from its beginning."""
        columns = {key: value[s].tolist() for key, value in vars(self.states).items()}
        stones = tuple(
            replace(stone, **{key: value[k] for key, value in columns.items()})
            for k, stone in enumerate(self.shot.stones)
        )
        impact: Any = self.shot.impact
        if self.vary:
            impact = replace(impact, **{key: float(value[s]) for key, value in self.vary.items()})
        ice, curl = self.laws[self.law[s]]
        radius = float(self.radius[s])
        shot = replace(self.shot, stones=stones, impact=impact, ice=ice, curl=curl, radius=radius)
        done = simulate(shot)
        for k, stone in enumerate(stones):
            rest = done.rest[stone.name]
            self.now[s, k, :2], self.in_play[s, k] = (rest.x, rest.y), rest.in_play
            self.hits[s, k] = sum(stone.name in hit.stones for hit in done.hits)


def _top(shot: Shot, states: States) -> float:
    """Speed that no stone reaches with all the energy of its variant, m/s."""
    mass = np.array([stone.mass for stone in shot.stones])
    turning = (shot.radius * states.omega) ** 2
    energy = (mass * (states.vx**2 + states.vy**2 + turning)).sum(axis=1)
    return float(np.sqrt(energy.max(initial=0.0) / mass.min()))


def _spins_after(shot: Shot) -> Array:
    """Spins after the hits in their order, NaN where unknown, shape (stones, hits)."""
    given: list[tuple[float, ...]] = []
    for stone in shot.stones:
        after = () if stone.omega_after is None else stone.omega_after
        given.append((after if isinstance(after, tuple) else (after,)) or (math.nan,))
    most = max(map(len, given))
    return np.array([[*spins, *[spins[-1]] * (most - len(spins))] for spins in given], float)
