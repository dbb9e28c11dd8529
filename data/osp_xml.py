"""XML of the Open Source Physics library, in which Tracker keeps its projects.

Grammar: ``<object class="…">`` holds ``<property name="…" type="…">``, and a property holds
text, an object, or, as array and collection, further properties. Nothing is loaded from
elsewhere, and a file that defines entities is refused.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import InputError

Array = NDArray[np.float64]

LARGEST = 50_000_000
"""Bytes; a thousand marked frames are half a million."""

DEEPEST = 60
"""Levels of elements; Tracker's own files have about twenty."""

_CONTAINERS = ("array", "collection")


@dataclass
class Thing:
    """An object, array or collection and what it holds.

    Attributes
    ----------
    cls : str
        Class without its package, such as ``PointMass``; of arrays and collections as
        written.
    values : dict of str to (str or Thing)
        Properties by name: numbers, words and truth values as text, the rest as things.
    items : list of (str or Thing)
        What a collection holds, in order.
    """

    cls: str
    values: dict[str, str | Thing] = field(default_factory=dict)
    items: list[str | Thing] = field(default_factory=list)

    def text(self, name: str, default: str = "") -> str:
        """Give a property's text, or `default` where there is none."""
        value = self.values.get(name)
        return value if isinstance(value, str) else default

    def number(self, name: str, default: float | None = None) -> float:
        """Give a property's finite number.

        Raises
        ------
        InputError
            Where it is missing without a default, or no finite number.
        """
        value = self.values.get(name)
        if value is None and default is not None:
            return default
        try:
            number = float(value) if isinstance(value, str) and "_" not in value else math.nan
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise InputError(f"{self.cls} has no number {name} ({_short(value)})")
        return number

    def whole(self, name: str, default: int | None = None) -> int:
        """Give a property's whole number of at most nine digits, or raise `InputError`."""
        number = self.number(name, default)
        if number != int(number) or abs(number) > 1e9:
            raise InputError(f"{self.cls}: {name} is no whole number ({number:g})")
        return int(number)

    def true(self, name: str) -> bool:
        """Give a property's truth value; false where there is none."""
        return self.text(name, "false") == "true"

    def thing(self, name: str) -> Thing | None:
        """Give the object, array or collection of that name, if there is one."""
        value = self.values.get(name)
        return value if isinstance(value, Thing) else None

    def objects(self) -> Iterator[Thing]:
        """Go through the objects of a collection."""
        return (item for item in self.items if isinstance(item, Thing))

    def sparse(self) -> dict[int, str | Thing]:
        """Give the entries of an array by index; null entries are left out.

        Raises
        ------
        InputError
            Where an index is none.
        """
        entries: dict[int, str | Thing] = {}
        for name, value in self.values.items():
            digits = name[1:-1]
            if not (name[:1] == "[" and name[-1:] == "]" and digits.isdecimal()):
                continue
            if len(digits) > 9:
                raise InputError(f"{self.cls}: index {_short(name)} is too large")
            if value != "null":
                entries[int(digits)] = value
        return entries

    def floats(self) -> Array:
        """Give the numbers of a primitive array, flattened; NaN is kept.

        Raises
        ------
        InputError
            Where something in it is no number.
        """
        cells = self.text("array").replace("{", " ").replace("}", " ").replace(",", " ").split()
        try:
            return np.array([float(cell) for cell in cells], float)
        except ValueError:
            raise InputError(f"{self.cls}: an array holds what is no number") from None


def parse(raw: bytes, source: str) -> Thing:
    """Read the root object of an XML file.

    Parameters
    ----------
    raw : bytes
        The file.
    source : str
        What to call it in messages.

    Raises
    ------
    InputError
        Where it is malformed, of another grammar, too large, or defines entities.
    """
    if len(raw) > LARGEST:
        raise InputError(f"{source}: {len(raw) / 1e6:.0f} MB is too large for a Tracker project")
    builder = _Builder(source)
    parser = expat.ParserCreate(_encoding(raw))
    parser.buffer_text = True
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.characters
    parser.EntityDeclHandler = builder.entity
    try:
        parser.Parse(raw, True)
    except expat.ExpatError as error:
        raise InputError(
            f"{source}: damaged, or no Tracker project: {expat.ErrorString(error.code)} in line"
            f" {error.lineno}"
        ) from None
    except (UnicodeError, LookupError, ValueError):  # an encoding that is none
        raise InputError(f"{source}: damaged, or no Tracker project: not readable text") from None
    if builder.root is None:
        raise InputError(f"{source}: no Tracker project: XML without an object")
    return builder.root


@dataclass
class _Open:
    """An element whose end has not come yet: its name and what it holds so far."""

    name: str
    thing: Thing | None


def _encoding(raw: bytes) -> str | None:
    """Name the encoding where the file's own word for it cannot be true: Tracker Online's."""
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        return None
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError:
        return "iso-8859-1"
    return None


class _Builder:
    """Builds things from the parser's events."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.root: Thing | None = None
        self.open: list[_Open] = []
        self.words: list[str] = []

    def start(self, element: str, attributes: dict[str, str]) -> None:
        if len(self.open) >= DEEPEST:
            raise InputError(f"{self.source}: no Tracker project: nested too deeply")
        self.words = []
        cls = attributes.get("class", "")
        if element == "object":
            self.open.append(_Open("", Thing(cls.rpartition(".")[2])))
        elif element == "property" and self.open:
            container = Thing(cls) if attributes.get("type") in _CONTAINERS else None
            self.open.append(_Open(attributes.get("name", ""), container))
        else:
            raise InputError(
                f"{self.source}: no Tracker project: XML with an element {_short(element)}"
            )

    def end(self, element: str) -> None:
        here = self.open.pop()
        if not self.open:
            self.root = here.thing
            return
        outer = self.open[-1]
        if element == "object":
            # The property around an object takes it for its value.
            outer.thing = outer.thing or here.thing
        elif outer.thing is not None:
            value = "".join(self.words) if here.thing is None else here.thing
            if here.name == "item":
                outer.thing.items.append(value)
            else:
                outer.thing.values[here.name] = value
        self.words = []

    def characters(self, text: str) -> None:
        self.words.append(text)

    def entity(self, *_: object) -> None:
        raise InputError(f"{self.source}: no Tracker project: XML that defines entities")


def _short(value: object) -> str:
    text = " ".join(str(value)[:60].split())
    return f"“{text}”"
