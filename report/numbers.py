"""Words of a report: assumptions, warnings and counts; and the numbers of `data.rounding`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from curlshot.data.rounding import DASH as DASH
from curlshot.data.rounding import MINUS as MINUS
from curlshot.data.rounding import fixed as fixed
from curlshot.data.rounding import parts as parts
from curlshot.data.rounding import plus_minus as plus_minus
from curlshot.data.rounding import significant as significant

if TYPE_CHECKING:
    from curlshot.data.results import Prediction


def assumed(guess: Prediction) -> str:
    """Return the e that a prediction assumes, and the μ where it was given and not measured."""
    e, mu = guess.restitution.value, guess.friction
    said = "e" if e is None else f"e = {e:.3g}"
    return f"{said} and μ = {mu.value:.3g} assumed" if mu.stderr == 0 else f"{said} assumed"


def warned(texts: Iterable[str]) -> list[str]:
    """Write each warning on a line of its own, as a summary has them."""
    return [f"warning     {text}" for text in texts]


def count(number: int, what: str) -> str:
    """Write number and noun, in the plural where it is not one."""
    return f"{number} {what}{'' if number == 1 else 's'}"
