"""A shot to simulate, and what came of it."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from curlshot.data.errors import InputError
from curlshot.data.results import StoneState
from curlshot.data.sheet import STONE
from curlshot.physics.curl import Curl, FCV1Curl
from curlshot.physics.ice import FCV1, IceLaw
from curlshot.physics.impact import Frictional, Impact
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.motion import Motion, Path

Array = NDArray[np.float64]

SIMULATION_COLUMNS: tuple[str, ...] = (
    "stone", "frame", "t", "x", "y", "theta", "vx", "vy", "omega",
)  # fmt: skip
"""Columns of a sampled simulation."""

FASTEST = 100.0
"""Highest speed (m/s) and spin (rad/s) that a stone may start with."""
FARTHEST = 1000.0
"""Farthest place that a stone may start from, m."""

LARGEST_OVERLAP = 0.2
"""How far two stones may overlap as placed, in radii: more is a mistake, less is measuring."""


@dataclass(frozen=True)
class StoneStart:
    """One stone at the time 0.

    Attributes
    ----------
    name : str
        Its name, unique in the shot.
    x, y, vx, vy, omega, theta : float
        Place (m), velocity (m/s), spin (rad/s) and angle (rad).
    omega_after : float or tuple of float, optional
        Spin after its hits, rad/s, for the rigid-body model; of several the k-th belongs to
        the stone's k-th hit and the last to all that follow.
    mass : float
        Mass, kg.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.StoneStart("A", x=0.3, y=6.0, vy=-2.2, omega=1.5).mass
    19.1
    """

    name: str
    x: float
    y: float
    vx: float = 0.0
    vy: float = 0.0
    omega: float = 0.0
    theta: float = 0.0
    omega_after: float | tuple[float, ...] | None = None
    mass: float = STONE.mass


@dataclass(frozen=True)
class Shot:
    """The stones at the time 0 and the laws that they follow.

    ``radius`` in m. Where there are ``bounds``, stones that leave them are taken away; without,
    the ice goes on for ever.

    Examples
    --------
    >>> import curlshot
    >>> shot = curlshot.Shot(
    ...     (curlshot.StoneStart("A", 0.0, 6.0, vy=-2.0), curlshot.StoneStart("B", 0.1, 0.0)),
    ...     impact=curlshot.Frictional(restitution=0.83, stone_friction=0.05),
    ...     ice=curlshot.Constant(0.0109),
    ...     bounds=curlshot.Bounds(play=-1),
    ... )
    >>> [hit.stones for hit in curlshot.simulate(shot).hits]
    [('A', 'B')]
    """

    stones: tuple[StoneStart, ...]
    impact: Impact = field(default_factory=Frictional)
    ice: IceLaw = field(default_factory=FCV1)
    curl: Curl = field(default_factory=FCV1Curl)
    radius: float = STONE.radius
    bounds: Bounds | None = None


@dataclass(frozen=True)
class States:
    """States of the stones at the time 0 in each variant, arrays of shape (variants, stones).

    ``x, y`` in m, ``vx, vy`` in m/s, ``omega`` in rad/s; columns in the order of the shot's
    stones.
    """

    x: Array
    y: Array
    vx: Array
    vy: Array
    omega: Array

    @classmethod
    def of(cls, shot: Shot, variants: int) -> States:
        """Return the states of a shot, repeated."""
        return cls(
            *(
                np.tile([float(getattr(stone, key)) for stone in shot.stones], (variants, 1))
                for key in ("x", "y", "vx", "vy", "omega")
            )
        )


@dataclass(frozen=True)
class HitEvent:
    """One hit: when, of whom, and their states before and after.

    The first stone is the one that was faster before the hit; ``normal`` is the unit vector
    from it to the second.

    Examples
    --------
    >>> import curlshot
    >>> stones = (curlshot.StoneStart("A", 0.0, 1.0, vy=-1.5), curlshot.StoneStart("B", 0.0, 0.0))
    >>> hit = curlshot.simulate(curlshot.Shot(stones)).hits[0]
    >>> f"{hit.stones[0]} on {hit.stones[1]}, {hit.closing_speed:.2f} m/s"
    'A on B, 1.46 m/s'
    """

    t: float
    stones: tuple[str, str]
    normal: tuple[float, float]
    before: Mapping[str, StoneState]
    after: Mapping[str, StoneState]

    @property
    def closing_speed(self) -> float:
        """Speed at which the stones came nearer to each other, m/s."""
        one, two = (self.before[stone] for stone in self.stones)
        nx, ny = self.normal
        return (one.vx - two.vx) * nx + (one.vy - two.vy) * ny


@dataclass(frozen=True)
class Rest:
    """Where (m, rad) and when (s) a stone came to rest or left the play; t = 0 if never moved."""

    x: float
    y: float
    theta: float
    t: float
    in_play: bool = True


@dataclass(frozen=True)
class Simulation:
    """A simulated shot.

    Attributes
    ----------
    hits : tuple of HitEvent
        In the order in which they happened.
    rest : dict
        Per stone its place of rest, or its place at the end where the simulation was ended
        sooner, or where it left the play.
    paths : dict
        Per stone its paths from hit to hit.
    gone : dict
        Time at which stones left the play, s, of those that did.
    """

    hits: tuple[HitEvent, ...]
    rest: Mapping[str, Rest]
    paths: Mapping[str, tuple[Path, ...]]
    gone: Mapping[str, float] = field(default_factory=dict)

    def state(self, stone: str, t: float) -> Motion:
        """State of a stone at a time >= 0, s; at the moment of a hit that after it."""
        paths = self.paths[stone]
        return paths[bisect_right(paths, t, key=lambda path: path.start) - 1].at(t)

    def sample(self, times: ArrayLike) -> pd.DataFrame:
        """States of all stones at given times.

        Parameters
        ----------
        times : array_like, shape (n,)
            Times >= 0, s. At the moment of a hit the state is that after it.

        Returns
        -------
        DataFrame
            `SIMULATION_COLUMNS`, sorted by stone, then in the order of `times`, whose index
            is `frame`. A stone that has left the play has no more rows.

        Raises
        ------
        ValueError
            Where a time lies before 0 or is not finite.
        """
        moments = np.asarray(times, float).ravel()
        if not (np.isfinite(moments).all() and (moments >= 0).all()):
            raise ValueError("a simulation starts at t = 0: sample it at finite times from there")
        names = sorted(self.paths)
        rows = np.array(
            [self.state(name, t) for name in names for t in moments.tolist()], float
        ).reshape(-1, 6)
        table = pd.DataFrame(rows, columns=["x", "y", "theta", "vx", "vy", "omega"])
        table.insert(0, "t", np.tile(moments, len(names)))
        table.insert(0, "frame", np.tile(np.arange(moments.size), len(names)))
        table.insert(
            0, "stone", pd.Series(np.repeat(np.array(names, object), moments.size), dtype=str)
        )
        there = table["t"] <= table["stone"].map(self.gone).fillna(np.inf)
        return table.loc[there, list(SIMULATION_COLUMNS)].reset_index(drop=True)


def check_shot(shot: Shot) -> None:
    """Say all that is wrong with a shot in one InputError; see `simulate`."""
    faults: list[str] = []
    names = [stone.name for stone in shot.stones]
    if not names:
        faults.append("no stone")
    if not (math.isfinite(shot.radius) and shot.radius > 0):
        faults.append(f"radius = {shot.radius:g} must be above 0")
    faults += [f"two stones named {n}" for n in sorted({n for n in names if names.count(n) > 1})]
    for stone in shot.stones:
        after = stone.omega_after
        spins = () if after is None else after if isinstance(after, tuple) else (after,)
        numbers = {key: getattr(stone, key) for key in _NUMBERS}
        faults += [
            f"stone {stone.name}: {key} = {value:g} is not finite"
            for key, value in [*numbers.items(), *(("omega_after", spin) for spin in spins)]
            if not math.isfinite(value)
        ]
        faults += [
            f"stone {stone.name}: {key} = {getattr(stone, key):g} is out of all bounds"
            for key, limit in _LIMITS.items()
            if abs(getattr(stone, key)) > limit
        ]
        if stone.mass <= 0:
            faults.append(f"stone {stone.name}: mass = {stone.mass:g} must be above 0")
    faults += overlaps(shot.stones, shot.radius)
    faults += _faults_of_laws(shot)
    if faults:
        raise InputError(f"shot: {'; '.join(faults)}")


def overlaps(stones: Sequence[StoneStart], radius: float) -> list[str]:
    """Say which stones lie in one another by more than `LARGEST_OVERLAP`."""
    found = []
    for one, two in combinations(stones, 2):
        overlap = 2 * radius - math.dist((one.x, one.y), (two.x, two.y))
        if overlap > LARGEST_OVERLAP * radius:
            found.append(
                f"stones {one.name} and {two.name} overlap by {1000 * overlap:.0f} mm:"
                " move them apart"
            )
    return found


def _faults_of_laws(shot: Shot) -> list[str]:
    """Say which numbers of the laws make no sense. A fit tries some that nothing is made of."""
    laws = (shot.impact, shot.ice, shot.curl)
    faults = [
        f"{law.name}: {key} = {value:g} is not finite"
        for law in laws
        for key, value, _ in _parameters(law)
        if not math.isfinite(value)
    ]
    if faults:
        return faults
    faults += [
        f"{shot.impact.name}: {key} = {value:g} is too small"
        for key, value, limits in _parameters(shot.impact)
        if value < limits.get("low", value) or (limits.get("above") and value == limits["low"])
    ]
    if not float(shot.ice.deceleration(1.0)) > 0:
        faults.append(f"{shot.ice.name}: the ice must slow stones")
    if not float(shot.curl.spin_loss(1.0)) >= 0:
        faults.append(f"{shot.curl.name}: the ice must not speed up spins")
    return faults


def _parameters(law: Any) -> list[tuple[str, float, Mapping[str, Any]]]:
    """Names and values of the numbers of a law, and what limits they have."""
    every = fields(law) if is_dataclass(law) else ()
    named = [(item.name, getattr(law, item.name), item.metadata) for item in every]
    return [one for one in named if isinstance(one[1], float | int)]


_NUMBERS = ("x", "y", "vx", "vy", "omega", "theta", "mass")
_LIMITS = {"x": FARTHEST, "y": FARTHEST, "vx": FASTEST, "vy": FASTEST, "omega": FASTEST}
