"""Text of any encoding, and numbers of any locale: decimal sign, minus, digits, exponents."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from pathlib import Path

from curlshot.data.errors import InputError

LARGEST = 64_000_000
"""Bytes; a larger file is no table of tracks."""

MOST_LINES = 1_000_000
"""A clip of ten minutes with sixteen stones, one row each, has half as many."""

LONGEST_LINE = 1_000_000
"""Characters; a row of numbers has a few hundred."""

_EXPORT = "from Tracker, save tracks as text with File > Export > Data"

NUMBER = re.compile(
    r"[+-]?(\d+([.,]\d*)?|[.,]\d+)(e[+-]?\d+)?|[+-]?(inf|infinity|∞)", re.IGNORECASE
)
"""A number as written in any locale, with plain digits."""

_BIDI_MARKS = dict.fromkeys(map(ord, "\u200e\u200f\u061c\u2066\u2067\u2068\u2069"))
_SIGNS = {0x066B: ".", 0xFF0E: ".", 0xFF0C: ",", 0xFF0B: "+"}
_MINUS = dict.fromkeys(map(ord, "\u2212\u2010\u2011\u2012\u2013\ufe63\uff0d"), "-")


def printable(text: str) -> str:
    """Put a question mark for what is no text, as in names of files in an encoding of old."""
    return text.encode("utf-8", "replace").decode("utf-8")


def read_text(path: Path) -> str:
    """Return the text of a file with Unix line ends.

    Raises
    ------
    InputError
        Where it is missing, no text, or beyond all measure.
    """
    try:
        size = path.stat().st_size
        if size > LARGEST:
            raise InputError(f"{path}: {size / 1e6:.0f} MB is too large for a table of tracks")
        raw = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise InputError(f"{path}: a folder, not a table of tracks") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read ({error})") from None
    if (wide := _utf_16(raw)) is not None:
        text = raw.decode(wide, errors="replace")
    elif b"\0" in raw or raw.startswith(b"PK\x03\x04"):
        raise InputError(f"{path}: not text, so no table of tracks; {_EXPORT}")
    else:
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = raw.decode("cp1252", errors="replace")
    if text.lstrip()[:1] == "<":
        raise InputError(f"{path}: XML, not a table of tracks; {_EXPORT}")
    text = text.replace("\r\n", "\n").replace("\r", "\n").replace("\0", "\ufffd")
    text = text.removesuffix("\x1a")  # the end of a file, of old
    if (lines := text.count("\n")) > MOST_LINES:
        raise InputError(f"{path}: {lines} lines are too many for a table of tracks")
    if len(text) > LONGEST_LINE and max(map(len, text.split("\n"))) > LONGEST_LINE:
        raise InputError(f"{path}: a line of over {LONGEST_LINE} characters is no row of a table")
    return text


def _utf_16(raw: bytes) -> str | None:
    """Tell which UTF-16 a text is in, with a mark at its beginning or without one."""
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    # Digits and Latin letters have one zero each, all at odd or all at even places.
    halves = {"utf-16-be": raw[::2], "utf-16-le": raw[1::2]}
    zeros = {name: half.count(0) for name, half in halves.items()}
    found = max(zeros, key=lambda name: zeros[name])
    told = 2 * zeros[found] > len(halves[found]) and len(raw) % 2 == 0
    # A letter as 一 has its zero where digits have none, but no letter has two.
    return found if told and "\0" not in raw.decode(found, errors="replace") else None


def plain_digits(text: str) -> str:
    """Write digits, signs and exponents as ASCII: ``−2,6×10^−2`` becomes ``-2,6E-2``."""
    if text.isascii():
        return text
    signs: dict[int, str | None] = {**_BIDI_MARKS, **_MINUS, **_SIGNS}
    for character in set(text):
        if not character.isascii() and character.isdecimal():
            signs[ord(character)] = str(unicodedata.decimal(character))
    text = re.sub(r"(?<=\d)[\xa0\u2009\u202f](?=\d{3}(?!\d))", "", text)  # thousands
    plain = text.translate(signs).replace("أس", "E").replace("اس", "E")
    return re.sub(r"[ \xa0]?[×·⋅][ \xa0]?10\^(?=[+-]?\d)", "E", plain)


def plain_decimals(columns: Sequence[list[str]], source: str) -> list[list[str]]:
    """Write decimal commas as points, in all columns or in none.

    Raises
    ------
    InputError
        Where some numbers have a decimal comma and others a point.
    """
    commas = any("," in cell for cells in columns for cell in cells)
    if not commas:
        return list(columns)
    for cells in columns:
        for cell in cells:
            if "." in cell and NUMBER.fullmatch(cell.replace(",", "")):
                raise InputError(
                    f"{source}: both commas and points in numbers ({quoted(cell)}): which is the"
                    " decimal sign?"
                )
    return [[cell.replace(",", ".") for cell in cells] for cells in columns]


def quoted(text: str) -> str:
    """Quote the beginning of a text for a message."""
    clean = " ".join("".join(c if c.isprintable() else " " for c in text[:200]).split())
    return f"“{clean[:40]}…”" if len(clean) > 40 else f"“{clean}”"
