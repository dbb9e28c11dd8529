"""The page: the answer, the shot to play, what if, figures and tables, offline in one file."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from markupsafe import Markup

from curlshot.data.coach_units import METRES, Unit
from curlshot.data.errors import InputError
from curlshot.data.files import whole_file, write_text
from curlshot.data.results import Results
from curlshot.data.sheet import House
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.report.gallery import pictures
from curlshot.report.listing import page_tables
from curlshot.report.numbers import count
from curlshot.report.playback import playback
from curlshot.report.provenance import UNKNOWN, Provenance, libraries
from curlshot.report.style import render, stone_colours
from curlshot.report.tables import moving_stones
from curlshot.report.template import environment, link, source
from curlshot.report.trial import sliders, trial
from curlshot.report.typeset import write_tables

SCRIPTS = ("motion.js", "simulate.js", "plan.js", "player.js", "whatif.js")
"""In the order in which the page needs them."""

FIGURES = (
    "plan", "speed", "friction", "posterior", "residuals", "hit_*", "motion_*", "spin_*",
    "simulated_*",
)  # fmt: skip
"""Names that figures of an earlier run may have."""


def write_report(
    folder: Path,
    *,
    results: Results,
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
    cameras: pd.DataFrame | None = None,
    clip_name: str | None = None,
    overlay: Path | None = None,
    clip_start: float = 0.0,
    house: House | None = None,
    residuals: pd.DataFrame | None = None,
    posterior: pd.DataFrame | None = None,
    ensemble: Ensemble | None = None,
    unit: Unit = METRES,
    provenance: Provenance = UNKNOWN,
) -> Path:
    """Write ``report.html``, ``figures/`` and ``tables/`` into `folder`.

    Parameters
    ----------
    folder : Path
        Made if need be.
    results : Results
        What the run found out.
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`.
    simulations : mapping of str to DataFrame
        Sampled simulation of each model: ``stone, frame, t, x, y, theta, vx, vy, omega``.
    cameras : DataFrame, optional
        With `curlshot.vision.optics.camera.CAMERA_COLUMNS`, for how good the calibration is; None
        for tracks that came in metres.
    clip_name : str, optional
        What the page is called; the first input file's name if not given.
    overlay : Path, optional
        The annotated clip, which the page plays from where it lies.
    clip_start : float
        Time of the annotated clip's first picture, s.
    house : House, optional
        Rings for the plan view; None where the scene has no house.
    residuals : DataFrame, optional
        Of the places that were seen, for the figure of them (see
        `curlshot.report.gallery.pictures`).
    posterior : DataFrame, optional
        Samples of restitution and frictions, for the figure of them.
    ensemble : Ensemble, optional
        What the shot may have been, to throw it again on the page.
    unit : Unit
        Of the tables for coaches.
    provenance : Provenance
        What the report was made from.

    Returns
    -------
    Path
        The page.
    """
    shown = []
    wanted = list(pictures(results, tracks, simulations, house, residuals, posterior))
    for picture in wanted:
        svg, png = render(picture.draw())
        for suffix, content in ((".svg", svg), (".png", png)):
            with whole_file(folder / "figures" / f"{picture.name}{suffix}") as part:
                part.write_bytes(content)
        shown.append((picture, _smaller(svg, png)))
    _remove_stale(folder / "figures", {picture.name for picture in wanted})
    tables = page_tables(results, tracks, house, unit)
    write_tables(folder / "tables", tables)
    scores = [(name, score.rmse) for name, score in results.simulations.items()]
    known = [(rmse, name) for name, rmse in scores if rmse is not None]
    what_if = _what_if(tracks, results, ensemble)
    page = (
        environment()
        .get_template("page.html")
        .render(
            title=clip_name or next((Path(name).name for name in results.input.files), "shot"),
            lead=_lead(results, tracks),
            results=results,
            provenance=provenance,
            best=min(known, default=None),
            scores=scores,
            models=[name for name, _ in scores if name in simulations],
            calibration=_calibration(cameras),
            place_sd=_place_sd(tracks),
            why_no_e=_reason(results, r"\be\b|restitution|hit|collision"),
            why_no_mu=_reason(results, r"μ|friction|glide"),
            why_no_simulation=_reason(results, "simulat"),
            cautions=_cautions(results),
            clip=None if overlay is None else link(overlay, folder),
            clip_file="" if overlay is None else overlay.name,
            moving=_moving(tracks, results),
            rings=house is not None,
            what_if=what_if,
            sliders=[] if what_if is None else sliders(what_if),
            pictures=shown,
            tables=tables,
            libraries=libraries(),
            css=source("page.css"),
            scripts=[source(name) for name in SCRIPTS],
            shot_data=_json(
                {
                    **playback(results, tracks, simulations, house),
                    "clip_start": clip_start,
                    "what_if": what_if,
                }
            ),
        )
    )
    path = folder / "report.html"
    write_text(path, page)
    return path


def _json(values: Any) -> Markup:
    """Return JSON that is safe inside a script element, whatever names it holds."""
    text = json.dumps(values, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for sign in "<>&\u2028\u2029":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return Markup(text)


def _what_if(
    tracks: pd.DataFrame, results: Results, ensemble: Ensemble | None
) -> dict[str, Any] | None:
    """Return the shot to throw again; None where no stone moves."""
    if ensemble is None:
        return None
    try:
        return trial(tracks, results, ensemble)
    except InputError:
        return None


def _smaller(svg: bytes, png: bytes) -> str:
    kind, content = min((("svg+xml", svg), ("png", png)), key=lambda item: len(item[1]))
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"


def _remove_stale(folder: Path, names: set[str]) -> None:
    """Remove figures that an earlier run left and this one does not have."""
    for pattern in FIGURES:
        for suffix in (".svg", ".png"):
            for path in folder.glob(pattern + suffix):
                if path.stem not in names:
                    path.unlink()


# ---------------------------------------------------------------------------- the answer


def _lead(results: Results, tracks: pd.DataFrame) -> str:
    """Say in a sentence what was seen."""
    moved = moving_stones(tracks, results.collisions, results.radius)
    stones = count(tracks["stone"].nunique(), "stone")
    which = "none of which moved" if not moved else f"of which {_listed(moved)} moved"
    return f"{stones}, {which}, over {results.input.duration:.1f} s."


def _listed(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _moving(tracks: pd.DataFrame, results: Results) -> list[dict[str, Any]]:
    """Stones whose speed is worth reading, with their rank among all and their colour."""
    colours = stone_colours(tracks["stone"].unique())
    ranks = {name: rank for rank, name in enumerate(sorted(colours))}
    return [
        {"name": name, "rank": ranks[name], "colour": colours[name]}
        for name in moving_stones(tracks, results.collisions, results.radius)
    ]


def _calibration(cameras: pd.DataFrame | None) -> dict[str, float | None] | None:
    if cameras is None or cameras.empty:
        return None
    residuals = cameras["rms_px"].dropna()
    return {
        "frames": len(cameras),
        "found": int(cameras["found"].sum()),
        "rms": float(residuals.median()) if len(residuals) else None,
    }


def _place_sd(tracks: pd.DataFrame) -> float | None:
    """Median standard error of a place where it was seen, per axis, m."""
    seen = tracks.loc[tracks["seen"] == 1, ["sd_x", "sd_y"]].to_numpy(float)
    sd = np.sqrt((seen**2).mean(axis=1))
    sd = sd[np.isfinite(sd)]
    return float(np.median(sd)) if len(sd) else None


def _reason(results: Results, words: str) -> str:
    """Return the first warning or note that speaks of it: why a value is missing."""
    notes = [c.note for c in results.collisions if c.note]
    for text in (*results.warnings, *notes):
        if re.search(words, text, re.IGNORECASE):
            return text
    return "not identifiable from this input"


def _cautions(results: Results) -> list[str]:
    notes = [
        f"hit {rank} ({c.stones[0]} on {c.stones[1]}): {c.note}"
        for rank, c in enumerate(results.collisions, 1)
        if c.note and not any(text.endswith(c.note) for text in results.warnings)
    ]
    models = [f"{name}: {score.note}" for name, score in results.simulations.items() if score.note]
    return list(dict.fromkeys([*results.warnings, *notes, *models]))
