"""Values with their standard errors, and what the free glides of stones show of the ice."""

from __future__ import annotations

import re
from dataclasses import dataclass

from curlshot.data.rounding import DASH, MINUS, plus_minus

_NUMBER_TYPES = "eEfFgGn%"
"""Last letters of a format that is of the numbers, not of the text."""


@dataclass(frozen=True)
class Estimate:
    """A value with its standard error; both None where the value is unknown.

    It prints as value ± standard error, rounded to what the error allows. A format of numbers,
    such as ``.3f``, is that of both.

    Attributes
    ----------
    value, stderr : float or None
        Value and standard error.

    Examples
    --------
    >>> import curlshot
    >>> e = curlshot.Estimate(0.83373, 0.00098)
    >>> print(e)
    0.83373 ± 0.00098
    >>> f"{e:.3f}"
    '0.834 ± 0.001'
    >>> print(curlshot.Estimate())
    —
    """

    value: float | None = None
    stderr: float | None = None

    def __str__(self) -> str:
        if self.value is None:
            reason = getattr(self, "note", None)
            return f"{DASH} ({reason})" if reason else DASH
        return plus_minus(self.value, self.stderr)

    def __format__(self, spec: str) -> str:
        if not spec.endswith(tuple(_NUMBER_TYPES)):
            return format(str(self), spec)
        if self.value is None:
            return str(self)
        value = format(self.value, spec).replace("-", MINUS, 1)
        if self.stderr is None:
            return value
        error = format(self.stderr, spec)
        if self.stderr > 0 and not re.search("[1-9]", error):
            error = f"{self.stderr:.1g}"  # an error that is not zero never prints as zero
        return f"{value} ± {error}"


@dataclass(frozen=True)
class NotedEstimate(Estimate):
    """An estimate with a ``note`` that says why there is none, or what it is worth."""

    note: str | None = None


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
