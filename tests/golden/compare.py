"""Compare two folders of golden outputs, made before and after a change on one machine.

    python tests/golden/compare.py BEFORE AFTER [--words] [--only NAME ...]

Numbers agree to 1e-6 of their size or to 1e-9. Texts agree exactly. With ``--words`` the texts
that people read (warnings, notes, what a command prints) may differ and are listed. The exit code
is 1 where anything else differs.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

RENAMED: Mapping[str, Mapping[str, str]] = {
    "tracks.csv": {
        f"seen_{name}": f"meas_{name}"
        for name in (
            "x",
            "y",
            "theta",
            "sd_x",
            "sd_y",
            "sd_theta",
            "sd_place_x",
            "sd_place_y",
            "rise_a",
            "rise_b",
        )
    },
    "simulation.csv": {},
    "results.json": {
        "laws": "joint_estimate",
        "law_choice": "model_selection",
        "misfits": "residuals",
        "sheet": "origin_at_tee",
        "global": "shot_fit",
        "turn": "turn_rate",
        "stderr_turn": "stderr_turn_rate",
        "error_after": "error_at_comparison",
        "sd_after": "sd_at_comparison",
        "certain": "significant",
        "left_out": "downweighted",
        "size": "rms_ratio",
    },
    "whatif.json": {},
    "season.json": {},
    "shots.csv": {},
    "hits.csv": {},
    "outcomes.csv": {},
}
"""New names of columns and keys by their old ones, for each file."""

IGNORED = frozenset({"schema", "version", "created", "date", "files"})
"""Keys and columns whose texts are of the program or of the run itself."""

WORDS = frozenset({"warnings", "note", "notes", "note_stone_friction", "error"})
"""Keys and columns that hold sentences."""

RELATIVE, ABSOLUTE = 1e-6, 1e-9
MOST_SHOWN = 30
"""Differences of a file that are listed one by one."""


@dataclass(frozen=True)
class Difference:
    """One place where two outputs differ; `words` where only people read it."""

    place: str
    before: object
    after: object
    words: bool = False

    def __str__(self) -> str:
        text = f"{self.place}: {_short(self.before)} -> {_short(self.after)}"
        if isinstance(self.before, float) and isinstance(self.after, float):
            off = self.after - self.before
            size = abs(self.before)
            text += f" (by {off:.3g}" + (f", {abs(off) / size:.2g} of it)" if size else ")")
        return text


def renamed(name: str, old: str) -> str:
    """Return the new name of a column or key of a file, be the one given old or new."""
    return RENAMED.get(name, {}).get(old, old)


def flat(
    value: Any, name: str, place: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the leaves of a JSON value and their keys; empty lists and objects are leaves."""
    if isinstance(value, dict) and value:
        for key, item in value.items():
            yield from flat(item, name, (*place, renamed(name, key)))
    elif isinstance(value, list) and value:
        for index, item in enumerate(value):
            yield from flat(item, name, (*place, str(index)))
    else:
        yield place, value


def same(before: Any, after: Any) -> bool:
    """Return whether two leaves agree."""
    numbers = (int, float)
    if isinstance(before, bool) or isinstance(after, bool):
        return before is after
    if isinstance(before, numbers) and isinstance(after, numbers):
        if math.isnan(before) or math.isnan(after):
            return math.isnan(before) and math.isnan(after)
        return math.isclose(before, after, rel_tol=RELATIVE, abs_tol=ABSOLUTE)
    return bool(before == after)


def compare_json(name: str, before: str, after: str) -> Iterator[Difference]:
    """Yield the differences of two JSON texts."""
    old, new = (dict(flat(json.loads(text), name)) for text in (before, after))
    for place in sorted({*old, *new}):
        if IGNORED.intersection(place):
            continue
        left, right = old.get(place, "absent"), new.get(place, "absent")
        if not same(left, right):
            words = bool(WORDS.intersection(place))
            yield Difference(".".join(place), left, right, words)


