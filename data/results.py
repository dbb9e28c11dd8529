"""The results of a run, as values: the content of ``results.json`` (see `data.results_file`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from curlshot.data.estimates import Estimate as Estimate
from curlshot.data.estimates import Friction as Friction
from curlshot.data.estimates import Glide as Glide
from curlshot.data.estimates import NotedEstimate as NotedEstimate
from curlshot.data.sheet import STONE


@dataclass(frozen=True)
class JointEstimate:
    """Values that were estimated together: their names, numbers and covariance."""

    names: tuple[str, ...]
    values: tuple[float, ...]
    cov: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Method:
    """Restitution and friction by one method, for comparison with other methods.

    ``hits`` holds the restitution of each hit, in the order of the hits.
    """

    restitution: Estimate = field(default_factory=Estimate)
    friction: Estimate = field(default_factory=Estimate)
    stone_friction: NotedEstimate = field(default_factory=NotedEstimate)
    hits: tuple[Estimate, ...] = ()
    note: str | None = None


@dataclass(frozen=True)
class Law:
    """One candidate choice of laws that the shot was fitted with.

    ``criterion`` is minus twice the log probability of the detections, less that of the best.
    ``weight`` is the probability of these laws among the candidates. ``friction`` is that of the
    ice at 1 m/s under them.
    """

    name: str
    criterion: float
    weight: float
    friction: Estimate


@dataclass(frozen=True)
class StoneResult:
    """Estimates from the track of one stone.

    ``friction`` of the ice and ``turn_rate`` of the path (rad/s, left positive) are means over
    the glides of the stone, at their mean ``speed`` (m/s). ``spin`` (rad/s) is that of its first
    observed motion.
    """

    friction: Estimate = field(default_factory=Estimate)
    turn_rate: Estimate = field(default_factory=Estimate)
    speed: float | None = None
    spin: Estimate = field(default_factory=Estimate)


@dataclass(frozen=True)
class TrackResidual:
    """Residual of one segment of a track in the shot fit, between two hits.

    ``rms_ratio`` is the root mean square of the smooth part of the residual from ``t0`` to ``t1``
    (s), over the value expected from the errors. It is 1 or less where ice and hits explain the
    motion. ``significant``: chance does not explain it. ``downweighted``: the fit gives the segment
    little weight because of it.
    """

    stone: str
    t0: float
    t1: float
    rms_ratio: float
    significant: bool
    downweighted: bool


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
class Hit:
    """One measured hit of two stones.

    ``normal`` is the unit vector from the first stone to the second at contact.
    ``restitution`` is None where it is not identifiable (``note`` says why), and so is
    ``stone_friction`` (``note_stone_friction``).
    ``momentum_residual`` is |Σv' − Σv| / |Σv| (masses as given). ``energy_lost`` is the
    fraction of the translational kinetic energy that is lost.

    Examples
    --------
    >>> import curlshot
    >>> hit = curlshot.Hit(1.2, 0.01, ("A", "B"), (0.0, -1.0), 0.83, 0.02, {}, {})
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
        """Time before which the stones surely did not touch, s: three standard errors."""
        return self.t - 3 * (self.stderr_t or 0.0)


@dataclass(frozen=True)
class SimulatedHit:
    """One hit of a simulated shot; the errors of its states follow from those of the start."""

    t: float
    stderr_t: float | None
    stones: tuple[str, str]
    before: Mapping[str, MeasuredState]
    after: Mapping[str, MeasuredState]


@dataclass(frozen=True)
class SimulationScore:
    """Errors of a simulated shot against the measured one.

    ``rmse`` is taken over all stones and times after the first hit, m. ``rest_error`` is by stone
    the distance between simulated and measured last place, m. ``rest_sd`` is by stone the
    standard deviation (m, both axes together) of its simulated last place, from the errors of the
    start and of the laws. ``hits`` are in order of time.
    """

    rmse: float | None
    rest_error: Mapping[str, float | None] = field(default_factory=dict)
    note: str | None = None
    hits: tuple[SimulatedHit, ...] = ()
    rest_sd: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Prediction:
    """Errors of a shot predicted from before its first hit against the measured one.

    ``rmse`` and ``rest_error`` are as in `SimulationScore`. ``rest_sd`` is by stone the prediction
    uncertainty of its last place (r.m.s., m, both axes together): from the states before the hit,
    the ice and the hits. ``restitution`` is the value assumed beforehand. ``friction`` combines the
    assumed value with the motion before the hit.
    ``error_at_comparison`` is by stone the distance between predicted and measured place (m)
    1.16 s after the first hit: the comparison time of the study of the 2018 Olympic final, whose
    error is 5.6 cm. ``sd_at_comparison`` is the prediction uncertainty at that time.
    """

    rmse: float | None
    rest_error: Mapping[str, float | None] = field(default_factory=dict)
    rest_sd: Mapping[str, float | None] = field(default_factory=dict)
    restitution: Estimate = field(default_factory=Estimate)
    friction: Estimate = field(default_factory=Estimate)
    note: str | None = None
    error_at_comparison: Mapping[str, float | None] = field(default_factory=dict)
    sd_at_comparison: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Input:
    """What was read."""

    files: tuple[str, ...]
    fps: float | None
    frames: int
    duration: float


@dataclass(frozen=True)
class Results:
    """All results of a run.

    ``masses`` holds the given ones, in any unit, of all stones or none.
    ``teams`` holds the known teams of the stones, as in ``tracks.csv``.
    ``origin_at_tee`` says whether the origin is the tee of a sheet that lies along y.
    """

    input: Input
    restitution: Estimate
    friction: Friction
    collisions: tuple[Hit, ...] = ()
    glides: tuple[Glide, ...] = ()
    simulations: Mapping[str, SimulationScore] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    radius: float = STONE.radius
    predictions: Mapping[str, Prediction] = field(default_factory=dict)
    joint_estimate: JointEstimate | None = None
    methods: Mapping[str, Method] = field(default_factory=dict)
    model_selection: tuple[Law, ...] = ()
    curl: NotedEstimate = field(default_factory=NotedEstimate)
    stones: Mapping[str, StoneResult] = field(default_factory=dict)
    residuals: tuple[TrackResidual, ...] = ()
    posterior: Posterior | None = None
    masses: Mapping[str, float] = field(default_factory=dict)
    teams: Mapping[str, str] = field(default_factory=dict)
    origin_at_tee: bool = True
