"""Values with standard errors: parts of `data.results`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Estimate:
    """A value with its standard error; both None where it is not identifiable."""

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
class Glide:
    """One free glide of one stone and the friction that slowed it.

    ``turn_rate`` is that of its path (rad/s, left positive) at its mean ``speed`` (m/s).
    """

    stone: str
    t0: float
    t1: float
    friction: float | None
    stderr: float | None
    turn_rate: float | None = None
    stderr_turn_rate: float | None = None
    speed: float | None = None
