"""A watched shot as a function of its unknowns: the simulator beside the detections."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.results import Estimate
from curlshot.data.sheet import STONE
from curlshot.physics.curl import Curl, FCV1Curl, NoCurl
from curlshot.physics.filter.slowing import V_C
from curlshot.physics.ice import Fit, IceLaw, Penner
from curlshot.physics.impact import Frictional
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.simulator.motion import Path
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, Simulation, StoneStart

Floats = NDArray[np.float64]

TOGETHER = 0.04
"""Time within which the order of hits is not told, s: a frame."""

SOFT = 0.02
"""Closing speed of a hit that tracks do not show, m/s: as where two stones that have hit each other
touch again because the first goes on behind the second."""

STATE: tuple[str, ...] = ("x", "y", "vx", "vy", "omega")


@dataclass(frozen=True)
class Unknown:
    """A number that a fit may find.

    Attributes
    ----------
    name : str
        ``restitution``, ``stone_friction`` (μ_s between stones), ``friction`` (of the ice at
        1 m/s), ``slope`` and ``v_c`` (a and v_c in μ(v) = a / (v + v_c) + b, m/s), ``turn`` (of
        the path at 1 m/s, rad/s), ``loss`` (of spin times speed, m rad/s³), ``size`` (distance at
        contact over two radii), ``inertia`` (k in I = k m R²), or a state at the start such as
        ``A.x``, ``A.y``, ``A.vx``, ``A.vy`` and ``A.omega``.
    guess : float
        Where a fit sets out from.
    low, high : float
        Bounds.
    prior : Estimate, optional
        What is known of it besides the detections.
    """

    name: str
    guess: float
    low: float = -np.inf
    high: float = np.inf
    prior: Estimate | None = None

    @property
    def stone(self) -> str | None:
        """Name of the stone whose state it is of; None for a law."""
        stone, dot, _ = self.name.rpartition(".")
        return stone if dot else None


@dataclass(frozen=True)
class SpinSeen:
    """Mean spin of a stone about a time, s, measured from its angles: rad/s."""

    stone: str
    t: float
    omega: float
    stderr: float


def ice(values: Mapping[str, float]) -> Fit:
    """Return the ice law μ(v) = a / (v + v_c) + b with the friction at 1 m/s and a as given."""
    a, v_c = values.get("slope", 0.0), values.get("v_c", V_C)
    return Fit(a=a, v_c=v_c, b=max(values["friction"] - a / (1 + v_c), 1e-6))


def penner(values: Mapping[str, float]) -> Penner:
    """Return Penner's law of the ice with the friction at 1 m/s as given."""
    return Penner(max(values["friction"], 1e-6))


