"""How long work says how far it is, without the library printing anything."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, int, int | None], None]
"""Called as ``progress(what, done, total)``; `total` is None where it is not known."""


def no_progress(what: str, done: int, total: int | None) -> None:
    """Take no notice."""
