"""The contact sheet of ``curlshot check``, by which to trust the camera and the detections."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from numpy.typing import NDArray

from curlshot.data.sheet import STONE
from curlshot.report.drawing import circle, draw_lines, ice_lines
from curlshot.report.looks import COLUMNS, UPRIGHT_COLUMNS, Look, numbered, way_of_play
from curlshot.report.style import (
    BLUE,
    GREY,
    ORANGE,
    SKY,
    VERMILLION,
    new_figure,
    plain_text,
    styled,
)
from curlshot.vision.detection.ice_map import rectify
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]
Paint = tuple[Sequence[Array], Sequence[Array]]
"""Rings and lines as they should be painted, each the places along it, m."""

PICTURE_WIDTH = 640
"""Width of a frame on the sheet, px."""

AVERAGE_SIZE = 484
"""Longer side of the average ice, px."""

REACH = 2.2
"""Half width of the average ice, m."""

AROUND_TEE = (-REACH, REACH, -REACH, REACH)
"""The part of the ice that the average shows: x from and to, y from and to, m."""

_RINGS, _LINES = (255, 255, 0), (0, 255, 255)  # BGR: on no common paint
_TAKEN, _REFUSED = (80, 255, 80), (60, 60, 255)
_CIRCLE = circle(61)


def check_figure(
    looks: Sequence[Look],
    cameras: pd.DataFrame,
    rings: Sequence[float],
    *,
    title: str = "",
    radius: float = STONE.radius,
) -> Figure:
    """Frames with the model drawn on them, their average from above, and the residuals.

    Parameters
    ----------
    looks : sequence of Look
        The frames to show.
    cameras : DataFrame
        One row per frame, as `curlshot.report.looks.check_table` gives it.
    rings : sequence of float
        Painted radii, m; none where there is no house.
    title : str
        Heads the sheet.
    radius : float
        Radius of the stones, m.

    Returns
    -------
    Figure
        The average is sharp, and the lines lie on the paint, where the camera was followed well.
        Without a house it shows what of the ice is in the first picture, and what was not measured
        has no panel.
    """
    reasons = sorted({place.reason for look in looks for place in look.refused})
    lines = ice_lines(rings, way_of_play(looks, radius))
    paint = lines[: len(rings)], lines[len(rings) :]
    with styled():
        if len(cameras) == 1:
            figure = new_figure(16, 6.0)
            parts: Any = figure.subfigures(1, 2, width_ratios=(1.9, 1))
            upper, right = parts
            _frames(upper, looks, paint, radius, reasons, columns=1)
            _average(right.subplots(), looks, paint)
        else:
            high, wide = looks[0].frame.image.shape[:2]
            columns = min(len(looks), COLUMNS if wide >= high else UPRIGHT_COLUMNS)
            tall = (16 / columns * high / wide + 0.2) * -(-len(looks) // columns)
            figure = new_figure(16, tall + 4.6)
            parts = figure.subfigures(2, 1, height_ratios=(tall, 4.6))
            upper, foot = parts
            _frames(upper, looks, paint, radius, reasons, columns)
            courses = _courses(cameras)
            if courses:
                foot, right = foot.subfigures(1, 2, width_ratios=(1, 2.2))
                axes = right.subplots(len(courses), 1, sharex=True, squeeze=False)[:, 0]
                _residuals(axes, cameras, courses)
            _average(foot.subplots(), looks, paint)
        figure.suptitle(plain_text(title), x=0.01, ha="left", weight="bold", fontsize=12)
    return figure


def _frames(
    part: SubFigure,
    looks: Sequence[Look],
    paint: Paint,
    radius: float,
    reasons: Sequence[str],
    columns: int,
) -> None:
    """Show the frames with the model on them, and what the numbers at refused places mean."""
    width = round(PICTURE_WIDTH * min(COLUMNS / columns, 2))
    axes = part.subplots(-(-len(looks) // columns), columns, squeeze=False).ravel()
    for ax, look in zip(axes, looks, strict=False):
        _show(ax, _drawn(look, paint, radius, reasons, width))
        where = "" if look.camera.found else ", carried over"
        ax.set_title(f"frame {look.frame.index}, {look.frame.t:.2f} s{where}", fontsize=8)
    for ax in axes[len(looks) :]:
        ax.axis("off")
    key = "; ".join(f"{number} {text}" for number, text in enumerate(reasons, 1))
    refused = (
        f"; rejected: red, because {key if len(reasons) > 1 else reasons[0]}" if reasons else ""
    )
    part.supxlabel(f"accepted stones: green{refused}", fontsize=9)


def _drawn(look: Look, paint: Paint, radius: float, reasons: Sequence[str], width: int) -> Image:
    """Draw the model on a copy of the frame, reduced to a width on the sheet, px."""
    image = look.frame.image.copy()
    thickness = max(round(image.shape[1] / width), 1)
    for colour, lines in zip((_RINGS, _LINES), paint, strict=True):
        draw_lines(image, look.camera, lines, colour, thickness, edge=False)
    height = STONE.cap_height * radius / STONE.radius
    for stone in look.stones:
        outline = np.array([stone.x, stone.y]) + radius * _CIRCLE
        draw_lines(image, look.camera, [outline], _TAKEN, 2 * thickness, height)
    for place in look.refused:
        outline = np.array([place.x, place.y]) + radius * _CIRCLE
        draw_lines(image, look.camera, [outline], _REFUSED, thickness, height)
    for place in numbered(look.refused, 2 * radius) if len(reasons) > 1 else ():
        at = look.camera.project(np.array([place.x + radius, place.y]), height)
        cv2.putText(
            image, str(reasons.index(place.reason) + 1), (int(at[0]) + 4, int(at[1])),
            cv2.FONT_HERSHEY_SIMPLEX, 0.5 * thickness, _REFUSED, thickness, cv2.LINE_AA,
        )  # fmt: skip
    factor = width / image.shape[1]
    if factor >= 1:
        return image
    return np.asarray(
        cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA), np.uint8
    )


def _show(ax: Axes, image: Image) -> None:
    ax.imshow(image[..., ::-1])
    ax.axis("off")


def _average(ax: Axes, looks: Sequence[Look], paint: Paint) -> None:
    """Show the median of the frames seen from above: sharp if the camera was followed well."""
    bounds = AROUND_TEE if paint[0] else _in_view(looks[0])
    left, right, low, top = bounds
    scale = AVERAGE_SIZE / max(right - left, top - low)
    shape = round((top - low) * scale), round((right - left) * scale)
    layers = []
    for look in looks:
        ice = rectify(look.frame.image, look.camera, bounds, scale=scale)
        if ice is None:
            continue
        layer = np.full((*shape, 3), np.nan, np.float32)
        down, across = round((top - ice.top) * scale), round((ice.left - left) * scale)
        part = np.where(ice.valid[..., None], ice.image, np.nan)
        part = part[max(-down, 0) : shape[0] - down, max(-across, 0) : shape[1] - across]
        down, across = max(down, 0), max(across, 0)
        layer[down : down + part.shape[0], across : across + part.shape[1]] = part
        layers.append(layer)
    ax.set_title(
        "top view" if len(looks) == 1 else "median top view: sharp where the camera track is good"
    )
    if layers:
        stack = np.stack(layers)
        shown = np.isfinite(stack).any(0)
        middle = np.nanmedian(np.where(shown, stack, 0.0), axis=0)
        ax.imshow(np.clip(middle[..., ::-1], 0, 255).astype(np.uint8), extent=bounds)
    for colour, lines in zip((SKY, ORANGE), paint, strict=True):
        for line in lines:
            ax.plot(*line.T, color=colour, lw=0.5)
    ax.set(xlim=bounds[:2], ylim=bounds[2:], aspect="equal")
    ax.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
    ax.grid(False)


def _in_view(look: Look) -> tuple[float, float, float, float]:
    """Give the part of the ice about the origin that a picture shows: x from and to, y, m."""
    ice = rectify(look.frame.image, look.camera, AROUND_TEE, scale=AVERAGE_SIZE / (2 * REACH))
    if ice is None or not ice.valid.any():
        return AROUND_TEE
    rows, columns = np.flatnonzero(ice.valid.any(1)), np.flatnonzero(ice.valid.any(0))
    ends = ice.place(columns[[0, -1]].astype(float), rows[[-1, 0]].astype(float))
    (x0, y0), (x1, y1) = np.clip(ends, -REACH, REACH).tolist()
    return x0, x1, y0, y1


def _courses(cameras: pd.DataFrame) -> list[tuple[str, float, str, str]]:
    """Tell what is known of the cameras over time: its column, factor, colour, what it is."""
    courses = []
    if cameras["rms_px"].notna().any():
        courses.append(("rms_px", 1.0, BLUE, "edge residual (px)"))
    if (cameras["sd"] > 0).any():
        courses.append(("sd", 1000.0, VERMILLION, "estimated error at the\n12-ft ring (mm, 1 sd)"))
    return courses


def _residuals(
    axes: NDArray[np.object_],
    cameras: pd.DataFrame,
    courses: Sequence[tuple[str, float, str, str]],
) -> None:
    """Plot the edges' residual and the stated error against time, carried frames shaded."""
    t = cameras["t"].to_numpy(float)
    step = float(np.median(np.diff(t))) if len(t) > 1 else 0.04
    carried = cameras["found"].to_numpy() == 0
    for ax, (column, factor, colour, label) in zip(axes, courses, strict=True):
        value = factor * cameras[column].to_numpy(float)
        ax.plot(t, value, ".-", color=colour, ms=3, lw=0.8)
        for start in t[carried]:
            ax.axvspan(start - step / 2, start + step / 2, color=GREY, alpha=0.25, lw=0)
        ax.set_ylabel(label)
        ax.set_ylim(0, max(1.2 * float(np.nanmax(value)), 0.1))
    axes[0].set_title(
        "shaded: carried over, rings not visible"
        if carried.any()
        else "rings visible in every frame"
    )
    axes[-1].set_xlabel("time (s)")
