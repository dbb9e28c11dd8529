"""Numbers as the page writes them: rounded for people, with all their digits for machines."""

from __future__ import annotations

from markupsafe import Markup

from curlshot.report.numbers import DASH, fixed, parts, significant


def data(value: float | None, decimals: int = 3, factor: float = 1.0) -> Markup:
    """Write a number rounded, with all its digits kept in the element for machines."""
    if value is None:
        return Markup(DASH)
    return _element(value, fixed(value * factor, decimals))


def data_significant(value: float | None, digits: int = 3, factor: float = 1.0) -> Markup:
    """Write a number with so many significant digits, all of them kept for machines."""
    if value is None:
        return Markup(DASH)
    return _element(value, significant(value * factor, digits))


def exact(value: float, text: str, stderr: float | None, error: str | None) -> Markup:
    """Write a rounded value, and its rounded error if any, with all digits kept for machines."""
    first = _element(value, text)
    if stderr is None or error is None:
        return first
    return Markup('<span class="pm">{} ± {}</span>').format(first, _element(stderr, error))


def data_parts(value: float | None, stderr: float | None) -> tuple[Markup, Markup | None]:
    """Write a value and its standard error as two elements, rounded together."""
    first, second = parts(value, stderr)
    if value is None:
        return Markup(DASH), None
    error = None if second is None or stderr is None else _element(stderr, second)
    return _element(value, first), error


def _element(value: float, text: str) -> Markup:
    exact = int(value) if float(value).is_integer() and abs(value) < 1e15 else float(value)
    return Markup('<data value="{}">{}</data>').format(repr(exact), text)
