"""The page: figures, tables, the answer and the clip in one file that opens offline."""

from __future__ import annotations

import base64
import os
import platform
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure

from data.files import whole_file, write_text
from data.results import Results
from data.sheet import House
from report import figures, tables
from report.numbers import DASH, fixed, parts, significant
from report.style import render

EMBED_LIMIT = 8_000_000
"""Largest overlay, bytes, that goes into the page; a larger one is linked."""

_LIBRARIES = ("numpy", "scipy", "pandas", "filterpy", "opencv-python-headless", "matplotlib")


@dataclass(frozen=True)
class Picture:
    """One figure of the report: its file's name, what it shows, and how to draw it."""

    name: str
    caption: str
    alt: str
    draw: Callable[[], Figure]


@dataclass(frozen=True)
class Column:
    """One column of a table in the page: head, unit, and how a row's cell is written.

    `kind` is number, word or note: how the page sets it.
    """

    head: str
    cell: Callable[[Mapping[str, object]], str]
    unit: str = ""
    kind: str = "number"


@dataclass(frozen=True)
class Table:
    """One table of the page: heads and cells, ready to print."""

    title: str
    note: str
    head: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]


def write_report(
    folder: Path,
    *,
    results: Results,
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
    cameras: pd.DataFrame | None = None,
    clip_name: str | None = None,
    overlay: Path | None = None,
    house: House | None = None,
    version: str = "",
) -> Path:
    """Write ``report.html`` and ``figures/`` into `folder`.

    Parameters
    ----------
    folder : Path
        Made if need be.
    results : Results
        What the run found out.
    tracks : DataFrame
        With `data.tracks.TRACK_COLUMNS`.
    simulations : mapping of str to DataFrame
        Sampled simulation of each model: ``stone, frame, t, x, y, theta, vx, vy, omega``.
    cameras : DataFrame, optional
        With `vision.camera.CAMERA_COLUMNS`, for how good the calibration is; None for tracks
        that came in metres.
    clip_name : str, optional
        What the page is called; the first input file's name if not given.
    overlay : Path, optional
        The annotated clip; up to `EMBED_LIMIT` bytes it goes into the page.
    house : House, optional
        Rings for the plan view; None where the scene has no house.
    version : str
        Of this program.

    Returns
    -------
    Path
        The page.
    """
    shown = []
    wanted = list(pictures(results, tracks, simulations, house))
    for picture in wanted:
        svg, png = render(picture.draw())
        for suffix, content in ((".svg", svg), (".png", png)):
            with whole_file(folder / "figures" / f"{picture.name}{suffix}") as part:
                part.write_bytes(content)
        shown.append((picture, _smaller(svg, png)))
    _remove_stale(folder / "figures", {picture.name for picture in wanted})
    files = [Path(name).name for name in results.input.files]
    page = (
        _environment()
        .get_template("page.html")
        .render(
            beside=2 if len(shown) > 1 and shown[1][0].name == "speed" else 1,
            title=clip_name or (files[0] if files else "shot"),
            results=results,
            pictures=shown,
            overlay=None if overlay is None or not overlay.is_file() else _video(overlay, folder),
            tables=page_tables(results, tracks, simulations),
            scores=[_score(name, results) for name in results.simulations],
            calibration=_calibration(cameras),
            why_no_e=_reason(results, r"\be\b|restitution|hit|collision"),
            why_no_mu=_reason(results, r"μ|friction|glide"),
            cautions=_cautions(results),
            version=version,
            libraries=_libraries(),
        )
    )
    path = folder / "report.html"
    write_text(path, page)
    return path


