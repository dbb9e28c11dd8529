"""Text tables of numbers in any dialect: with or without a header, whatever the delimiter."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.headers import with_units
from curlshot.data.text import NUMBER, plain_decimals, plain_digits, quoted, read_text
from curlshot.data.units import KNOWN_UNITS, abbreviated

Array = NDArray[np.float64]

MOST_CELLS = 3_500_000
"""Read at once; as text they take some hundred bytes each."""

_PREFACE = 10
"""How many lines may stand above the header or the first row of numbers."""

_SPREADSHEET = re.compile('"?sep=.?"?', re.IGNORECASE)
"""What spreadsheets take for the delimiter of what follows, and no name of a track."""

_UNIT = re.compile(
    r"[(\[]?(m?s|sec|min(:sec)?|h|[cm]?m|in|ft|yd|px|kg|rad|deg|°|(m|rad|deg|°)/s[²2]?)?[)\]]?"
)
_CLOCK = re.compile(r"(?:(\d{1,9}):)?(\d{1,9}):([0-5]?\d(?:\.\d*)?)")
"""Hours, minutes and seconds."""

_MISSING = re.compile(r"nan|n/?a|null|none|n\.? ?[av]\.?|[-—]*|\?|\.{1,3}|…|#.*", re.IGNORECASE)
"""What stands for no number; of spreadsheets #N/A, #DIV/0! and what else begins so."""


@dataclass(frozen=True)
class TextTable:
    """The rows of a text table, not yet numbers.

    Attributes
    ----------
    path : Path
        The file it was read from.
    names : tuple of str or None
        Names of the columns as written, units in brackets; None where the file has no header.
    title : str
        The line above the header (in Tracker's exports: the names of the tracks), or "".
    delimiter : str
        What stands between two cells.
    width : int
        Number of columns.
    rows : tuple of str
        Lines of data, with ASCII digits, minus and exponents.
    line_numbers : tuple of int
        Their numbers in the file, from 1.
    warnings : tuple of str
        What was decided on evidence.
    """

    path: Path
    names: tuple[str, ...] | None
    title: str
    delimiter: str
    width: int
    rows: tuple[str, ...]
    line_numbers: tuple[int, ...]
    split: Callable[[str], list[str]]
    warnings: tuple[str, ...] = ()

    def cells(self, columns: Sequence[int]) -> list[list[str]]:
        """Cells of the given columns as written, one list per column.

        Raises
        ------
        InputError
            Where a row has more cells than there are columns, or there are too many.
        """
        if len(self.rows) * len(columns) > MOST_CELLS:
            raise InputError(
                f"{self.path}: {len(self.rows)} rows of {len(columns)} numbers are too many; split"
                " the table"
            )
        picked: list[list[str]] = [[] for _ in columns]
        for fields, line in self._split_rows():
            if len(fields) > self.width and any(cell.strip() for cell in fields[self.width :]):
                raise InputError(
                    f"{self.path}: line {line} has {len(fields)} cells, but there are"
                    f" {self.width} columns"
                )
            for cells, column in zip(picked, columns, strict=True):
                cells.append(fields[column].strip() if column < len(fields) else "")
        return picked

    def numbers(self, columns: Sequence[int], clock: int | None = None) -> Array:
        """Numbers of the given columns, shape (rows, columns); NaN where a cell is empty.

        In the column of times, `clock`, 1:02.5 is 62.5 s.

        Raises
        ------
        InputError
            Where a cell is no number, or the decimal sign is ambiguous.
        """
        picked = self.cells(columns)
        out = np.empty((len(self.rows), len(columns)))
        for k, cells in enumerate(plain_decimals(picked, str(self.path))):
            if columns[k] == clock and ":" in "".join(cells):
                cells = _in_seconds(cells, self.path)
            for row, cell in enumerate(cells):
                try:
                    # Python's float also takes 1_000, which nobody means.
                    out[row, k] = float(cell) if "_" not in cell else float("")
                except ValueError:
                    if not _MISSING.fullmatch(cell):
                        column = f" in column {self.names[columns[k]]}" if self.names else ""
                        raise InputError(
                            f"{self.path}: line {self.line_numbers[row]}: {quoted(cell)} is not a"
                            f" number{column}"
                        ) from None
                    out[row, k] = np.nan
        return out

    def refuse_cut(self, pairs: Iterable[tuple[int, int]]) -> None:
        """Refuse rows that end within a pair of columns of which both or none have a number.

        Empty cells at the end may be left off, as spreadsheets do; one that was left off before
        shifts those behind it.

        Raises
        ------
        InputError
            With the line of the first.
        """
        ordered = [(min(pair), max(pair)) for pair in pairs]
        for fields, line in self._split_rows():
            used = _cells_used(fields) if len(fields) < self.width else self.width
            if any(one < used <= two and fields[one].strip() for one, two in ordered):
                raise InputError(
                    f"{self.path}: line {line} has {used} cells, but there are {self.width}"
                    " columns; a missing cell cannot be placed, leave it empty"
                )

    def _split_rows(self) -> Iterator[tuple[list[str], int]]:
        for row, line in zip(self.rows, self.line_numbers, strict=True):
            yield self.split(row), line


