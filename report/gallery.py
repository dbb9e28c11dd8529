"""Which figures a report shows, in which order, and what it says under each."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import pandas as pd
from matplotlib.figure import Figure

from data.results import Results
from data.sheet import House
from report import figures, tables


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


def _file_name(stone: str, used: set[str]) -> str:
    """Return a file name for a stone of any name, unlike those already given."""
    base = name = re.sub(r"[^\w-]+", "_", stone)[:40] or "stone"
    count = 2
    while name.lower() in used:
        name, count = f"{base}-{count}", count + 1
    used.add(name.lower())
    return name