def pictures(
    results: Results,
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
    house: House | None,
) -> Iterator[Picture]:
    """Give the figures of a shot in the order of the page, the plan view first."""
    collisions, radius = results.collisions, results.radius
    moved = tables.moving_stones(tracks, collisions, radius)
    yield Picture(
        "plan",
        "Plan view: "
        + ("measured paths (solid)" if moved else "nothing moved")
        + (" and simulated ones (broken)" if len(simulations) else "")
        + ("; crosses where stones touched" if collisions else "")
        + ". Each stone where it was last seen, to scale.",
        f"Plan view of the sheet with {tracks['stone'].nunique()} stones, of which {len(moved)}"
        f" moved, and {len(collisions)} hits.",
        lambda: figures.plan_figure(tracks, simulations, collisions, house=house, radius=radius),
    )
    if moved:
        yield Picture(
            "speed",
            "Speed of each stone that moved, with two standard deviations either side. Numbered"
            " lines are the hits.",
            "Speed against time of stones " + ", ".join(moved) + ".",
            lambda: figures.speed_figure(tracks, collisions, radius),
        )
    used: set[str] = set()
    for stone in moved:
        name = _file_name(stone, used)
        yield Picture(
            f"motion_{name}",
            f"Stone {stone}: place and angle against time, two standard deviations either side,"
            " dotted where no frame showed it; straight pieces and numbers are the velocities"
            " just before and after each hit.",
            f"x, y and angle of stone {stone} against time.",
            lambda stone=stone: figures.motion_figure(tracks, stone, collisions),  # type: ignore[misc]
        )
        if any((table["stone"] == stone).any() for table in simulations.values()):
            yield Picture(
                f"simulated_{name}",
                f"Stone {stone}: the simulated motion of each model against the measured one.",
                f"Simulated and measured x and y of stone {stone} against time.",
                lambda stone=stone: figures.comparison_figure(  # type: ignore[misc]
                    tracks, simulations, stone, collisions
                ),
            )
    for rank, collision in enumerate(collisions, 1):
        first, second = collision.stones
        yield Picture(
            f"hit_{rank}",
            f"Hit {rank}, {first} on {second}: velocities before and after it in its normal (n)"
            " and tangential (t) axes.",
            f"Stones {first} and {second} touching, with arrows for their velocities.",
            lambda rank=rank, hit=collision: figures.hit_figure(hit, rank, radius),  # type: ignore[misc]
        )


# ---------------------------------------------------------------------------- tables


def page_tables(
    results: Results, tracks: pd.DataFrame, simulations: Mapping[str, pd.DataFrame]
) -> list[Table]:
    """Give the page's tables in their order; those without a row are left out."""
    collisions, radius = results.collisions, results.radius
    stones = [
        _text("stone"),
        _number("from", "t0", 2, "s"),
        _number("to", "t1", 2, "s"),
        _number("frames", "frames", 0),
        _number("seen", "seen", 0, "%", 100),
        _place("first at x, y", "x0", "y0"),
        _place("last at x, y", "x1", "y1"),
        _number("way", "path", 3, "m"),
        _number("top speed", "top_speed", 3, "m/s"),
        _number("turned", "turned", 2, "rad"),
        _millimetres("sd", "sd"),
    ]
    hits = [
        _text("hit"),
        _pair("time", "t", "stderr_t", "s"),
        Column("stones", lambda row: f"{row['first']} on {row['second']}", kind="word"),
        _number(Markup("n<sub>x</sub>"), "nx", 3),
        _number(Markup("n<sub>y</sub>"), "ny", 3),
        _pair("e", "restitution", "stderr"),
        _pair("momentum missing", "momentum_residual", "stderr_momentum"),
        _number("energy lost", "energy_lost", 0, "%", 100),
        _pair("stone on stone friction", "stone_friction", "stderr_stone_friction"),
        _text("note"),
    ]
    states = [
        _text("hit"),
        _text("stone"),
        _text("when", ""),
        *(_number(name, name, 3, "m") for name in ("x", "y")),
        _number(Markup("v<sub>x</sub>"), "vx", 4, "m/s"),
        _number(Markup("v<sub>y</sub>"), "vy", 4, "m/s"),
        _number("ω", "omega", 4, "rad/s"),
    ]
    glides = [
        _text("stone"),
        _number("from", "t0", 2, "s"),
        _number("to", "t1", 2, "s"),
        _pair("μ", "friction", "stderr"),
    ]
    scores = tables.score_table(results.simulations)
    last_places = [
        _millimetres(f"last place of {name}", str(name))
        for name in scores.columns
        if name not in ("model", "rmse", "note")
    ]
    made = [
        _table("Stones", "", tables.stone_table(tracks), stones),
        _table(
            "Hits",
            "The normal n points from the first stone to the second. Momentum missing is"
            " |Σv′ − Σv| / |Σv|, zero for a perfect measurement.",
            tables.hit_table(collisions),
            hits,
        ),
        _table(
            "Measured before and after each hit",
            "Places and velocities of the centres at the instant of contact, from fits to either"
            " side of it.",
            tables.measured_table(collisions),
            states,
        ),
        *(
            _table(
                f"Simulated before and after each hit: {model}",
                "At the samples on either side of the hit; — where the simulation has no such hit.",
                tables.simulated_table(table, collisions, radius),
                states,
            )
            for model, table in simulations.items()
        ),
        _table(
            "Glides", "Friction of each free glide.", tables.glide_table(results.glides), glides
        ),
        _table(
            "Simulated against measured",
            "Root mean square distance over all stones and times after the first hit, and the"
            " distance of the last places.",
            scores,
            [_text("model"), _millimetres("rms", "rmse"), *last_places, _text("note")],
        ),
    ]
    return [table for table in made if table.rows]


