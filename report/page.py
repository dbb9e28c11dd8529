"""The page: figures, tables, the answer and the clip in one file that opens offline."""

from __future__ import annotations

import base64
import os
import platform
import re
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from urllib.parse import quote

import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from data.files import whole_file, write_text
from data.results import Results
from data.sheet import House
from report.cells import data, data_pair, data_significant
from report.gallery import pictures
from report.listing import page_tables
from report.style import render

EMBED_LIMIT = 8_000_000
"""Largest overlay, bytes, that goes into the page; a larger one is linked."""

_LIBRARIES = ("numpy", "scipy", "pandas", "filterpy", "opencv-python-headless", "matplotlib")


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
            tables=page_tables(results, tracks, house),
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
