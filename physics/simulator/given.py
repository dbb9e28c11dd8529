"""A shot that is written in Python: whether its parts are what they must be."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from numbers import Real
from typing import Any

from curlshot.data.arguments import check_type
from curlshot.data.errors import InputError
from curlshot.data.limits import Limits
from curlshot.physics.registry import models, parameters_of
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulation import Shot, StoneStart, check_shot

_LAWS = {
    "impact": ("change", "a model of hits such as Frictional()"),
    "ice": ("deceleration", "a law of ice such as FCV1()"),
    "curl": ("turn_rate", "a law of curl such as FCV1Curl()"),
}
"""What a law of each family can do, and what it is."""

_NUMBERS = ("x", "y", "vx", "vy", "omega", "theta", "mass")


def check_given(shot: Shot) -> None:
    """Refuse a shot whose parts are of a wrong type or out of bounds; see `check_shot` too.

    A fit may try parameters beyond their bounds, so `check_shot` allows them.

    Raises
    ------
    InputError
        The message names the argument.
    """
    check_type("`stones`", shot.stones, (tuple, list), "a tuple of StoneStart")
    for stone in shot.stones:
        check_type("`stones`", stone, StoneStart, "a StoneStart")
        _check_stone(stone)
    _check_number("`radius`", shot.radius)
    check_type("`bounds`", shot.bounds, (Bounds, type(None)), "Bounds or None")
    for family in _LAWS:
        _check_law(family, getattr(shot, family))
    check_shot(shot)


def _check_stone(stone: StoneStart) -> None:
    """Refuse a stone whose name is no text, or whose numbers are none."""
    check_type("`name`", stone.name, str, "the name of a stone")
    for name in _NUMBERS:
        _check_number(f"`{name}` of stone {stone.name}", getattr(stone, name))
    after = stone.omega_after
    for spin in after if isinstance(after, tuple) else () if after is None else (after,):
        _check_number(f"`omega_after` of stone {stone.name}", spin)


def _check_number(name: str, given: object) -> None:
    """Refuse what is no number; `check_shot` knows how large it may be."""
    if isinstance(given, bool) or not isinstance(given, Real):
        check_type(name, given, (), "a number")


def _check_law(family: str, law: Any) -> None:
    """Refuse what is no law of a family, or one whose parameters lie out of their bounds."""
    ability, what = _LAWS[family]
    if isinstance(law, type) or not callable(getattr(law, ability, None)):
        raise InputError(f"`{family}`: {law!r} is not {what}")
    if type(law) in models(family).values():
        for item in parameters_of(type(law)):
            limits = _limits(item.metadata)
            limits.check(f"`{item.name}` of `{family}`", getattr(law, item.name))


def _limits(metadata: Mapping[str, Any]) -> Limits:
    """Return the limits of a parameter of a law."""
    low, high, above = metadata["low"], metadata["high"], metadata["above"]
    least = f"above {low:g}" if above else f"{low:g} or more"
    most = f", at most {high:g}" if math.isfinite(high) else ""
    return Limits(
        math.nextafter(low, math.inf) if above else low,
        min(high, sys.float_info.max),
        f"a number {least}{most}",
    )
