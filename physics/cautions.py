"""What a person should know of a shot's numbers: what is too little, implausible or left out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from curlshot.data.measurement import Measurement

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.data.results import Estimate

FEWEST = 4
"""Frames in which stones must be seen to tell how they move: in three one that is hit looks like
an outlier."""

ICE = (0.004, 0.03)
"""Frictions that stones have on curling ice, from the keenest to wet or frosted one."""

SLIPPERIEST = 2e-4
"""Friction below that of anything that glides: a twentieth of that of the keenest ice."""

NO_SHEET = (
    "the shot does not run along y within the sidelines of a sheet with its origin at the tee;"
    " house and lines are not drawn; if there is a sheet, put the origin on the tee and y along it"
)

LISTED = 4
"""Marks left out that are named one by one, the worst."""


def cautions(
    measured: Measurement, tracks: pd.DataFrame, friction: Estimate, sheet: bool
) -> tuple[str, ...]:
    """Say what makes the numbers of a shot doubtful.

    Parameters
    ----------
    measured : Measurement
        What was seen, or read.
    tracks : DataFrame
        As ``tracks.csv``.
    friction : Estimate
        Of the ice.
    sheet : bool
        Whether the shot comes along the sheet of the house, if there is one.
    """
    from curlshot.physics.prediction.throws import later_throws

    detections = measured.detections
    pace = _pace_anywhere if measured.house is None else _pace
    return (
        *(() if sheet else (NO_SHEET,)),
        *pace(friction),
        *_throws(later_throws(tracks)),
        *_few(detections["frame"].nunique()),
        # In a clip people cover stones in passing.
        *(_left_out(detections, tracks) if measured.clip is None else ()),
    )


def _few(frames: int) -> tuple[str, ...]:
    """Say so where too little is seen to tell a stone that moves from one that does not."""
    if not 1 < frames < FEWEST:
        return ()
    return (
        f"stones are measured in {frames} frames: too few to identify which ones move, what hits"
        f" them and where they stop; at least {FEWEST} are needed",
    )


def _pace(friction: Estimate) -> tuple[str, ...]:
    """Say so where stones slow as on no ice.

    A clip that runs k times too slowly shows μ / k², tracks k times too long k μ.
    """
    from curlshot.physics.shot_fit.priors import FRICTION

    value, stderr = friction.value, friction.stderr
    if value is None or stderr is None or value <= 0:
        return ()
    if ICE[0] < value + 2 * stderr and value - 2 * stderr < ICE[1]:
        return ()
    times, pace = (FRICTION / value) ** 0.5, "slow"
    if times < 1:
        times, pace = 1 / times, "fast"
    return (
        f"friction: {value:.2g} is not that of curling ice; a clip in {pace} motion (about"
        f" {times:.2g} times) or tracks in another length unit would explain it; then speeds are"
        " wrong, e is not",
    )


def _pace_anywhere(friction: Estimate) -> tuple[str, ...]:
    """Say so where discs slow as on no surface at all, of whatever they are made."""
    value, stderr = friction.value, friction.stderr
    if value is None or stderr is None or value <= 0 or value + 2 * stderr > SLIPPERIEST:
        return ()
    return (
        f"friction: {value:.2g} is below that of any surface; a wrong frame rate (`fps`), slow"
        " motion or another length unit would explain it; then speeds are wrong, e is not",
    )


def _throws(later: Mapping[str, float]) -> tuple[str, ...]:
    """Say so where more than one stone is thrown."""
    if not later:
        return ()
    each = ", ".join(f"{name} at {when:.2f} s" for name, when in later.items())
    return (
        f"more than one throw: {each}, after all others stopped; e and μ are of all throws,"
        " predictions of the first hit; to measure one throw, cut the table or choose its frames"
        " (`frames`)",
    )


def _left_out(detections: pd.DataFrame, tracks: pd.DataFrame) -> tuple[str, ...]:
    """Name the marks that are far off the ways of their stones, so that no track heeds them."""
    import numpy as np

    refused = tracks.loc[tracks["seen"] == 0, ["stone", "frame", "t", "x", "y"]]
    both = refused.merge(detections, on=["stone", "frame"], suffixes=("", "_marked"))
    both["off"] = np.hypot(both["x"] - both["x_marked"], both["y"] - both["y_marked"])
    both = both.dropna(subset="off")
    if both.empty:
        return ()
    worst = both.nlargest(LISTED, "off").sort_values("t")
    columns = (worst[name].tolist() for name in ("stone", "t", "off"))
    each = ", ".join(
        f"{stone} at {t:.2f} s ({_little(off)} off)" for stone, t, off in zip(*columns, strict=True)
    )
    more = f" and {len(both) - len(worst)} more" if len(both) > len(worst) else ""
    return (f"marks far from the trajectories of their stones are left out: {each}{more}",)


def _little(length: float) -> str:
    """Write a length of centimetres, m, or of less."""
    return f"{100 * length:.0f} cm" if length > 0.0095 else f"{1000 * length:.1f} mm"
