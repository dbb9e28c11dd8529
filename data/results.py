"""What a run found out, as values: the content of ``results.json`` (see `data.results_file`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from curlshot.data.estimates import Estimate as Estimate
from curlshot.data.estimates import Friction as Friction
from curlshot.data.estimates import Glide as Glide
from curlshot.data.estimates import NotedEstimate as NotedEstimate
from curlshot.data.sheet import STONE


@dataclass(frozen=True)
class Joint:
    """Values that were estimated together: their names, numbers and covariance."""

    names: tuple[str, ...]
    values: tuple[float, ...]
    cov: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Method:
    """Restitution and friction by one method, beside which others can be held.

    ``hits`` holds the restitution of each hit, in the order of the collisions.
    """

    restitution: Estimate = field(default_factory=Estimate)
    friction: Estimate = field(default_factory=Estimate)
    stone_friction: NotedEstimate = field(default_factory=NotedEstimate)
    hits: tuple[Estimate, ...] = ()
    note: str | None = None


@dataclass(frozen=True)
class Law:
    """One choice of laws that the shot was fitted with.

    ``criterion`` is minus twice the log probability of the detections, less that of the best;
    ``weight`` is the probability of these laws among those tried, and ``friction`` that of the
    ice at 1 m/s under them.
    """

    name: str
    criterion: float
    weight: float
    friction: Estimate


@dataclass(frozen=True)
class StoneResult:
    """What one stone tells by itself.

    ``friction`` of the ice over its glides, ``turn`` of its path (rad/s, to the left positive)
    and ``speed`` (m/s) at which, both means over its glides; ``spin`` (rad/s) as it is first
    seen to move.
    """

    friction: Estimate = field(default_factory=Estimate)
    turn: Estimate = field(default_factory=Estimate)
    speed: float | None = None
    spin: Estimate = field(default_factory=Estimate)


@dataclass(frozen=True)
class Misfit:
    """How far a stone's track is from its path in the fit of the whole shot, between two hits.

    ``size`` is the root mean square of what is off smoothly, from ``t0`` to ``t1`` (s), over what
    errors make of that: 1, or less, where the stone moves as stones do on ice. ``certain`` tells
    that it is larger than by chance, ``left_out`` that the fit hardly heeds the stretch for it.
    """

    stone: str
    t0: float
    t1: float
    size: float
    certain: bool
    left_out: bool


@dataclass(frozen=True)
class Posterior:
    """Summary of a posterior sample of restitution and frictions.

    ``quantiles`` by name of the quantity, then of the quantile; ``correlation`` by two names.
    """

    samples: int
    quantiles: Mapping[str, Mapping[str, float]]
    correlation: Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class StoneState:
    """Place (m), velocity (m/s) and spin (rad/s) of one stone; None where unknown."""

    x: float
    y: float
    vx: float
    vy: float
    omega: float | None = None


@dataclass(frozen=True)
class MeasuredState(StoneState):
    """The state of a stone as measured, with standard errors; None where unknown."""

    sd_x: float | None = None
    sd_y: float | None = None
    sd_vx: float | None = None
    sd_vy: float | None = None
    sd_omega: float | None = None


@dataclass(frozen=True)
class Collision:
    """One hit of two stones.

    ``normal`` is the unit vector from the first stone to the second at contact,
    ``restitution`` may be None where the hit cannot tell (``note`` says why), and so may
    ``stone_friction`` (``note_stone_friction``),
    ``momentum_residual`` is |Σv' − Σv| / |Σv| (masses as given) and ``energy_lost`` the
    fraction of the translational kinetic energy that is gone.

    Examples
    --------
    >>> import curlshot
    >>> hit = curlshot.Collision(1.2, 0.01, ("A", "B"), (0.0, -1.0), 0.83, 0.02, {}, {})
    >>> print(hit.e)
    0.830 ± 0.020
    """

    t: float
    stderr_t: float | None
    stones: tuple[str, str]
    normal: tuple[float, float]
    restitution: float | None
    stderr: float | None
    before: Mapping[str, MeasuredState]
    after: Mapping[str, MeasuredState]
    momentum_residual: float | None = None
    stderr_momentum: float | None = None
    energy_lost: float | None = None
    stone_friction: float | None = None
    stderr_stone_friction: float | None = None
    note: str | None = None
    note_stone_friction: str | None = None

    @property
    def e(self) -> NotedEstimate:
        """The coefficient of restitution, or why it is unknown."""
        return NotedEstimate(self.restitution, self.stderr, self.note)

    @property
    def earliest(self) -> float:
        """Time before which the stones have not met for certain, s: three standard errors."""
        return self.t - 3 * (self.stderr_t or 0.0)


@dataclass(frozen=True)
class SimulatedHit:
    """One hit of a simulated shot, its states with the errors that the shot's start gives them."""

    t: float
    stderr_t: float | None
    stones: tuple[str, str]
    before: Mapping[str, MeasuredState]
    after: Mapping[str, MeasuredState]


