"""Which figures a report shows, in which order, and what it says under each."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import pandas as pd
from matplotlib.figure import Figure

from curlshot.data.results import Results
from curlshot.data.sheet import House, curling_size
from curlshot.report import figures, tables


@dataclass(frozen=True)
class Picture:
    """One figure of the report: its file's name, what it shows, and how to draw it."""

    name: str
    caption: str
    alt: str
    draw: Callable[[], Figure]


def pictures(
    results: Results,
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
    house: House | None,
    residuals: pd.DataFrame | None = None,
    posterior: pd.DataFrame | None = None,
) -> Iterator[Picture]:
    """Give the figures of a shot in the order of the page, the plan view first.

    Nothing is drawn before `Picture.draw` is called, so that one figure at a time is in memory.

    Parameters
    ----------
    results : Results
        What the run found out.
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`.
    simulations : mapping of str to DataFrame
        Sampled simulation of each model.
    house : House or None
        Rings of the plan view; None where the scene has no house.
    residuals : DataFrame, optional
        As `curlshot.report.tables.residual_table` makes it; without it there is no figure of them.
    posterior : DataFrame, optional
        Samples of ``restitution, friction, stone_friction``; the figure of what is known of
        them needs these or the results' ``laws``.
    """
    collisions, radius = results.collisions, results.radius
    moved = tables.moving_stones(tracks, collisions, radius)
    yield Picture(
        "plan",
        "Plan view: "
        + ("measured paths (solid)" if moved else "nothing moved")
        + (" and simulated ones (dashed)" if len(simulations) else "")
        + ("; crosses mark the hits" if collisions else "")
        + (
            ". Each stone is shown to scale at its last detected place; shading shows the"
            " uncertainty of the place."
        ),
        f"Plan view of the sheet with {tracks['stone'].nunique()} stones, of which {len(moved)}"
        f" moved, and {len(collisions)} hits.",
        partial(figures.plan_figure, tracks, simulations, collisions, house=house, radius=radius),
    )
    if moved:
        yield Picture(
            "speed",
            "Speed of each moving stone, with two standard errors either side. Numbered lines"
            " are the hits.",
            "Speed against time of stones " + ", ".join(moved) + ".",
            partial(figures.speed_figure, tracks, collisions, radius),
        )
    yield from _stones(moved, results, tracks, simulations)
    for rank, collision in enumerate(collisions, 1):
        first, second = collision.stones
        yield Picture(
            f"hit_{rank}",
            f"Hit {rank}, {first} on {second}: velocities before and after, in normal (n) and"
            " tangential (t) axes.",
            f"Stones {first} and {second} touching, with arrows for their velocities.",
            partial(figures.hit_figure, collision, rank, radius),
        )
    if any(glide.friction is not None for glide in results.glides):
        curling = curling_size(radius)
        yield Picture(
            "friction",
            "Friction of each glide with two standard errors, over its range of speeds, and the"
            " law of the shot fit (black)"
            + ("; grey: measurements and laws from the literature." if curling else "."),
            "Friction against speed: a bar for each glide and a line for the shot fit.",
            partial(
                figures.friction_figure, results.glides, results.friction, tracks, curling=curling
            ),
        )
    if results.joint_estimate is not None or posterior is not None:
        yield Picture(
            "posterior",
            "Joint uncertainty of restitution and friction: each alone on the diagonal, pairs"
            " below it.",
            "Distributions of restitution and friction, and ellipses for their pairs.",
            partial(figures.posterior_figure, results.joint_estimate, posterior),
        )
    if residuals is not None and residuals["t"].nunique() > 1:
        yield Picture(
            "residuals",
            "Detections minus smoothed places of all stones. Band: twice the median standard"
            " deviation; carets: outside the plot. Right: in standard deviations, with the normal"
            " distribution. Bars along the top: segments with little weight in the shot fit,"
            " since ice and hits do not explain their motion.",
            "Residuals of x and y against time, and their histograms.",
            partial(figures.residuals_figure, residuals, collisions, results.residuals),
        )


def _stones(
    moved: Sequence[str],
    results: Results,
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
) -> Iterator[Picture]:
    """Give the figures of each stone that moved."""
    collisions, used = results.collisions, set[str]()
    turned = set(tracks.loc[tracks["theta"].notna(), "stone"])
    for stone in moved:
        name = _file_name(stone, used)
        yield Picture(
            f"motion_{name}",
            f"Stone {stone}: place and speed against time, with two standard errors; dotted where"
            " no frame shows it. Straight pieces and numbers: velocities just before and after"
            " each hit, and the friction of each glide.",
            f"x, y and speed of stone {stone} against time.",
            partial(figures.motion_figure, tracks, stone, collisions, results.glides),
        )
        if stone in turned:
            yield Picture(
                f"spin_{name}",
                f"Stone {stone}: angle and spin against time, in the same style; points are the"
                " spins just before and after each hit.",
                f"Angle and spin of stone {stone} against time.",
                partial(figures.spin_figure, tracks, stone, collisions),
            )
        if any((table["stone"] == stone).any() for table in simulations.values()):
            yield Picture(
                f"simulated_{name}",
                f"Stone {stone}: the simulated motion of each model and the measured one, each"
                " with two standard errors.",
                f"Simulated and measured x and y of stone {stone} against time.",
                partial(figures.comparison_figure, tracks, simulations, stone, collisions),
            )


def _file_name(stone: str, used: set[str]) -> str:
    """Return a file name for a stone of any name, unlike those already given."""
    base = name = re.sub(r"[^\w-]+", "_", stone)[:40] or "stone"
    count = 2
    while name.lower() in used:
        name, count = f"{base}-{count}", count + 1
    used.add(name.lower())
    return name
