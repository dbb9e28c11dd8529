"""Numbers as people read them, rounded to what their error allows."""

from __future__ import annotations

import math

DASH = "—"
MINUS = "−"


def decimals_of(stderr: float) -> int:
    """Decimals at which `stderr` shows two significant digits; negative for tens and more."""
    exponent = int(f"{stderr:.1e}".split("e")[1])
    return 1 - exponent


def fixed(value: float | None, decimals: int = 3) -> str:
    """Write `value` with so many decimals and a true minus sign, `DASH` where there is none."""
    if value is None or not math.isfinite(value):
        return DASH
    text = f"{round(value, decimals):.{max(decimals, 0)}f}"
    # −0.00 is no number that a person would write.
    return text.lstrip("-") if float(text) == 0 else text.replace("-", MINUS)


def significant(value: float | None, digits: int = 3) -> str:
    """Write `value` with so many significant digits, `DASH` where there is none."""
    if value is None or not math.isfinite(value):
        return DASH
    if value == 0:
        return "0"
    exponent = int(f"{value:.{digits - 1}e}".split("e")[1])
    return fixed(value, digits - 1 - exponent)


def parts(
    value: float | None, stderr: float | None, most: int | None = None
) -> tuple[str, str | None]:
    """Round a value and its standard error together.

    Parameters
    ----------
    value, stderr : float or None
        None and NaN stand for "not known".
    most : int, optional
        Decimals at most; up to two more for the first digit of an error that has none there. What
        is nothing at so many, error and all, is written as 0.

    Returns
    -------
    tuple of str and (str or None)
        The value to the last digit of its error; the error to two significant digits, None
        where it is not known or zero, and then the value has three significant digits.
    """
    if value is None or not math.isfinite(value):
        return DASH, None
    if stderr is None or not math.isfinite(stderr) or stderr <= 0:
        return significant(value) if most is None or value == 0 else fixed(value, most), None
    decimals = decimals_of(stderr)
    if most is not None:
        if decimals > most:
            one_digit = decimals - 1
            decimals = one_digit if one_digit <= most + 2 else most
        if max(abs(value), stderr) < 2 * 10**-most:
            return "0", None
    return fixed(value, decimals), fixed(stderr, decimals)


def plus_minus(value: float | None, stderr: float | None) -> str:
    """Write "value ± standard error", rounded by `parts`."""
    first, second = parts(value, stderr)
    return first if second is None else f"{first} ± {second}"