def _in_seconds(cells: Sequence[str], path: Path) -> list[str]:
    """Write minutes and seconds with decimals, as 0:01.25 or 0:00:01.25, as seconds.

    Raises
    ------
    InputError
        Where seconds have no decimals: then 0:01:25 may end in seconds, hundredths or frames.
    """
    told = {cell: _CLOCK.fullmatch(cell) for cell in cells if ":" in cell}
    odd = [cell for cell, parts in told.items() if parts is None]
    if odd or not any("." in cell for cell in told):
        raise InputError(
            f"{path}: a time as {quoted((odd or [*told])[0])} may end in seconds, hundredths or"
            " frames; write seconds (1.25), or minutes and seconds with decimals (0:01.25)"
        )
    return [
        str(3600 * int(parts[1] or 0) + 60 * int(parts[2]) + float(parts[3]))
        if (parts := told.get(cell))
        else cell
        for cell in cells
    ]


def read_text_table(
    path: Path,
    is_header: Callable[[Sequence[str]], bool],
    sought: str = "tracks: no header with t, x and y",
) -> TextTable:
    """Read a file as a text table, whatever its dialect.

    Parameters
    ----------
    path : Path
        The file.
    is_header : callable
        Tells from the cells of a line whether it is the header.
    sought : str
        What a file that is no table was to hold, and the header that it lacks.

    Raises
    ------
    InputError
        Where the file is missing, empty, no text, or no table.
    """
    lines = [line for line in enumerate(read_text(path).split("\n"), 1) if line[1].strip()]
    if not lines:
        raise InputError(f"{path}: the file is empty")
    title = ""
    for k, (_, line) in enumerate(lines[:_PREFACE]):
        header = _header(line.lstrip("# "), is_header)
        if header is not None:
            below = _header(lines[k + 1][1], is_header) if k + 1 < len(lines) else None
            if below is not None and below[0] == header[0] and _is_unit(below[1][0]):
                return _below_stones(path, line, header, below[1], lines[k + 1 :])
            return _with_header(path, title, line, *header, lines[k + 1 :])
        if line.startswith("#") or _SPREADSHEET.fullmatch(line.strip()):
            continue
        if (delimiter := _delimiter_of_numbers(plain_digits(line))) is not None:
            return _without_header(path, title, delimiter, lines[k:])
        title = line
    raise InputError(
        f"{path}: not a table of {sought}, and no rows of numbers alone"
        f" (line {lines[0][0]}: {quoted(lines[0][1])})"
    )


def _header(
    line: str, is_header: Callable[[Sequence[str]], bool]
) -> tuple[str, tuple[str, ...]] | None:
    """Delimiter and names, if the line is a header in some dialect."""
    candidates = ["\t", ";", ","]
    # A delimiter of the user's own is whatever stands after the first name.
    own = re.match(r"\w+\s*([^\w\s\"'()\[\]{}°]+)\s*\w", line)
    if own:
        candidates.append(own.group(1))
    for delimiter in [*candidates, " "]:
        if delimiter in line:
            cells = line.split() if delimiter == " " else _splitter(delimiter, line)(line)
            names = with_units(cells)
            while names and not names[-1]:
                names.pop()
            if len(names) > 1 and is_header(names):
                return delimiter, tuple(names)
    return None


def _with_header(
    path: Path,
    title: str,
    header: str,
    delimiter: str,
    names: tuple[str, ...],
    lines: Sequence[tuple[int, str]],
) -> TextTable:
    rows, numbers = _data_rows(lines, delimiter)
    split = _splitter(delimiter, header + "".join(rows[:1]))
    width = len(names)
    units = [cell.strip() for cell in split(rows[0])] if rows else []
    if any(units) and all(not unit or _is_unit(unit) for unit in units):
        named = zip(names, units, strict=False)
        labels = (f"{name} ({unit.strip('()[]')})" for name, unit in named)
        names = (*labels, *names[len(units) :])
        rows, numbers = rows[1:], numbers[1:]
    warnings: tuple[str, ...] = ()
    if delimiter == " " and any(len(row.rstrip().split(" ")) > width for row in rows):
        split = _aligned(path, width)
    elif delimiter == "," and any(_cells_used(split(row)) > width for row in rows):
        split = _joined_decimals(path, names)
        warnings = (f"{path}: commas both between and in the numbers; read in pairs",)
    return TextTable(path, names, title, delimiter, width, rows, numbers, split, warnings)


