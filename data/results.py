"""What a run found out, as values: the content of ``results.json``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

from data.errors import InputError
from data.files import write_text

SCHEMA = 1

_Made = TypeVar("_Made")


@dataclass(frozen=True)
class Estimate:
    """A value with its standard error; both None where the input cannot tell."""

    value: float | None = None
    stderr: float | None = None


@dataclass(frozen=True)
class Friction(Estimate):
    """Coefficient of friction of the ice, with the law that it belongs to.

    ``law`` is ``constant``, or ``fit`` for μ(v) = a / (v + v_c) + b; then the value is that at
    1 m/s, and ``a``, ``v_c`` (m/s) and ``b`` are the law's constants.
    """

    law: str = "constant"
    a: float | None = None
    v_c: float | None = None
    b: float | None = None


@dataclass(frozen=True)
class Joint:
    """Values that were estimated together: their names, numbers and covariance."""

    names: tuple[str, ...]
    values: tuple[float, ...]
    cov: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Told(Estimate):
    """An estimate with a ``note`` that says why there is none, or what it is worth."""

    note: str | None = None


@dataclass(frozen=True)
class Method:
    """Restitution and friction by one method, beside which others can be held.

    ``hits`` holds the restitution of each hit, in the order of the collisions.
    """

    restitution: Estimate = field(default_factory=Estimate)
    friction: Estimate = field(default_factory=Estimate)
    stone_friction: Told = field(default_factory=Told)
    hits: tuple[Estimate, ...] = ()
    note: str | None = None


@dataclass(frozen=True)
class Law:
    """One choice of laws that the shot was fitted with.

    ``criterion`` is minus twice the log probability of the sightings, less that of the best;
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
    def earliest(self) -> float:
        """Time before which the stones have not met for certain, s: three standard errors."""
        return self.t - 3 * (self.stderr_t or 0.0)


