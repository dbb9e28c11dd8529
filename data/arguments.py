"""Checks of the arguments of public functions: an `InputError` names the argument."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from reprlib import repr as shortened
from typing import Any

from curlshot.data.errors import InputError


def check_type(name: str, given: object, kinds: type | tuple[type, ...], what: str) -> None:
    """Raise `InputError` where an argument is of no such type; `what` says what is expected.

    Examples
    --------
    >>> check_type("`speed`", [], float, "a number")
    Traceback (most recent call last):
        ...
    curlshot.data.errors.InputError: `speed`: [] is not a number
    """
    if not isinstance(given, kinds):
        raise InputError(f"{name}: {' '.join(shortened(given).split())} is not {what}")


def checked_path(name: str, given: Any) -> Path:
    """Return the path that an argument is; refuse what is none."""
    check_type(f"`{name}`", given, (str, os.PathLike), "a path")
    return Path(given)


def checked_paths(name: str, given: Any) -> tuple[str | Path, ...]:
    """Return the paths that an argument is, one or several; refuse what is none.

    A text stays a text: it may be a pattern.
    """
    if isinstance(given, str | os.PathLike):
        given = (given,)
    check_type(f"`{name}`", given, Iterable, "a path, nor several")
    paths = tuple(given)
    for path in paths:
        check_type(f"`{name}`", path, (str, os.PathLike), "a path")
    return tuple(path if isinstance(path, str) else Path(path) for path in paths)