@dataclass(frozen=True)
class SimulationScore:
    """How far a simulated shot was from the measured one.

    ``rmse`` over all stones and times after the first hit, m; ``rest_error`` per stone the
    distance between simulated and measured last place, m; ``hits`` in their order; ``rest_sd``
    per stone the standard deviation (m, both axes together) of its simulated last place, from the
    errors of the start and of the laws.
    """

    rmse: float | None
    rest_error: Mapping[str, float | None] = field(default_factory=dict)
    note: str | None = None
    hits: tuple[SimulatedHit, ...] = ()
    rest_sd: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Prediction:
    """How far a shot predicted from before its first hit was from the measured one.

    ``rmse`` and ``rest_error`` as in `SimulationScore`; ``rest_sd`` per stone how far from its
    predicted last place it may end (r.m.s., m, both axes together), by what is not known of the
    states before the hit, of the ice and of hits. ``restitution`` and ``friction`` are what was
    assumed beforehand: of e nothing else is known, of μ also what was seen until the hit.
    ``error_after`` per stone the distance between its predicted and measured place (m) 1.16 s
    after the first hit, where the study of the 2018 Olympic final states its own, 5.6 cm, and
    ``sd_after`` as `rest_sd`, of the place then.
    """

    rmse: float | None
    rest_error: Mapping[str, float | None] = field(default_factory=dict)
    rest_sd: Mapping[str, float | None] = field(default_factory=dict)
    restitution: Estimate = field(default_factory=Estimate)
    friction: Estimate = field(default_factory=Estimate)
    note: str | None = None
    error_after: Mapping[str, float | None] = field(default_factory=dict)
    sd_after: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Input:
    """What was read."""

    files: tuple[str, ...]
    fps: float | None
    frames: int
    duration: float


@dataclass(frozen=True)
class Results:
    """All that a run found out.

    ``masses`` has those given, in any unit, of all stones or none.
    ``teams`` has each stone's as in ``tracks.csv``, without those of which nothing is known.
    ``sheet`` says whether places count from the tee of a sheet, along y.
    """

    input: Input
    restitution: Estimate
    friction: Friction
    collisions: tuple[Collision, ...] = ()
    glides: tuple[Glide, ...] = ()
    simulations: Mapping[str, SimulationScore] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    radius: float = STONE.radius
    predictions: Mapping[str, Prediction] = field(default_factory=dict)
    laws: Joint | None = None
    methods: Mapping[str, Method] = field(default_factory=dict)
    law_choice: tuple[Law, ...] = ()
    curl: NotedEstimate = field(default_factory=NotedEstimate)
    stones: Mapping[str, StoneResult] = field(default_factory=dict)
    misfits: tuple[Misfit, ...] = ()
    posterior: Posterior | None = None
    masses: Mapping[str, float] = field(default_factory=dict)
    teams: Mapping[str, str] = field(default_factory=dict)
    sheet: bool = True