@dataclass(frozen=True)
class ObservedShot:
    """What one shot showed, and the unknowns that it depends on.

    Attributes
    ----------
    traces : mapping
        Detections of each stone that took part.
    start : float
        Time at which the simulation begins, s.
    unknowns : tuple of Unknown
        Of the laws and of the stones' states at `start`; a state that is not among them is 0.
    spins : tuple of SpinSeen
        Spins that were seen.
    hits : tuple of (str, str)
        Pairs in the order in which they hit each other, names of a pair sorted.
    times : tuple of float
        When they did, s.
    radius : float
        Of the discs, m.
    masses : mapping
        Stone to mass in any unit; equal where absent.
    off_centre : float, optional
        How far caps may be off the centres of their stones, as a part of `sd_place`, the error
        that all places of a stone have in common; else as `Trace.sd_off_centre` has it.
    ice : callable
        From values of the unknowns to the law of the ice: `ice` or `penner`.
    """

    traces: Mapping[str, Trace]
    start: float
    unknowns: tuple[Unknown, ...]
    spins: tuple[SpinSeen, ...] = ()
    hits: tuple[tuple[str, str], ...] = ()
    times: tuple[float, ...] = ()
    radius: float = STONE.radius
    masses: Mapping[str, float] = field(default_factory=dict)
    off_centre: float | None = None
    ice: Callable[[Mapping[str, float]], IceLaw] = ice

    @property
    def end(self) -> float:
        """Time of the last detection, s."""
        return max(float(trace.t[-1]) for trace in self.traces.values())

    def sd_off_centre(self, trace: Trace) -> float:
        """By how much a stone's cap may be beside its centre on either axis, m; 0 if unknown."""
        if self.off_centre is None:
            return trace.sd_off_centre(self.radius)
        return self.off_centre * trace.usual_sd_place

    def spinning(self, prior: Estimate) -> ObservedShot:
        """Expect a spin, rad/s, of the stones that come with one that nobody saw.

        Which way its path curls then tells its sense: it curls to the side to which it spins.
        """
        seen = {spin.stone for spin in self.spins}
        expected = {
            unknown: replace(unknown, guess=float(prior.value or 0.0), prior=prior)
            for unknown in self.unknowns
            if unknown.name.endswith(".omega") and unknown.stone not in seen
        }
        if expected:
            expected |= {u: replace(u, low=0.0) for u in self.unknowns if u.name == "turn"}
        return replace(self, unknowns=tuple(expected.get(u, u) for u in self.unknowns))

    def shot(self, values: Mapping[str, float]) -> Shot:
        """Return the shot with these values of the unknowns, from the time `start` on."""
        stones = tuple(
            StoneStart(
                name,
                **{key: values.get(f"{name}.{key}", 0.0) for key in STATE},
                mass=self.masses.get(name, STONE.mass),
            )
            for name in self.traces
        )
        inertia = values.get("inertia", STONE.inertia)
        impact = Frictional(values["restitution"], values["stone_friction"], inertia)
        radius = self.radius * values.get("size", 1.0)
        return Shot(stones, impact, self.ice(values), curl(values), radius)

    def replay(self, values: Mapping[str, float]) -> Simulation:
        """Simulate the shot up to its last detection."""
        return simulate(self.shot(values), until=self.end - self.start)

    def residuals(self, simulation: Simulation) -> list[Floats]:
        """Sighted less simulated places over their standard deviations, (n, 2) per stone."""
        out = []
        for name, trace in self.traces.items():
            xy = places(simulation.paths[name], trace.t - self.start)
            out.append((trace.xy - xy) / trace.sd)
        return out

    def spin_residuals(self, simulation: Simulation) -> Floats:
        """Seen less simulated spins over their standard errors, one for each of `spins`."""
        return np.array(
            [
                (s.omega - simulation.state(s.stone, s.t - self.start).omega) / s.stderr
                for s in self.spins
            ]
        )

    def first_other_hit(self, simulation: Simulation) -> tuple[float, str] | None:
        """Time, s, and name of the first hit that was not seen as simulated; None without.

        Hits at about one time, as in a row of stones that touch, may come in another order. One
        that is too soft to be seen need not have been.
        """
        seen = [(t, " and ".join(pair)) for t, pair in zip(self.times, self.hits, strict=True)]
        for hit in simulation.hits:
            pair = " and ".join(sorted(hit.stones))
            near = [other for other in seen if other[0] <= seen[0][0] + TOGETHER]
            same = next((other for other in near if other[1] == pair), None)
            if same is not None:
                seen.remove(same)
            elif hit.closing_speed > SOFT:
                return min([(hit.t + self.start, pair), *seen[:1]])
        return seen[0] if seen else None

    def until(self, end: float) -> ObservedShot:
        """Return what was seen before a time, s."""
        traces = {name: trace.until(end) for name, trace in self.traces.items()}
        traces = {name: trace for name, trace in traces.items() if len(trace.t)}
        count = sum(t < end for t in self.times)
        return replace(
            self,
            traces=traces,
            unknowns=tuple(u for u in self.unknowns if u.stone is None or u.stone in traces),
            spins=tuple(spin for spin in self.spins if spin.t < end and spin.stone in traces),
            hits=self.hits[:count],
            times=self.times[:count],
        )


def curl(values: Mapping[str, float]) -> Curl:
    """Return the law of curl with the turn at 1 m/s and the loss of spin as given."""
    turn, loss = values.get("turn", 0.0), values.get("loss", 0.0)
    return FCV1Curl(turn=turn, loss=loss) if turn or loss else NoCurl()


def places(paths: Sequence[Path], times: Floats) -> Floats:
    """Places at times (s, increasing) on a stone's paths from hit to hit, shape (n, 2).

    A stone that is seen before its first path begins rests until then.
    """
    edges = np.searchsorted(times, [path.start for path in paths[1:]])
    out = np.empty((len(times), 2))
    for path, rows in zip(paths, np.split(np.arange(len(times)), edges), strict=True):
        out[rows] = path.places(np.maximum(times[rows], path.start))
    return out