def _below_stones(
    path: Path,
    stones: str,
    upper: tuple[str, tuple[str, ...]],
    lower: Sequence[str],
    lines: Sequence[tuple[int, str]],
) -> TextTable:
    """Read a table whose header is a row of stones, and of the time, above one of their axes."""
    delimiter, above = upper
    names = [
        f"{one} ({name.strip('()[]')})" if _is_unit(name) else name
        for one, name in zip(above, lower, strict=False)
    ]
    title = delimiter + stones.partition(delimiter)[2]
    header = (*names, *lower[len(names) :])
    return _with_header(path, title, lines[0][1], delimiter, header, lines[1:])


def _is_unit(cell: str) -> bool:
    return bool(_UNIT.fullmatch(cell)) or abbreviated(cell.strip("()[]")) in KNOWN_UNITS


def _without_header(
    path: Path, title: str, delimiter: str, lines: Sequence[tuple[int, str]]
) -> TextTable:
    rows, numbers = _data_rows(lines, delimiter)
    split = _splitter(delimiter, rows[0])
    width = _cells_used(split(rows[0]))
    if delimiter == " ":
        width = len(rows[0].split())
        split = _aligned(path, width)
    return TextTable(path, None, title, delimiter, width, rows, numbers, split)


def _data_rows(
    lines: Sequence[tuple[int, str]], delimiter: str
) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """Rows with anything in them, and their line numbers."""
    blank = delimiter + ' \t"'
    kept = [line for line in lines if line[1].strip(blank) and not line[1].startswith("#")]
    rows = plain_digits("\n".join(line for _, line in kept)).split("\n") if kept else []
    return tuple(rows), tuple(number for number, _ in kept)


def _delimiter_of_numbers(line: str) -> str | None:
    """Find the delimiter that makes all cells of a line numbers; None if there is none."""
    for delimiter in ("\t", ";", " ", ","):
        cells = line.split() if delimiter == " " else line.split(delimiter)
        cells = [cell.strip().strip('"') for cell in cells]
        while cells and not cells[-1]:
            cells.pop()
        if len(cells) > 1 and cells[0] and all(not c or NUMBER.fullmatch(c) for c in cells):
            return delimiter
    return "\t" if NUMBER.fullmatch(line.strip()) else None


def _splitter(delimiter: str, first_line: str) -> Callable[[str], list[str]]:
    """Split lines at the delimiter; quotes count only where the first line has some."""
    if '"' in first_line and len(delimiter) == 1:

        def quoted(line: str) -> list[str]:
            try:
                return next(csv.reader([line], delimiter=delimiter))
            except (csv.Error, StopIteration):
                return line.split(delimiter)

        return quoted
    return lambda line: line.split(delimiter)


def _aligned(path: Path, width: int) -> Callable[[str], list[str]]:
    """Split at runs of blanks; then every cell must be there, or they would shift."""

    def split(line: str) -> list[str]:
        cells = line.split()
        if len(cells) != width:
            raise InputError(
                f"{path}: a row has {len(cells)} numbers instead of {width}; between blanks a"
                " missing one cannot be placed"
            )
        return cells

    return split


def _joined_decimals(path: Path, names: tuple[str, ...]) -> Callable[[str], list[str]]:
    """Join the halves of numbers where the comma is delimiter and decimal sign alike.

    Tracker writes decimals for all but the counters, at least three for the time, so each
    number but the counters is two fields and each empty cell one.
    """
    counters = {k for k, name in enumerate(names) if name in ("step", "frame", "n")}

    def split(line: str) -> list[str]:
        fields = line.split(",")
        cells: list[str] = []
        clear = len(fields) > 1 and re.fullmatch(r"\d{3,}(E-?\d+)?", fields[1], re.I) is not None
        while fields:
            cell = fields.pop(0)
            if cell.strip() and len(cells) not in counters:
                clear = clear and bool(fields) and fields[0][:1].isdigit()
                cell += "," + fields.pop(0) if fields else ""
            cells.append(cell)
        if not clear or len(cells) != len(names):
            raise InputError(
                f"{path}: {quoted(line)} does not fit the header; if its commas stand between and"
                " in the numbers, export with another delimiter"
            )
        return cells

    return split


def _cells_used(cells: Sequence[str]) -> int:
    """Count the cells up to the last one that is not empty."""
    return max((k + 1 for k, cell in enumerate(cells) if cell.strip()), default=0)
