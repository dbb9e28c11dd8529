"""Writing XML of the Open Source Physics library: one element a line, as Tracker reads it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STRINGS = "[Ljava.lang.String;"
"""What Java calls an array of words."""


def thing(cls: str, properties: Iterable[Sequence[str]]) -> list[str]:
    """Write an object of a class with its properties."""
    return [f'<object class="{cls}">', *(line for p in properties for line in p), "</object>"]


def nested(name: str, content: Sequence[str]) -> list[str]:
    """Write a property that is an object."""
    return [f'<property name="{name}" type="object">', *content, "</property>"]


def entry(name: str, value: str | float | bool) -> list[str]:
    """Write a property that is a word, a number or a truth value."""
    kind = {bool: "boolean", int: "int", float: "double", str: "string"}[type(value)]
    text = str(value).lower() if kind == "boolean" else str(value)
    if kind == "string":
        text = " ".join("".join(c for c in text if c.isprintable()).split())
        if not set(text).isdisjoint("\"'<>&"):
            text = f"<![CDATA[{text.replace(']]>', ']] >')}]]>"
    return [f'<property name="{name}" type="{kind}">{text}</property>']


def array(name: str, cls: str, content: Sequence[str]) -> list[str]:
    """Write an array, whose class is Java's name for it."""
    return [f'<property name="{name}" type="array" class="{cls}">', *content, "</property>"]


def sparse(name: str, cls: str, things: Mapping[int, Sequence[str]]) -> list[str]:
    """Write an array of objects of a class, of which some may be missing."""
    body = [line for n, content in things.items() for line in nested(f"[{n}]", content)]
    return array(name, f"[L{cls};", body)


def strings(name: str, words: Mapping[int, str]) -> list[str]:
    """Write an array of words, of which some may be missing."""
    return array(
        name, STRINGS, [line for n, word in words.items() for line in entry(f"[{n}]", word)]
    )


def numbers(name: str, values: Array) -> list[str]:
    """Write an array of one or two dimensions."""

    def row(cells: Array) -> str:
        return "{" + ",".join("NaN" if np.isnan(v) else repr(float(v)) for v in cells) + "}"

    text = row(values) if values.ndim == 1 else "{" + ",".join(row(r) for r in values) + "}"
    return array(name, "[" * values.ndim + "D", entry("array", text))


def collection(name: str, things: Iterable[Sequence[str]]) -> list[str]:
    """Write a list of objects."""
    body = [line for content in things for line in nested("item", content)]
    head = f'<property name="{name}" type="collection" class="java.util.ArrayList">'
    return [head, *body, "</property>"]
