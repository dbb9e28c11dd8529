"""Plain geometry of the plane, for every room that needs it."""

from __future__ import annotations

from math import hypot


def origin_to_segment(x0: float, y0: float, x1: float, y1: float) -> float:
    """Return the distance of the origin from the segment between two points.

    Examples
    --------
    >>> origin_to_segment(-1.0, 2.0, 1.0, 2.0)
    2.0
    >>> origin_to_segment(3.0, 4.0, 6.0, 8.0)
    5.0
    """
    dx, dy = x1 - x0, y1 - y0
    square = dx * dx + dy * dy
    s = min(max(-(x0 * dx + y0 * dy) / square, 0.0), 1.0) if square else 0.0
    return hypot(x0 + s * dx, y0 + s * dy)