@dataclass(frozen=True)
class Glide:
    """One free glide of one stone and the friction that slowed it.

    ``turn`` is how its path turned (rad/s, to the left positive) at its mean ``speed`` (m/s).
    """

    stone: str
    t0: float
    t1: float
    friction: float | None
    stderr: float | None
    turn: float | None = None
    stderr_turn: float | None = None
    speed: float | None = None


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

    ``rmse`` and ``rest_error`` as in `SimulationScore`; ``rest_sd`` per stone the standard
    deviation (m, both axes together) of its predicted last place, from the errors of the states
    before the hit and of the ``restitution`` and ``friction`` assumed, each with its own.
    ``error_after`` per stone the distance between its predicted and measured place (m) 1.16 s
    after the first hit, where the study of the 2018 Olympic final states its own, 5.6 cm.
    """

    rmse: float | None
    rest_error: Mapping[str, float | None] = field(default_factory=dict)
    rest_sd: Mapping[str, float | None] = field(default_factory=dict)
    restitution: Estimate = field(default_factory=Estimate)
    friction: Estimate = field(default_factory=Estimate)
    note: str | None = None
    error_after: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Input:
    """What was read."""

    files: tuple[str, ...]
    fps: float | None
    frames: int
    duration: float


@dataclass(frozen=True)
class Results:
    """All that a run found out; see `to_json` for the file's form.

    ``masses`` has those given, in any unit, of all stones or none. ``teams`` has each stone's as in
    ``tracks.csv``, without those of which nothing is known.
    """

    input: Input
    restitution: Estimate
    friction: Friction
    collisions: tuple[Collision, ...] = ()
    glides: tuple[Glide, ...] = ()
    simulations: Mapping[str, SimulationScore] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    radius: float = 0.1455
    predictions: Mapping[str, Prediction] = field(default_factory=dict)
    laws: Joint | None = None
    methods: Mapping[str, Method] = field(default_factory=dict)
    law_choice: tuple[Law, ...] = ()
    curl: Told = field(default_factory=Told)
    stones: Mapping[str, StoneResult] = field(default_factory=dict)
    posterior: Posterior | None = None
    masses: Mapping[str, float] = field(default_factory=dict)
    teams: Mapping[str, str] = field(default_factory=dict)

    def to_json(self) -> str:
        """Text of ``results.json``: strict JSON, values that are not finite as null."""
        return json.dumps(
            _plain({"schema": SCHEMA, **asdict(self)}),
            indent=1,
            ensure_ascii=False,
            allow_nan=False,
        )

    def write(self, path: Path) -> None:
        """Write ``results.json`` whole or not at all."""
        write_text(path, self.to_json() + "\n")

    @classmethod
    def read(cls, path: Path) -> Results:
        """Read a ``results.json``.

        Raises
        ------
        InputError
            Where the file is missing or no such thing.
        """
        try:
            raw = json.loads(path.read_text(encoding="utf-8"))
            if raw.pop("schema") != SCHEMA:
                raise InputError(f"{path}: results of another version; run again")
            return cls(
                input=_made(Input, {**raw["input"], "files": tuple(raw["input"]["files"])}),
                restitution=_made(Estimate, raw["restitution"]),
                friction=_made(Friction, raw["friction"]),
                collisions=tuple(_collision(item) for item in raw["collisions"]),
                glides=tuple(_made(Glide, item) for item in raw["glides"]),
                simulations={name: _simulated(item) for name, item in raw["simulations"].items()},
                warnings=tuple(raw["warnings"]),
                radius=_length(raw["radius"]),
                predictions={
                    name: _prediction(item) for name, item in raw.get("predictions", {}).items()
                },
                laws=_joint(raw.get("laws")),
                methods={name: _method(item) for name, item in raw.get("methods", {}).items()},
                law_choice=tuple(
                    _made(Law, _with_estimates(item, "friction"))
                    for item in raw.get("law_choice", ())
                ),
                curl=_made(Told, raw.get("curl", {})),
                stones={
                    name: _made(StoneResult, _with_estimates(item, "friction", "turn", "spin"))
                    for name, item in raw.get("stones", {}).items()
                },
                posterior=(_made(Posterior, raw["posterior"]) if raw.get("posterior") else None),
                masses={str(name): _length(mass) for name, mass in raw.get("masses", {}).items()},
                teams={str(name): str(team) for name, team in raw.get("teams", {}).items()},
            )
        except OSError as error:
            raise InputError(f"{path}: {error.strerror}") from None
        except (ValueError, KeyError, TypeError, AttributeError):
            raise InputError(f"{path}: not a results.json of this program") from None


def _collision(item: dict[str, Any]) -> Collision:
    nx, ny = item["normal"]
    return _made(Collision, {**item, **_sides(item), "normal": (nx, ny)})


def _simulated(item: dict[str, Any]) -> SimulationScore:
    hits = tuple(_made(SimulatedHit, {**hit, **_sides(hit)}) for hit in item.get("hits", ()))
    return _made(SimulationScore, {**item, "hits": hits})


def _sides(hit: dict[str, Any]) -> dict[str, Any]:
    """Read who hit whom, and their states before and after."""
    first, second = hit["stones"]
    states = {
        when: {name: _made(MeasuredState, hit[when][name]) for name in (first, second)}
        for when in ("before", "after")
    }
    return {"stones": (first, second), **states}


def _made(kind: type[_Made], item: Mapping[str, Any]) -> _Made:
    """Make a value of what JSON gave; TypeError where a number is none."""
    made = kind(**item)
    for name, hint in get_type_hints(kind).items():
        value = getattr(made, name)
        absent = value is None and hint == float | None
        if hint in (float, float | None) and not (absent or type(value) in (int, float)):
            raise TypeError(f"{name} is no number")
    return made


def _length(value: Any) -> float:
    if type(value) not in (int, float) or not 0 < value < math.inf:
        raise TypeError("no length nor mass")
    return float(value)


def _prediction(item: dict[str, Any]) -> Prediction:
    return _made(Prediction, _with_estimates(item, "restitution", "friction"))


def _method(item: dict[str, Any]) -> Method:
    hits = tuple(_made(Estimate, hit) for hit in item["hits"])
    told = _made(Told, item["stone_friction"])
    own = _with_estimates(item, "restitution", "friction")
    return _made(Method, {**own, "stone_friction": told, "hits": hits})


def _with_estimates(item: dict[str, Any], *names: str) -> dict[str, Any]:
    """Make the estimates of an item of these names."""
    return {**item, **{name: _made(Estimate, item[name]) for name in names}}


def _joint(item: dict[str, Any] | None) -> Joint | None:
    if item is None:
        return None
    names, cov = tuple(item["names"]), tuple(tuple(map(float, row)) for row in item["cov"])
    if {len(names)} != {len(item["values"]), len(cov), *map(len, cov)}:
        raise ValueError("names, values and covariance do not fit")
    return Joint(names, tuple(map(float, item["values"])), cov)


def _plain(value: Any) -> Any:
    """Reduce to what JSON knows; numbers that are not finite become None."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, bool) or value is None or isinstance(value, (str, int)):
        return value
    number = float(value)
    return number if math.isfinite(number) else None
