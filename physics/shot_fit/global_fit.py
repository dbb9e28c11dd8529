"""One least-squares fit of whole shots through the simulator.

The unknowns are the states of the stones at the start, the laws of the ice and of the hits;
where and when stones meet, and the normals, follow from the geometry. Several shots may share
unknowns. Levenberg and Marquardt's method with differences of simulations for derivatives;
detections far off lose weight as Huber has it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.results import Estimate
from curlshot.physics.local_fit.shared_error import shared_error
from curlshot.physics.shot_fit.off_centre import centred
from curlshot.physics.shot_fit.result import ShotFit, own_values
from curlshot.physics.shot_fit.shot_model import ObservedShot, Unknown
from curlshot.physics.statistics.normal_equations import bounded, inverse
from curlshot.physics.statistics.residuals import HUBER, huber_weights, inflation

Floats = NDArray[np.float64]

STEP = 1e-7
"""Difference of an unknown for a derivative, in its SI unit. Friction and how it falls go together
so closely that with 1e-5 what derivatives miss leads a descent nowhere, or to where it does not
end."""

SPIN_STEP, LOSS_STEP = 1e-3, 1e-5
"""Difference of a spin, rad/s, and of its loss times speed, m rad/s³, for a derivative."""

LOST, CROSSED = 0.1, 0.5
"""Spins of less than the first, rad/s, may be lost on the way to a hit: they all do the same there,
and only a difference as large as the second shows what more of it would do."""

STEPS = 80
"""Most simulations of all shots along the way, derivatives not counted."""

FINER, LESS = 3, 2.0
"""How often noise is told anew at most, where with what it was the fit has come to a better place:
one with so many times less of it."""

NEAR = 1e-6
"""Share of its prior's error within which an unknown is what is known of it beforehand: nothing
that is seen tells of it, and every step takes it nearer, as spins to 1e-265 rad/s."""

GOOD = 0.5
"""Share of what a step was to gain that it gains where the next may be longer."""

SETTLED = 0.02
"""Change in standard errors below which a fit has come to its end."""

SAME = 0.1
"""Distance, in standard errors, from the end of another fit at which a fit goes to the same."""


def fit_shots(
    shots: Sequence[ObservedShot],
    *,
    fixed: Mapping[str, float] | None = None,
    shared: Sequence[str] = (),
    start: Mapping[str, float] | None = None,
    noise: float = 1.0,
    ends: Sequence[ShotFit] = (),
) -> ShotFit:
    """Fit all unknowns of one or several shots to all their detections at once.

    Parameters
    ----------
    shots : sequence of ObservedShot
        As `curlshot.physics.shot_fit.observed.observe` makes them.
    fixed : mapping, optional
        Unknowns to hold, and at what; a bare name holds it in every shot.
    shared : sequence of str
        Unknowns of which all shots have the same, such as ``restitution``.
    start : mapping, optional
        Where to set out from, where not from the shots' own guesses.
    noise : float
        Factor on the variances of the detections to set out with.
    ends : sequence of ShotFit
        Fits of the same unknowns that set out from elsewhere; one of them is returned where this
        comes to the same end.

    Raises
    ------
    InputError
        Where there is no shot or a name is unknown.
    """
    return _Problem(shots, fixed or {}, shared, start or {}, noise, ends).solve()


@dataclass
class _Problem:
    """Working state of one fit."""

    shots: Sequence[ObservedShot]
    fixed: Mapping[str, float]
    shared: Sequence[str]
    start: Mapping[str, float]
    noise: float = 1.0
    ends: Sequence[ShotFit] = ()
    unknowns: dict[str, Unknown] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.shots:
            raise InputError("no shot to fit")
        several = len(self.shots) > 1
        known: set[str] = set()
        for rank, shot in enumerate(self.shots):
            for unknown in shot.unknowns:
                own = several and unknown.name not in self.shared
                name = f"{rank}:{unknown.name}" if own else unknown.name
                known |= {name, unknown.name}
                if name not in self.fixed and unknown.name not in self.fixed:
                    self.unknowns.setdefault(name, unknown)
        wrong = sorted({*self.fixed, *self.shared, *self.start} - known)
        if wrong:
            raise InputError(f"no unknown {', '.join(wrong)}; there are {', '.join(sorted(known))}")
        self.names = tuple(self.unknowns)
        each = list(self.unknowns.values())
        self.low = np.array([unknown.low for unknown in each])
        self.high = np.array([unknown.high for unknown in each])
        self.mean = np.array([_or(unknown.prior, "value", 0.0) for unknown in each])
        self.sd = np.array([_or(unknown.prior, "stderr", np.inf) for unknown in each])
        steps = {"omega": SPIN_STEP, "loss": LOSS_STEP}
        self.step = np.array([steps.get(u.name.rpartition(".")[2], STEP) for u in each])
        self.detections = sum(len(t.t) for shot in self.shots for t in shot.traces.values())
        self.ended = [(fit, inverse(fit.cov)) for fit in self.ends if fit.settled]

    def solve(self) -> ShotFit:
        guesses = [self.start.get(n, u.guess) for n, u in self.unknowns.items()]
        at = np.clip(np.array(guesses, float), self.low, self.high)
        at, settled = self._descend(at)
        if (same := self._same_end(at)) is not None:
            return same
        residuals = [self._residuals(rank, at) for rank in range(len(self.shots))]
        noise = self._noise(at, residuals)
        for _ in range(FINER):
            self.noise = noise
            if noise > 1.0:  # what is known beforehand has the more of a say
                at, settled = self._descend(at)
                if (same := self._same_end(at)) is not None:
                    return same
                residuals = [self._residuals(rank, at) for rank in range(len(self.shots))]
                noise = self._noise(at, residuals)
            if noise > self.noise / LESS:
                break
        untold = np.abs(at - self.mean) < NEAR * np.nan_to_num(self.sd, posinf=0.0)
        at = np.where(untold, self.mean, at)
        slopes = self._slopes(at, residuals)
        normal, _ = self._normal(at, residuals, slopes)
        cov = inverse(normal)
        shared = [
            shared_error(
                shot.traces, np.concatenate(places), by_place, cov, _weights(places) / self.noise
            )
            for shot, (places, _), (by_place, _) in zip(self.shots, residuals, slopes, strict=True)
        ]
        return ShotFit(
            self.names,
            at,
            cov + sum(shared),
            self.mean,
            self.sd,
            dict(self.fixed),
            tuple(self.shots),
            sum(_huber(run) for places, _ in residuals for run in places),
            self._elsewhere(at, residuals),
            self.detections,
            self.noise,
            settled,
        )

    def _noise(self, at: Floats, residuals: Sequence[tuple[list[Floats], Floats]]) -> float:
        """Return the factor on the variances of the detections that their residuals ask for."""
        runs = [(run, 3) for places, _ in residuals for run in places]
        return inflation(runs, 2 * self.detections - len(at))

    def _descend(self, at: Floats) -> tuple[Floats, bool]:
        """Levenberg and Marquardt's steps from a guess to the least cost.

        Unknowns are damped by the most that the detections have told of each on the way (Moré,
        1978, Lecture Notes in Mathematics 630, 105): stones that stick tell nothing of the friction
        between them, and what is known of it beforehand would draw it to where they slide.
        """
        damping = 1e-3
        told = np.zeros(len(at))
        residuals = [self._residuals(rank, at) for rank in range(len(self.shots))]
        cost = self._cost(at, residuals)
        slopes = self._slopes(at, residuals)
        for _ in range(STEPS):
            normal, right = self._normal(at, residuals, slopes)
            told = np.maximum(told, np.diag(normal))
            damped = normal + damping * np.diag(told)
            new = at + bounded(damped, right, self.low - at, self.high - at)
            step = new - at
            try:
                there = [self._residuals(rank, new) for rank in range(len(self.shots))]
                new_cost = self._cost(new, there)
            except InputError:  # a step too far: to what cannot be simulated
                there, new_cost = residuals, np.inf
            # Residuals larger than stated make errors that much larger.
            settled = SETTLED**2 * len(at) * max(1.0, cost / self.detections)
            small = float(step @ normal @ step) < settled
            if new_cost < cost:
                small = small or cost - new_cost < settled
                foreseen = float(step @ (2 * right - normal @ step))
                damping = max(damping / 10, 1e-9) if cost - new_cost > GOOD * foreseen else damping
                at, residuals, cost = new, there, new_cost
                if small or self._same_end(at) is not None:
                    return at, True
                slopes = self._slopes(at, residuals)
            elif small or damping > 1e8:
                return at, small
            else:
                damping = max(damping * 10, 1e-3)
        return at, False

    def _same_end(self, at: Floats) -> ShotFit | None:
        """Return the fit that has ended so near that this one goes there too."""
        for fit, normal in self.ended:
            off = at - fit.values
            if off @ normal @ off < SAME**2:
                return fit
        return None

    def _values(self, rank: int, at: Floats) -> dict[str, float]:
        shot = self.shots[rank]
        return own_values(rank, len(self.shots), self.names, at, self.fixed, shot)

    def _residuals(self, rank: int, at: Floats) -> tuple[list[Floats], Floats]:
        """Return residuals of each stone's places, and those of spins and of caps off centre."""
        shot = self.shots[rank]
        simulation = shot.replay(self._values(rank, at))
        runs = zip(shot.traces.values(), shot.residuals(simulation), strict=True)
        left = (centred(trace, run, self.noise, shot.sd_off_centre(trace)) for trace, run in runs)
        places, beside = zip(*left, strict=True)
        return list(places), np.concatenate([shot.spin_residuals(simulation), *beside])

    def _cost(self, at: Floats, residuals: Sequence[tuple[list[Floats], Floats]]) -> float:
        data = sum(_huber(run) for places, _ in residuals for run in places) / self.noise
        return float(data) + self._elsewhere(at, residuals)

    def _elsewhere(self, at: Floats, residuals: Sequence[tuple[list[Floats], Floats]]) -> float:
        spins, caps = 0.0, 0.0
        for shot, (_, further) in zip(self.shots, residuals, strict=True):
            spins += _huber(further[: len(shot.spins), None])
            caps += float(np.sum(further[len(shot.spins) :] ** 2))
        return float(spins + caps + np.sum(((at - self.mean) / self.sd) ** 2))

    def _slopes(
        self, at: Floats, residuals: Sequence[tuple[list[Floats], Floats]]
    ) -> list[tuple[Floats, Floats]]:
        """Differentiate all residuals of each shot; shapes (count, unknowns)."""
        out = []
        for rank, (places, further) in enumerate(residuals):
            flat = _flat(places)
            by_place = np.zeros((len(flat), len(at)))
            by_further = np.zeros((len(further), len(at)))
            own = set(self._values(rank, at))
            for k, name in enumerate(self.names):
                if name.removeprefix(f"{rank}:") not in own:
                    continue
                step = self.step[k] if at[k] + self.step[k] <= self.high[k] else -self.step[k]
                if name.endswith("omega") and abs(at[k]) < LOST:
                    step = CROSSED
                moved = at.copy()
                moved[k] += step
                there, further_there = self._residuals(rank, moved)
                by_place[:, k] = (_flat(there) - flat) / step
                by_further[:, k] = (further_there - further) / step
            out.append((by_place, by_further))
        return out

    def _normal(
        self,
        at: Floats,
        residuals: Sequence[tuple[list[Floats], Floats]],
        slopes: Sequence[tuple[Floats, Floats]],
    ) -> tuple[Floats, Floats]:
        """Set up the normal equations: matrix and right-hand side of a step."""
        normal = np.diag(self.sd**-2.0)
        right = (self.mean - at) * self.sd**-2.0
        parts = zip(self.shots, residuals, slopes, strict=True)
        for shot, (places, further), (by_place, by_further) in parts:
            weights = _weights(places) / self.noise
            normal += by_place.T @ (weights[:, None] * by_place)
            right -= by_place.T @ (weights * _flat(places))
            weights = HUBER / np.maximum(np.abs(further), HUBER)
            weights[len(shot.spins) :] = 1.0
            normal += by_further.T @ (weights[:, None] * by_further)
            right -= by_further.T @ (weights * further)
        return normal, right


def _flat(places: Sequence[Floats]) -> Floats:
    return np.concatenate(places).ravel()


def _weights(places: Sequence[Floats]) -> Floats:
    """Huber's weight of every coordinate, in the order of `_flat`."""
    return np.repeat(huber_weights(np.concatenate(places))[:, 0], 2)


def _huber(residuals: Floats) -> float:
    """Huber's cost of residuals of shape (n, k)."""
    size = np.sqrt(np.sum(residuals**2, axis=1))
    return float(np.sum(np.where(size <= HUBER, size**2, 2 * HUBER * size - HUBER**2)))


def _or(prior: Estimate | None, key: str, default: float) -> float:
    value = None if prior is None else getattr(prior, key)
    return default if value is None else float(value)
