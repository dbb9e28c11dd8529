"""Values of options: text to numbers, or one line that says what was expected."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.data.errors import InputError
from curlshot.data.limits import POSITIVE, SD_ANGLE, SD_SPEED, SPEED, SPIN, Limits, has_length

if TYPE_CHECKING:
    from curlshot.physics.prediction.what_if import Amount


def number(text: str, limits: Limits) -> float:
    """Read a number between two bounds."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not limits.allow(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not {limits.what}{_with_point(text)}")
    return value


def _with_point(text: str) -> str:
    """Say how a number with a decimal comma is to be written; nothing of other texts."""
    if re.fullmatch(r"[+-]?\d*,\d+x?", text) is None:
        return ""
    return f"; write {text.replace(',', '.')}, with a point"


def within(limits: Limits) -> Callable[[str], float]:
    """Give what reads a number between two bounds."""
    return lambda text: number(text, limits)


def folder(text: str) -> Path:
    """Read the name of a folder; an empty one, as of an unset variable, is refused."""
    if not text.strip():
        raise argparse.ArgumentTypeError(f"{text!r} is not the name of a folder")
    return Path(text)


def amount(text: str) -> Amount:
    """Read a number, or a factor such as ``1.1x``."""
    return _or_factor(text, SPIN)


def speed(text: str) -> Amount:
    """Read a speed, m/s, or a factor such as ``1.1x``."""
    return _or_factor(text, SPEED)


def _or_factor(text: str, limits: Limits) -> Amount:
    """Read a number between two bounds, or a factor."""
    from curlshot.physics.prediction.what_if import amount_of

    try:
        return amount_of(text, limits)
    except InputError as error:
        raise argparse.ArgumentTypeError(f"{error}{_with_point(text)}") from None


def whole(limits: Limits) -> Callable[[str], int]:
    """Give what reads a whole number between two bounds."""

    def read(text: str) -> int:
        if not text.isdecimal() or not limits.allow(int(text)):
            raise argparse.ArgumentTypeError(f"{text!r} is not {limits.what}")
        return int(text)

    return read


def throw_sd(text: str) -> tuple[float, float]:
    """Read ``V,A``: standard deviations of speed, m/s, and direction, rad."""
    parts = text.split(",")
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text!r} is not V,A, e.g. 0.0076,0.0018")
    speed, angle = parts
    return (
        number(speed, SD_SPEED),
        number(angle, SD_ANGLE),
    )


def frame_range(text: str) -> tuple[int, int | None]:
    """Read ``FIRST:LAST``, either of which may be left out."""
    match = re.fullmatch(r"(\d*):(\d*)", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"{text!r} is not FIRST:LAST, e.g. 2:31 or 10:")
    first, last = match.groups()
    return int(first or 0), int(last) if last else None


def stick(text: str) -> tuple[float, float, float, float, float]:
    """Read ``X1,Y1,X2,Y2,METRES``."""
    try:
        x1, y1, x2, y2, metres = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not X1,Y1,X2,Y2,METRES, e.g. 20,36,20,220,0.5"
        ) from None
    ends = x1, y1, x2, y2, metres
    if not has_length(ends):
        raise argparse.ArgumentTypeError(f"{text!r}: the stick has no length")
    return ends


def house(text: str) -> tuple[int | None, float, float, float, float, float, float]:
    """Read ``FRAME:XC,YC,X1,Y1,X2,Y2``; the frame is None where left out."""
    match = re.fullmatch(r"(?:(\d+):)?([^:]*)", text)
    try:
        frame, points = match.groups() if match else (None, "")
        xc, yc, x1, y1, x2, y2 = (float(part) for part in points.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not FRAME:XC,YC,X1,Y1,X2,Y2, e.g. 0:640,360,460,360,640,180"
        ) from None
    return None if frame is None else int(frame), xc, yc, x1, y1, x2, y2


def mass(text: str) -> tuple[str, float]:
    """Read ``STONE=MASS``."""
    name, _, value = text.rpartition("=")
    if not name:
        raise argparse.ArgumentTypeError(f"{text!r} is not STONE=MASS, e.g. A=19.1")
    return name, number(value, POSITIVE)


def pair(text: str) -> tuple[str, str]:
    """Read ``STONE=…``."""
    name, _, value = text.partition("=")
    if not name or not value:
        raise argparse.ArgumentTypeError(f"{text!r} is not STONE=…, e.g. A=a.txt")
    return name, value
