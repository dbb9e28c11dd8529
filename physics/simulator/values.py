"""A shot as plain values that JSON knows, laws by their names, and such values as a shot again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from curlshot.physics.registry import FAMILIES, model
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulation import Shot, StoneStart


def shot_values(shot: Shot) -> dict[str, Any]:
    """Give a shot as plain values.

    Returns
    -------
    dict
        ``stones`` (list of the fields of `StoneStart`, ``omega_after`` always a list),
        ``radius``, ``bounds`` (of `Bounds`, or None), and ``impact``, ``ice`` and ``curl``, each
        with the ``name`` and the parameters of the law.
    """
    stones = []
    for stone in shot.stones:
        given = stone.omega_after
        after = given if isinstance(given, tuple) else () if given is None else (given,)
        stones.append({**asdict(stone), "omega_after": list(after)})
    laws = {
        family: {"name": law.name, **asdict(law)}  # type: ignore[call-overload]
        for family, law in (("impact", shot.impact), ("ice", shot.ice), ("curl", shot.curl))
    }
    bounds = None if shot.bounds is None else asdict(shot.bounds)
    return {"stones": stones, "radius": shot.radius, "bounds": bounds, **laws}


def shot_of(values: Mapping[str, Any]) -> Shot:
    """Make a shot of what `shot_values` gave.

    Raises
    ------
    KeyError, TypeError, ValueError
        Where something is missing, of the wrong kind, or no law of that name is known.
    """
    stones = tuple(
        StoneStart(**{**stone, "name": str(stone["name"]), "omega_after": after or None})
        for stone in values["stones"]
        for after in [tuple(stone["omega_after"])]
    )
    laws = {family: model(family, **values[family]) for family in FAMILIES}
    bounds = None if values["bounds"] is None else Bounds(**values["bounds"])
    return Shot(stones, radius=values["radius"], bounds=bounds, **laws)
