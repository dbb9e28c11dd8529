"""Spins beside hits, from how hits change them: what one stone shows tells of the other's.

In a hit both stones are rubbed by the same impulse at the same lever, so that the spins of equal
stones change by the same amount (of others, as their masses have it), and that is as their
velocities change along the line of the contact: an impulse that gives a disc Δv across the normal
turns it by Δv / (k R) (Wang and Mason, 1992, J. Appl. Mech. 59, 635). The error of a spin is
correlated all the way from one hit to the next (light on a turning cap, few pictures), so that what
a hit tells of one end corrects all of that stretch, as far as the ice leaves a spin unchanged. What
angles of a stone are off by together (a handle that rises) goes on through its hits as well.

Handles of one clip are of one make: level ones, or goose-necks. Where spins fit their hits as they
are seen, handles are the more probably level, and spins are the less off for a rise. So each of a
few makes is gone through, and spins are their mean by how probable each makes what the hits show
(Bayesian model averaging: Hoeting et al., 1999, Statist. Sci. 14, 382).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf, log
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import STONE, curling_size
from curlshot.data.tracks import Columns
from curlshot.physics.filter.stretch import LOSS_SD, MEMORY, MOST_LOSS_SD
from curlshot.physics.local_fit.hit_detection import HitCandidate

Floats = NDArray[np.float64]

NEAR = 0.1
"""How far from a hit, s, states are those which the hit began or ended with: beside it rows may lie
on its other side."""

SLACK, UNLIKE, UNLIKE_STONES = 0.02, 0.2, 0.05
"""How far from the same changes of spin are, rad/s, and as a share of them: of discs on tables
nobody says here which is heavier, of stones how their mass is spread."""

ASIDE = 0.007
"""How far from its middle a disc is taken to be across the normal, besides what its places err by,
a share of its radius: caps lie beside their stones' centres."""

WILD = 3.0
"""Standard errors beyond which a hit contradicts what is seen, and is ignored: of a hundred one
does, by 1 rad/s or so, whatever the make of the handles."""

MAKES = (0.0, 0.5, 1.0, 1.5)
"""How steep handles of a clip may be, in standard deviations of one of which nothing is known
(`curlshot.vision.spin.pitch.STEEP`): level ones to goose-necks, alike probable beforehand, 0.94
r.m.s. In 34 clips drawn 50 degrees aslant with level handles spins are .047 rad/s off, .063 with
1.0 alone; in seven whose handles rise by .15 .043 and .031, in ten by .3 .137 and .133."""


End = tuple[str, int, bool]
"""A stone, the rank of a hit of its own, and whether it is meant after that hit."""


@dataclass(frozen=True)
class _Stretch:
    """A stone from one hit to the next.

    Its table, its rows there, those that tell its spin, and what all spins of the table are off by
    together, (rows of the table, k + 1), for the rise of the handle and, last, for the ice.
    """

    table: Columns
    rows: NDArray[np.intp]
    told: NDArray[np.intp]
    together: Floats

    def spin_row(self, time: float) -> int:
        """Row that tells the spin at a hit at either end."""
        return _best(self.table["t"], self.table["sd_omega"], self.told, time)

    def state(self, time: float) -> tuple[Floats, Floats]:
        """Velocity at a hit at either end, m/s, and errors of it and of the place."""
        t, x, y = (self.table[name] for name in ("t", "vx", "vy"))
        v = np.stack([x, y], axis=1)
        sd = np.stack([self.table[name] for name in ("sd_vx", "sd_vy", "sd_x", "sd_y")], axis=1)
        row = _best(t, np.hypot(sd[:, 0], sd[:, 1]), self.rows, time)
        inner = self.rows[np.abs(t[self.rows] - time) > abs(t[row] - time)]
        if not len(inner):
            return v[row], sd[row]
        beyond = inner[np.abs(t[inner] - t[row]).argmin()]
        slowing = (v[beyond] - v[row]) / (t[beyond] - t[row])
        return v[row] + slowing * (time - t[row]), sd[row]

    def covariance(self, row: int) -> Floats:
        """Covariance of the spins of all rows with that of one of them.

        But for what is off together, spins of two rows differ by what the ice may do between them
        at most.
        """
        whole = self.table["sd_omega"] ** 2 - (self.together**2).sum(1)
        t, variance = self.table["t"][self.told], np.maximum(whole[self.told], 0.0)
        speed = np.hypot(self.table["vx"], self.table["vy"])[self.told]
        loss = np.minimum(LOSS_SD[1] / np.maximum(speed, 1e-6), MOST_LOSS_SD[1]) ** 2 * MEMORY
        so_far = np.concatenate([[0.0], np.cumsum(loss[:-1] * np.diff(t))])
        at = int(np.searchsorted(self.told, row))
        apart = np.abs(so_far - so_far[at])
        most = np.sqrt(variance * variance[at])
        return np.asarray(np.clip(0.5 * (variance + variance[at] - apart), 0.0, most))


