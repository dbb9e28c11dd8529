"""The table of tracks: one row per stone and frame, checked once at the boundary."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from curlshot.data.column_units import with_units
from curlshot.data.errors import InputError
from curlshot.data.files import whole_file
from curlshot.data.text import printable

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


class Table(Protocol):
    """Columns of one length by their names: a DataFrame, or a dict of arrays.

    What is done on the way from a clip to its tracks asks for no more, for to import pandas takes
    as long as to decode two seconds of a clip.
    """

    def __getitem__(self, name: str, /) -> Any:
        """Give a column."""

    def __iter__(self) -> Iterator[Any]:
        """Give the names of the columns."""

    def __contains__(self, name: object, /) -> bool:
        """Say whether there is a column of that name."""


Columns = dict[str, NDArray[Any]]
"""A table as arrays."""

TRACK_COLUMNS: tuple[str, ...] = (
    "stone", "frame", "t", "x", "y", "theta", "vx", "vy", "omega",
    "sd_x", "sd_y", "sd_theta", "sd_vx", "sd_vy", "sd_omega", "seen", "team",
)  # fmt: skip
"""Columns of ``tracks.csv``: m, s, rad; ``seen`` is 1 where the frame showed the stone.

``team`` is what the stones of one team share: for clips the colour of their caps (``#rrggbb``), for
tables what they say; empty where nothing is known.
"""

DETECTION_COLUMNS: tuple[str, ...] = (
    "stone", "frame", "t", "x", "y", "theta", "sd_x", "sd_y", "sd_theta",
    "sd_place_x", "sd_place_y", "rise_a", "rise_b", "team",
)  # fmt: skip
"""Columns of a table of detections: measured places, before any filter. sd may be NaN.

``sd_x`` and ``sd_y`` are of what differs from detection to detection, ``sd_place_x`` and
``sd_place_y`` (m) of what the detections of a stone share and no filter averages out: the camera,
the scale. ``rise_a`` and ``rise_b`` (rad) are what the angles of a stone are off by together, each
times one number of standard deviation 1 that all its detections share: by how much a handle rises
above the cap otherwise than was taken out.
"""

LENGTHS = ("x", "y", "sd_x", "sd_y", "sd_place_x", "sd_place_y")
"""Columns of detections that are in a unit of length."""

ANGLES = ("theta", "sd_theta", "rise_a", "rise_b")
"""Columns of detections that are in a unit of angle."""

MEASURED_AS = {f"meas_{name}": name for name in (*LENGTHS, *ANGLES)}
"""Columns of ``tracks.csv`` beside `TRACK_COLUMNS`, and what of a detection they hold: what was
measured of the stone in that frame, before any filter; empty where nothing was. What is estimated
from the table later rests on them."""

EARLIER_NAMES = {f"seen_{name}": f"meas_{name}" for name in (*LENGTHS, *ANGLES)}
"""Names that columns of ``tracks.csv`` had in version 0.1."""

_NUMBERS = tuple(name for name in DETECTION_COLUMNS if name not in ("stone", "team"))

AT_ONCE = 2000
"""Rows that are made texts together: of a long table these take more memory than its numbers."""

FARTHEST = 1e6
"""No time (s), place (m) or velocity (m/s) of a written track is as large."""

LATEST = 1e12
"""s; more is no time."""

_LAST_FRAME = 2**52
"""Beyond this a float no longer tells one frame from the next."""

STONE_NAMES: tuple[str, ...] = tuple("ABCDEFGHIJKLMNOPQRSTUVWXYZ")


def stone_name(index: int) -> str:
    """Name of the stone of rank `index`: A to Z, then A1, B1 and so on."""
    letter = STONE_NAMES[index % len(STONE_NAMES)]
    turn = index // len(STONE_NAMES)
    return letter if turn == 0 else f"{letter}{turn}"


def check_detections(table: pd.DataFrame, source: str = "tracks") -> pd.DataFrame:
    """Return the detections of `table`, sorted by stone and time, or say all that is wrong.

    Parameters
    ----------
    table : DataFrame
        At least ``stone, t, x, y``; `frame`, `theta`, the sd columns and `team` are filled in
        (NaN, the rank of the time for `frame`, "" for `team`) where they are missing. Rows whose x
        or y is missing are dropped: a missing sample is no detection.
    source : str
        What to call the table in messages.

    Returns
    -------
    DataFrame
        With exactly `DETECTION_COLUMNS`.

    Raises
    ------
    InputError
        One line that lists every fault found.
    """
    import pandas as pd

    missing = [name for name in ("stone", "t", "x", "y") if name not in table.columns]
    if missing:
        raise InputError(f"{source}: no column {', '.join(missing)}; needs stone, t, x, y")
    faults: list[str] = []
    numbers = {}
    for name in _NUMBERS:
        numbers[name], wrong = _as_numbers(table, name)
        if wrong.any():
            row = int(np.flatnonzero(wrong)[0])
            faults.append(f"column {name} is not a number in data row {row + 1}")
    faults += _nonsense(numbers)
    if table["stone"].isna().any():
        faults.append("a stone without a name")
    stones = table["stone"].astype(str).map(printable, na_action="ignore").to_numpy()
    teams = table["team"] if "team" in table.columns else pd.Series("", index=table.index)
    out = pd.DataFrame({"stone": stones, **numbers})
    out["team"] = teams.astype(object).fillna("").astype(str).str.strip().to_numpy()
    out = out[~(np.isnan(numbers["x"]) | np.isnan(numbers["y"]))]
    faults += _disorder(out["stone"].to_numpy(), out["t"].to_numpy())
    if out.empty:
        faults.append("no row with a place (x and y)")
    if faults:
        raise InputError(f"{source}: {'; '.join(faults)}")
    if out["frame"].isna().any():
        times = np.unique(out["t"].to_numpy())
        out["frame"] = np.searchsorted(times, out["t"].to_numpy())
    out["frame"] = out["frame"].astype(int)
    out = out.sort_values(["stone", "t"], kind="stable").reset_index(drop=True)
    return out[list(DETECTION_COLUMNS)]


def _as_numbers(table: pd.DataFrame, name: str) -> tuple[Array, NDArray[np.bool_]]:
    """Numbers of a column, NaN where it has none, and which cells are neither."""
    import pandas as pd

    none = np.zeros(len(table), bool)
    if name not in table.columns:
        return np.full(len(table), np.nan), none
    column = table[name]
    if pd.api.types.is_numeric_dtype(column):
        return column.to_numpy(float, na_value=np.nan), none
    values = pd.to_numeric(column, errors="coerce").to_numpy(float, na_value=np.nan)
    given = column.notna() & (column.astype(str).str.strip() != "")
    return values, np.isnan(values) & given.to_numpy(bool)


def _nonsense(numbers: Mapping[str, Array]) -> list[str]:
    """Say which numbers make no sense, whatever the stone."""
    faults: list[str] = []
    latest = float(np.abs(numbers["t"]).max(initial=0.0))
    if np.isnan(latest):
        faults.append("a time is missing")
    elif LATEST < latest < np.inf:
        faults.append(f"times up to {latest:.3g} s make no sense")
    infinite = [name for name, values in numbers.items() if np.isinf(values).any()]
    if infinite:
        faults.append(f"infinite numbers in column {', '.join(infinite)}")
    frames = numbers["frame"][~np.isnan(numbers["frame"])]
    if not infinite and ((frames % 1 != 0) | (np.abs(frames) > _LAST_FRAME)).any():
        faults.append("column frame holds numbers that are no frames")
    if any((numbers[name] < 0).any() for name in _NUMBERS if name.startswith("sd_")):
        faults.append("a standard deviation is negative")
    return faults


def _disorder(stones: NDArray[np.object_], t: Array) -> list[str]:
    """Say where the time of a stone goes back, or stands still."""
    faults: list[str] = []
    for stone in dict.fromkeys(stones.tolist()):
        own = t[stones == stone]
        with np.errstate(invalid="ignore", over="ignore"):
            steps = np.diff(own)
        back, still = np.flatnonzero(steps < 0), np.flatnonzero(steps == 0)
        if len(back):
            faults.append(
                f"stone {stone}: time goes back after t = {own[back[0]]:g} s"
                " (rows out of order, or two stones of one name?)"
            )
        elif len(still):
            faults.append(
                f"stone {stone}: two rows at t = {own[still[0]]:g} s"
                " (a row twice, or two stones of one name?)"
            )
    return faults


def teams(table: Table) -> dict[str, str]:
    """Team of each stone of a table, by its column ``team`` if it has one; "" where unknown."""
    found: dict[str, str] = {}
    told = table["team"] if "team" in table else [""] * len(table["stone"])
    for stone, team in zip(table["stone"], told, strict=True):
        found[str(stone)] = found.get(str(stone)) or team
    return found


def no_rows(columns: Sequence[str]) -> Columns:
    """Return a table of detections or tracks without rows."""
    kinds = {"stone": str, "team": str, "frame": int, "seen": int}
    return {name: np.empty(0, kinds.get(name, float)) for name in columns}


def empty_tracks() -> pd.DataFrame:
    """Return a table of tracks without rows."""
    import pandas as pd

    return pd.DataFrame(no_rows(TRACK_COLUMNS))


def write_table(table: Table, path: Path) -> None:
    """Write a table as CSV, whole or not at all, nine significant digits, NaN as empty."""
    names = list(table)
    values = [np.asarray(table[name]) for name in names]
    with whole_file(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        for begin in range(0, max(map(len, values), default=0), AT_ONCE):
            texts = [_texts(column[begin : begin + AT_ONCE]) for column in values]
            writer.writerows(zip(*texts, strict=True))


def _texts(column: NDArray[Any]) -> list[str]:
    """Values as they are written; `to_csv` takes ten times as long."""
    if column.dtype.kind == "f":
        return ["" if value != value else f"{value:.9g}" for value in column.tolist()]
    return ["" if value is None or value != value else str(value) for value in column.tolist()]


def write_tracks(tracks: Table, path: Path, detections: Table | None = None) -> None:
    """Write ``tracks.csv`` with `TRACK_COLUMNS` in their order.

    Of which `detections` they were made, if given, is written beside them (`MEASURED_AS`).
    """
    table = {name: tracks[name] for name in TRACK_COLUMNS}
    if detections is not None:
        table |= measured_columns(tracks, detections)
    write_table(table, path)


def measured_columns(tracks: Table, detections: Table) -> Columns:
    """Return the columns of `MEASURED_AS` for the rows of `tracks`; NaN where nothing was seen."""
    rank = {key: k for k, key in enumerate(zip(detections["stone"], detections["t"], strict=True))}
    rows = [rank.get(key, -1) for key in zip(tracks["stone"], tracks["t"], strict=True)]
    return {
        written: np.append(np.asarray(detections[name], float), np.nan)[rows]
        for written, name in MEASURED_AS.items()
    }


def with_measured(tracks: pd.DataFrame, detections: Table) -> pd.DataFrame:
    """Return tracks as ``tracks.csv`` has them: with what was measured, and units in ``attrs``."""
    return with_units(tracks.assign(**measured_columns(tracks, detections)))


def measured_rows(tracks: pd.DataFrame) -> pd.DataFrame:
    """Return the detections that `tracks` were made of, by their columns of `MEASURED_AS`.

    Raises
    ------
    InputError
        Where the tracks do not have them.
    """
    if "meas_x" not in tracks:
        raise InputError("tracks: no column meas_x; what was measured is not known")
    seen = tracks[tracks["meas_x"].notna() & tracks["meas_y"].notna()]
    own = seen[["stone", "frame", "t", "team"]]
    measured = {name: seen.get(written, np.nan) for written, name in MEASURED_AS.items()}
    return own.assign(**measured)[list(DETECTION_COLUMNS)].reset_index(drop=True)


def read_tracks(path: Path) -> pd.DataFrame:
    """Read a ``tracks.csv`` as `write_tracks` wrote it, for a shot to throw again.

    Raises
    ------
    InputError
        Where the file is missing or no such thing, or has no motion.
    """
    table = load_tracks(path)[list(TRACK_COLUMNS)]
    if table.empty:
        raise InputError(f"{path}: a table without any row")
    if table[["vx", "vy"]].isna().all(axis=None):
        raise InputError(
            f"{path}: places without velocities, as from one frame: no shot to reconstruct"
        )
    states = table[["t", "x", "y", "vx", "vy"]].to_numpy()
    if not (np.abs(states) < FARTHEST).all():  # NaN is refused too
        raise InputError(f"{path}: times, places or velocities are not numbers")
    return table


def load_tracks(path: Path, model: bool = False) -> pd.DataFrame:
    """Read a table of tracks that a run wrote, or version 0.1 of the program.

    Parameters
    ----------
    path : Path
        ``tracks.csv``; ``simulation.csv`` with `model`.
    model : bool
        Whether a column ``model`` comes first.

    Returns
    -------
    DataFrame
        `TRACK_COLUMNS`, and of ``tracks.csv`` what there is of `MEASURED_AS`.

    Raises
    ------
    InputError
        Where the file is missing or no such thing.
    """
    import pandas as pd

    texts = {"stone": str, "team": str, "model": str}
    numbers = {name: float for name in TRACK_COLUMNS if name not in (*texts, "frame", "seen")}
    columns = ["model", *TRACK_COLUMNS] if model else [*TRACK_COLUMNS]
    try:
        table = pd.read_csv(path, dtype={**texts, **numbers}).rename(columns=EARLIER_NAMES)
        table = table.assign(team=table.get("team", "")).fillna({"team": ""})
        return table[[*columns, *(name for name in MEASURED_AS if name in table)]]
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (ValueError, KeyError):  # pandas' own mistakes are ValueErrors
        raise InputError(f"{path}: not a {path.name} of this program") from None


def read_numbers(path: Path, columns: Sequence[str]) -> pd.DataFrame:
    """Read a table of numbers that a run wrote, empty cells as NaN.

    Parameters
    ----------
    path : Path
        ``camera.csv`` or ``posterior.csv``.
    columns : sequence of str
        Columns that must be there.

    Raises
    ------
    InputError
        Where the file is no such thing.
    """
    import pandas as pd

    try:
        table = pd.read_csv(path)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except ValueError:  # pandas' own mistakes are ValueErrors
        raise InputError(f"{path}: not a {path.name} of this program") from None
    missing = [name for name in columns if name not in table]
    if missing:
        raise InputError(f"{path}: no column {', '.join(missing)}; not a {path.name}")
    for name in table:
        if not pd.api.types.is_numeric_dtype(table[name]):
            raise InputError(f"{path}: column {name} is not all numbers")
    return table


def simulation_table(
    simulated: pd.DataFrame | None, model: str, of_team: Mapping[str, str] | None = None
) -> pd.DataFrame:
    """Return the table of ``simulation.csv`` from a sampled simulation; none of it was seen."""
    table = empty_tracks() if simulated is None else simulated.reindex(columns=list(TRACK_COLUMNS))
    table["seen"] = 0
    table["team"] = [(of_team or {}).get(str(name), "") for name in table["stone"]]
    table.insert(0, "model", model)
    return table