def _table(title: str, note: str, frame: pd.DataFrame, columns: Sequence[Column]) -> Table:
    records = frame.to_dict("records")
    cells = tuple(
        tuple(c.cell({str(k): v for k, v in r.items()}) for c in columns) for r in records
    )
    # A column of notes that has none to say would only take room.
    kept = [k for k, c in enumerate(columns) if c.kind != "note" or any(row[k] for row in cells)]
    return Table(
        title,
        note,
        tuple(columns[k] for k in kept),
        tuple(tuple(row[k] for k in kept) for row in cells),
    )


def _text(key: str, head: str | None = None) -> Column:
    def cell(row: Mapping[str, object]) -> str:
        value = row[key]
        return "" if value is None or value != value else str(value)

    return Column(key if head is None else head, cell, kind="note" if key == "note" else "word")


def _number(head: str, key: str, decimals: int, unit: str = "", factor: float = 1.0) -> Column:
    return Column(head, lambda row: data(_value(row[key]), decimals, factor), unit)


def _millimetres(head: str, key: str) -> Column:
    return Column(head, lambda row: data_significant(_value(row[key]), 3, 1000), "mm")


def _pair(head: str, key: str, stderr: str, unit: str = "") -> Column:
    return Column(head, lambda row: data_pair(_value(row[key]), _value(row[stderr])), unit)


def _place(head: str, x: str, y: str) -> Column:
    def cell(row: Mapping[str, object]) -> str:
        return Markup("{}, {}").format(data(_value(row[x])), data(_value(row[y])))

    return Column(head, cell, "m")


def _value(cell: object) -> float | None:
    if isinstance(cell, (int, float, np.integer, np.floating)) and np.isfinite(cell):
        return float(cell)
    return None


# ---------------------------------------------------------------------------- numbers


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


def data_pair(value: float | None, stderr: float | None) -> Markup:
    """Write "value ± standard error", rounded together, with all digits kept for machines."""
    first, second = parts(value, stderr)
    if value is None:
        return Markup(DASH)
    text = _element(value, first)
    if second is None or stderr is None:
        return text
    return Markup('<span class="pm">{} ± {}</span>').format(text, _element(stderr, second))


def _element(value: float, text: str) -> Markup:
    exact = int(value) if float(value).is_integer() and abs(value) < 1e15 else float(value)
    return Markup('<data value="{}">{}</data>').format(repr(exact), text)


# ---------------------------------------------------------------------------- the rest


def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = data
    environment.filters["significant"] = data_significant
    environment.globals["pair"] = data_pair
    return environment


def _smaller(svg: bytes, png: bytes) -> str:
    kind, content = min((("svg+xml", svg), ("png", png)), key=lambda item: len(item[1]))
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"


def _video(path: Path, folder: Path) -> str:
    if path.stat().st_size <= EMBED_LIMIT:
        return "data:video/mp4;base64," + base64.b64encode(path.read_bytes()).decode()
    return quote(Path(os.path.relpath(path, folder)).as_posix())


def _file_name(stone: str, used: set[str]) -> str:
    """Return a file name for a stone of any name, unlike those already given."""
    base = name = re.sub(r"[^\w-]+", "_", stone)[:40] or "stone"
    count = 2
    while name.lower() in used:
        name, count = f"{base}-{count}", count + 1
    used.add(name.lower())
    return name


def _remove_stale(folder: Path, names: set[str]) -> None:
    """Remove figures that an earlier run left and this one does not have."""
    for pattern in ("speed", "motion_*", "simulated_*", "hit_*"):
        for suffix in (".svg", ".png"):
            for path in folder.glob(pattern + suffix):
                if path.stem not in names:
                    path.unlink()


def _score(model: str, results: Results) -> dict[str, object]:
    score = results.simulations[model]
    return {"model": model, "rmse": score.rmse, "note": score.note}


def _calibration(cameras: pd.DataFrame | None) -> dict[str, float | None] | None:
    if cameras is None or cameras.empty:
        return None
    residuals = cameras["rms_px"].dropna()
    return {
        "frames": len(cameras),
        "found": int(cameras["found"].sum()),
        "rms": float(residuals.median()) if len(residuals) else None,
    }


def _reason(results: Results, words: str) -> str:
    """Return the first warning or note that speaks of it: why a value is missing."""
    notes = [c.note for c in results.collisions if c.note]
    for text in (*results.warnings, *notes):
        if re.search(words, text, re.IGNORECASE):
            return text
    return "the input cannot tell"


def _cautions(results: Results) -> list[str]:
    notes = [
        f"hit {rank} ({c.stones[0]} on {c.stones[1]}): {c.note}"
        for rank, c in enumerate(results.collisions, 1)
        if c.note
    ]
    models = [f"{name}: {score.note}" for name, score in results.simulations.items() if score.note]
    return list(dict.fromkeys([*results.warnings, *notes, *models]))


def _libraries() -> dict[str, str]:
    found = {"Python": platform.python_version()}
    for name in _LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found