@dataclass(frozen=True)
class _Side:
    """A stone in a hit: its stretches on either side, the ranks of its spins, and its mass."""

    before: _Stretch
    after: _Stretch
    spin_before: int | None
    spin_after: int | None
    mass: float


def _best(t: Floats, sd: Floats, rows: NDArray[np.intp], time: float) -> int:
    """Give the row of least error near a time."""
    away = np.abs(t[rows] - time)
    near = rows[away <= max(NEAR, float(away.min()))]
    return int(near[sd[near].argmin()])


def share_spins(
    tables: Mapping[str, Columns],
    contacts: Sequence[HitCandidate],
    radius: float,
    masses: Mapping[str, float] | None = None,
    together: Mapping[str, Floats] = MappingProxyType({}),
) -> None:
    """Improve spins by how hits change them, and their standard errors.

    Parameters
    ----------
    tables : mapping
        Stone to its rows of `curlshot.data.tracks.TRACK_COLUMNS`; ``omega`` and ``sd_omega`` are
        changed. ``sd_x`` and ``sd_y`` are without what all places share, which does not turn the
        line from one stone to another.
    contacts : sequence of HitCandidate
        The hits.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; 1 where absent.
    together : mapping
        Stone to what its spins are off by together, (rows, k + 1), rad/s, by so many numbers of
        standard deviation 1, k of the rise of its handle and the last of the ice
        (`curlshot.physics.filter.rate_filter.shared_response`): a part of ``sd_omega``; nothing
        where absent.
    """
    masses = masses or {}
    count = max((shared.shape[1] for shared in together.values()), default=1)
    hits = {
        stone: sorted((hit for hit in contacts if stone in hit.stones), key=lambda hit: hit.t)
        for stone in tables
    }
    stretches = {
        (stone, k): stretch
        for stone, own in hits.items()
        for k, stretch in enumerate(
            _stretches(
                tables[stone],
                together.get(stone, np.zeros((len(tables[stone]["t"]), count))),
                [hit.t for hit in own],
            )
        )
    }
    # The unknowns: the spin of each stretch at either hit, told by a row of it.
    ends: list[tuple[str, int, int]] = []
    number: dict[End, int] = {}
    for (stone, k), stretch in stretches.items():
        for hit, late in ((k - 1, True), (k, False)):
            if 0 <= hit < len(hits[stone]) and len(stretch.told):
                number[stone, hit, late] = len(ends)
                ends.append((stone, k, stretch.spin_row(hits[stone][hit].t)))
    if not ends:
        return
    meetings: list[tuple[HitCandidate, list[_Side]]] = []
    for met in sorted(contacts, key=lambda met: met.t):
        sides = []
        for stone in (stone for stone in met.stones if stone in hits):
            k = hits[stone].index(met)
            rows = [number.get((stone, k, late)) for late in (False, True)]
            mass = masses.get(stone, 1.0)
            sides.append(
                _Side(stretches[stone, k], stretches[stone, k + 1], rows[0], rows[1], mass)
            )
        meetings.append((met, sides))
    makes = [_Spins.of(stretches, ends, make) for make in MAKES]
    for spins in makes:
        for met, sides in meetings:
            for seen, value, sd in _constraints(met, sides, spins, radius):
                spins.learn(seen, value, sd)
    _write_back(list(stretches.values()), makes)


