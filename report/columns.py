"""A table as people read it: which columns, in what unit, rounded how; for page and paper alike."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import pandas as pd
from markupsafe import Markup, escape

from curlshot.data.coach_units import METRES, Unit
from curlshot.report.cells import exact
from curlshot.report.numbers import fixed, parts, significant


@dataclass(frozen=True)
class Column:
    """One column: its head, where its values come from, and how they are written.

    Attributes
    ----------
    title : str
        Plain text; a letter with an index as ``v_x``.
    key : str
        Column of the frame.
    unit : str
        Of what is written.
    kind : str
        number, word or note: how it is set.
    stderr : str, optional
        Column of the frame with the standard error; value and error are rounded together.
    decimals : int, optional
        Written with so many; with `stderr` it is the most.
    digits : int
        Significant digits where neither `stderr` nor `decimals` says otherwise.
    factor : float
        From the frame's SI unit to `unit`.
    lengths : Unit
        In which notes name lengths and speeds; in the frame they are in m.
    """

    title: str
    key: str
    unit: str = ""
    kind: Literal["number", "word", "note"] = "number"
    stderr: str | None = None
    decimals: int | None = None
    digits: int = 3
    factor: float = 1.0
    lengths: Unit = METRES

    @property
    def head(self) -> Markup:
        """The head as the page writes it."""
        if self.symbol is None:
            return escape(self.title)
        return Markup("{}<sub>{}</sub>").format(*self.symbol)

    @property
    def symbol(self) -> tuple[str, str] | None:
        """Letter and index of a head such as ``v_x``; None where it is words."""
        found = re.fullmatch(r"(\w)_(\w)", self.title)
        return None if found is None else (found[1], found[2])

    def parts(self, row: Mapping[str, object]) -> tuple[str, str | None]:
        """Write of a row the value, and the standard error if there is one."""
        if self.kind != "number":
            value = row[self.key]
            # A rank turns into a float where one is missing.
            if isinstance(value, float) and value.is_integer():
                value = int(value)
            text = "" if value is None or value != value else str(value)
            return (self.lengths.converted(text) if self.kind == "note" else text), None
        number = self._number(row, self.key)
        if self.stderr is not None:
            return parts(number, self._number(row, self.stderr), self.decimals)
        if self.decimals is not None:
            return fixed(number, self.decimals), None
        return significant(number, self.digits), None

    def cell(self, row: Mapping[str, object]) -> Markup:
        """Write a row's cell for the page: rounded, all digits kept for machines."""
        text, error = self.parts(row)
        value = as_number(row[self.key])
        if self.kind != "number" or value is None:
            return escape(text)
        stderr = None if self.stderr is None else as_number(row[self.stderr])
        return exact(value, text, stderr, error)

    def _number(self, row: Mapping[str, object], key: str) -> float | None:
        value = as_number(row[key])
        return None if value is None else value * self.factor


@dataclass(frozen=True)
class Table:
    """One table of a shot.

    Attributes
    ----------
    name : str
        Of its files.
    title : str
        One line above it.
    note : str
        What a reader has to know; may be empty.
    columns : tuple of Column
        What is shown.
    frame : DataFrame
        All of it, SI units, with standard errors.
    """

    name: str
    title: str
    note: str
    columns: tuple[Column, ...]
    frame: pd.DataFrame

    @cached_property
    def head(self) -> tuple[Column, ...]:
        """Columns that are shown: one of notes that has none to say would only take room."""
        return tuple(
            column
            for column in self.columns
            if column.kind != "note" or any(column.parts(row)[0] for row in self.records)
        )

    @cached_property
    def records(self) -> Sequence[Mapping[str, object]]:
        """The rows, exact."""
        return [{str(k): v for k, v in row.items()} for row in self.frame.to_dict("records")]

    @property
    def rows(self) -> tuple[tuple[Markup, ...], ...]:
        """The cells as the page writes them."""
        return tuple(tuple(column.cell(row) for column in self.head) for row in self.records)


def as_number(cell: object) -> float | None:
    """Return a cell as a finite number, else None."""
    if isinstance(cell, int | float | np.integer | np.floating) and np.isfinite(cell):
        return float(cell)
    return None