def compare_csv(name: str, before: Path, after: Path) -> Iterator[Difference]:
    """Yield the differences of two tables, one for each column."""
    old, new = (_read(path, name) for path in (before, after))
    if len(old) != len(new):
        yield Difference("rows", len(old), len(new))
        return
    for column in dict.fromkeys([*old, *new]):
        if column in IGNORED:
            continue
        if column not in old or column not in new:
            here, there = (column in table for table in (old, new))
            yield Difference(f"column {column}", here, there)
            continue
        differing = np.flatnonzero(~_agree(old[column], new[column]))
        if len(differing):
            left, right = (pd.to_numeric(t[column], errors="coerce") for t in (old, new))
            off = (left - right).abs().fillna(np.inf).to_numpy()[differing]
            worst = int(differing[off.argmax()])
            place = f"column {column}, {len(differing)} of {len(old)} rows, worst row {worst}"
            before_it, after_it = (_cell(table[column].iloc[worst]) for table in (old, new))
            yield Difference(place, before_it, after_it, column in WORDS)


def _read(path: Path, name: str) -> pd.DataFrame:
    try:
        table = pd.read_csv(path, dtype=str, keep_default_na=False)
    except pd.errors.EmptyDataError:
        table = pd.DataFrame()
    return table.rename(columns=lambda column: renamed(name, column))


def _agree(before: pd.Series[str], after: pd.Series[str]) -> NDArray[np.bool_]:
    """Return where the cells of two columns agree, as numbers where both are numbers."""
    left, right = (
        pd.to_numeric(column, errors="coerce").to_numpy(float) for column in (before, after)
    )
    close = np.isclose(left, right, rtol=RELATIVE, atol=ABSOLUTE)
    return np.asarray(close | (before.to_numpy(object) == after.to_numpy(object)))


def _cell(text: str) -> object:
    try:
        return float(text)
    except ValueError:
        return text


def _short(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.9g}"
    text = repr(value)
    return text if len(text) <= 160 else f"{text[:157]}..."


def compare_case(before: Path, after: Path) -> Iterator[tuple[str, Difference]]:
    """Yield the differences of a case, each with the name of its file."""
    names = sorted({path.name for folder in (before, after) for path in folder.glob("*")})
    for name in names:
        old, new = before / name, after / name
        if not (old.exists() and new.exists()):
            yield name, Difference("file", old.exists(), new.exists())
        elif name.endswith(".csv"):
            yield from ((name, difference) for difference in compare_csv(name, old, new))
        else:
            left, right = (path.read_text(encoding="utf-8") for path in (old, new))
            if name.endswith(".json"):
                yield from ((name, difference) for difference in compare_json(name, left, right))
            else:
                lines = zip_lines(left, right)
                yield from ((name, Difference(*line, words=True)) for line in lines)


def zip_lines(before: str, after: str) -> Iterator[tuple[str, str, str]]:
    """Yield the lines of two texts that differ, with their number."""
    old, new = before.splitlines(), after.splitlines()
    for number in range(max(len(old), len(new))):
        left, right = ("".join(lines[number : number + 1]) for lines in (old, new))
        if left != right:
            yield f"line {number + 1}", left, right


def main() -> int:
    """Compare two folders; returns 1 where they differ."""
    parser = argparse.ArgumentParser(description="Compare golden outputs.")
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--words", action="store_true", help="sentences may differ")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="cases to compare")
    given = parser.parse_args()
    names = given.only or sorted(
        {path.name for folder in (given.before, given.after) for path in folder.glob("*/")}
    )
    failed, reworded = [], []
    for name in names:
        found = list(compare_case(given.before / name, given.after / name))
        counted = [item for item in found if not (item[1].words and given.words)]
        if counted:
            failed.append(name)
        elif found:
            reworded.append(name)
        for file, difference in found[:MOST_SHOWN]:
            mark = "words" if difference.words else "DIFFERS"
            print(f"{mark:8}{name}/{file} {difference}")
        if len(found) > MOST_SHOWN:
            print(f"        {name}: {len(found) - MOST_SHOWN} more")
    print(f"{len(names)} cases: {len(failed)} differ, {len(reworded)} in words alone")
    if failed:
        print(f"differ: {' '.join(failed)}")
    return int(bool(failed) or not names)


if __name__ == "__main__":
    sys.exit(main())