@dataclass
class _Spins:
    """Spins of all rows of all stretches, and their covariance with those at hits.

    What a hit tells of these corrects all rows as far as they go together (Kalman's equations).

    Attributes
    ----------
    omega, variance : (n,) array
        rad/s and its square, stretch after stretch, row after row.
    cov : (n, m) array
        Covariance with the spins at hits.
    ends : (m,) array of int
        Which of the rows tell these.
    likelihood : float
        Logarithm of how probable what was learnt is, but for a constant.
    """

    omega: Floats
    variance: Floats
    cov: Floats
    ends: NDArray[np.intp]
    likelihood: float = 0.0

    @classmethod
    def of(
        cls,
        stretches: Mapping[tuple[str, int], _Stretch],
        ends: Sequence[tuple[str, int, int]],
        make: float,
    ) -> _Spins:
        """Gather them from the tables, with handles of one of `MAKES`.

        Each end is a stone, the rank of its stretch, and a row.
        """
        parts = list(stretches.values())
        first = dict(zip(stretches, np.cumsum([0, *(len(p.told) for p in parts)]), strict=False))
        omega = np.concatenate([part.table["omega"][part.told] for part in parts])
        sd = np.concatenate([part.table["sd_omega"][part.told] for part in parts])
        stated = np.concatenate([part.together[part.told] for part in parts])
        together = np.column_stack([make * stated[:, :-1], stated[:, -1]])
        variance = sd**2 + (together**2).sum(1) - (stated**2).sum(1)
        whose = np.array([stone for stone, k in stretches for _ in stretches[stone, k].told])
        cov = np.zeros((len(omega), len(ends)))
        at = []
        for j, (stone, k, row) in enumerate(ends):
            stretch, begin = stretches[stone, k], int(first[stone, k])
            at.append(begin + int(np.searchsorted(stretch.told, row)))
            cov[whose == stone, j] = together[whose == stone] @ together[at[j]]
            cov[begin : begin + len(stretch.told), j] += stretch.covariance(row)
        still = omega == 0  # at rest a stone has none, whatever its other spins are off by
        cov[still] = 0.0
        cov[:, still[at]] = 0.0
        return cls(omega, np.maximum(variance, 0.0), cov, np.array(at))

    @property
    def at_hits(self) -> tuple[Floats, Floats]:
        """Spins at hits, (m,), and their covariance."""
        return self.omega[self.ends], self.cov[self.ends]

    def learn(self, seen: Floats, value: float, sd: float) -> None:
        """Take in that spins at hits, weighed by `seen`, come to a value; ignored if far off."""
        mean, cov = self.at_hits
        off, spread = value - float(seen @ mean), float(seen @ cov @ seen) + sd**2
        if not off**2 < WILD**2 * spread < inf:
            self.likelihood -= 0.5 * WILD**2
            return
        self.likelihood -= 0.5 * (off**2 / spread + log(spread))
        told = self.cov @ seen
        self.omega = self.omega + told * off / spread
        self.variance = self.variance - told**2 / spread
        self.cov = self.cov - np.outer(told, seen @ cov) / spread


