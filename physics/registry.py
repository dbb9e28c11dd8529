"""Models found by name: each module of a family's package holds one, and that is all it takes.

A family is a package such as `curlshot.physics.ice`. A model is a frozen dataclass with a class
attribute ``name``; its fields are its parameters. To add one, add a file.
"""

from __future__ import annotations

import inspect
import pkgutil
from dataclasses import MISSING, Field, field, fields, is_dataclass
from functools import cache
from importlib import import_module
from typing import Any

FAMILIES: tuple[str, ...] = ("ice", "curl", "impact")
"""The interactions that have more than one model."""


def parameter(default: float, low: float, high: float, *, above: bool = False) -> Any:
    """Field of a model with what it may be: `low` to `high`, or `above` `low` only."""
    return field(default=default, metadata={"low": low, "high": high, "above": above})


@cache
def models(family: str) -> dict[str, type[Any]]:
    """All models of a family by name, in the order of the names.

    Parameters
    ----------
    family : str
        One of `FAMILIES`.

    Raises
    ------
    ValueError
        Where there is no such family.

    Examples
    --------
    >>> list(models("ice"))
    ['constant', 'fcv1', 'fit', 'penner']
    """
    if family not in FAMILIES:
        raise ValueError(f"no family {family!r}; there are {', '.join(FAMILIES)}")
    package = import_module(f"curlshot.physics.{family}")
    found: dict[str, type[Any]] = {}
    for info in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
        module = import_module(info.name)
        for item in vars(module).values():
            if (
                inspect.isclass(item)
                and item.__module__ == info.name
                and is_dataclass(item)
                and isinstance(getattr(item, "name", None), str)
            ):
                found[item.name] = item  # type: ignore[attr-defined]
    return dict(sorted(found.items()))


def model(family: str, name: str, **parameters: float) -> Any:
    """Return the model of that name with these parameters, the rest as published.

    Raises
    ------
    ValueError
        Where there is no such model, or it has no such parameter.

    Examples
    --------
    >>> model("ice", "constant", friction=0.012)
    Constant(friction=0.012)
    """
    known = models(family)
    if name not in known:
        raise ValueError(f"no model {name!r} of {family}; there are {', '.join(known)}")
    names = [item.name for item in parameters_of(known[name])]
    for key in parameters:
        if key not in names:
            has = f"it has {', '.join(names)}" if names else "it has none"
            raise ValueError(f"the {family} model {name} has no parameter {key}; {has}")
    return known[name](**parameters)


def parameters_of(kind: type[Any]) -> tuple[Field[Any], ...]:
    """Fields of a model, each with a default."""
    found = fields(kind)
    missing = [item.name for item in found if item.default is MISSING]
    if missing:
        raise TypeError(f"{kind.__name__}: parameters without a default: {', '.join(missing)}")
    return found