def _write_back(stretches: Sequence[_Stretch], makes: Sequence[_Spins]) -> None:
    """Put the mean of spins by their probability, and its standard errors, into the tables."""
    likelihood = np.array([spins.likelihood for spins in makes])
    weight = np.exp(likelihood - likelihood.max())
    weight /= weight.sum()
    each = np.array([spins.omega for spins in makes])
    omega = weight @ each
    variance = weight @ (np.array([spins.variance for spins in makes]) + (each - omega) ** 2)
    begin = 0
    for part in stretches:
        rows = slice(begin, begin + len(part.told))
        part.table["omega"][part.told] = omega[rows]
        part.table["sd_omega"][part.told] = np.sqrt(np.maximum(variance[rows], 0.0))
        begin = rows.stop


def _stretches(table: Columns, together: Floats, times: Sequence[float]) -> list[_Stretch]:
    """Cut a stone's rows at its hits."""
    part = np.searchsorted(np.array(times), table["t"], side="right")
    moving = np.isfinite(table["sd_vx"])
    told = np.isfinite(table["sd_omega"])
    return [
        _Stretch(
            table,
            np.flatnonzero((part == k) & moving),
            np.flatnonzero((part == k) & told),
            together,
        )
        for k in range(len(times) + 1)
    ]


def _constraints(
    hit: HitCandidate, sides: Sequence[_Side], spins: _Spins, radius: float
) -> Iterator[tuple[Floats, float, float]]:
    """Linear constraints on spins that a hit gives: weights, value and standard error of each.

    Changes of spin and of velocity are those of a stone of the mean mass of the two: such a one
    turns by as much as the other.
    """
    if len(sides) < 2:
        return
    mean, cov = spins.at_hits
    mean_mass = float(np.mean([side.mass for side in sides]))
    unlike = UNLIKE_STONES if curling_size(radius) else UNLIKE
    changes = []
    for side in sides:
        if side.spin_before is not None and side.spin_after is not None:
            weights = np.zeros(len(mean))
            share = side.mass / mean_mass
            weights[side.spin_after], weights[side.spin_before] = share, -share
            changes.append(weights)
    if len(changes) == 2:
        told = min(changes, key=lambda seen: float(seen @ cov @ seen))
        yield changes[0] - changes[1], 0.0, float(np.hypot(SLACK, unlike * (told @ mean)))
    rub = _spin_change(hit, sides, radius)
    if changes and rub is not None:
        yield changes[0], rub[0], float(np.hypot(rub[1], unlike * rub[0]))


def _spin_change(
    hit: HitCandidate, sides: Sequence[_Side], radius: float
) -> tuple[float, float] | None:
    """Change of spin that the changes of velocity imply, rad/s, and its standard error."""
    stretches = [stretch for side in sides for stretch in (side.before, side.after)]
    if not all(len(stretch.rows) for stretch in stretches):
        return None
    states = [stretch.state(hit.t) for stretch in stretches]
    v1, w1, v2, w2 = (velocity for velocity, _ in states)
    normal = np.array(hit.normal)
    tangent = np.array([-normal[1], normal[0]])
    lever = STONE.inertia * radius
    mass = np.array([side.mass for side in sides])
    share = mass / mass.mean()
    changes = share * np.array([(w1 - v1) @ tangent, (v2 - w2) @ tangent]) / lever
    each = np.array([tangent**2 @ sd[:2] ** 2 for _, sd in states]) / lever**2
    weight = 1 / np.maximum(share**2 * (each[::2] + each[1::2]), 1e-12)
    # Where the normal is aslant, a part of the push is taken for a rub.
    push = abs(float(share[1] * (w2 - v2) @ normal))
    along = abs(float((v1 - v2) @ tangent))
    aside = [hit.stderr_t * along, ASIDE * radius, ASIDE * radius]
    aside += [float(np.sqrt(tangent**2 @ sd[2:] ** 2)) for _, sd in states[::2]]
    slant = float(np.linalg.norm(aside)) / (2 * radius) * push / lever
    error = float(np.hypot(np.sqrt(1 / weight.sum()), slant))
    return float(weight @ changes / weight.sum()), error
