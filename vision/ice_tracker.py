"""Views carried by what is fixed to the ice, where no rings are to be seen: corners and lines.

Frames that can be predicted are placed together, as those that show the rings are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.clip import Frame
from vision.edge_tracker import EdgeTracker
from vision.joint import Seen
from vision.landmarks import Keyframe, keyframe, recognise
from vision.linear import Observations
from vision.paint import Marks, joined
from vision.picture import Picture
from vision.pose import View, project
from vision.resection import solve_view, solve_views

Array = NDArray[np.float64]

NEAR = 0.002
"""How far a view may be aside for lines to be looked for from it, widths of the picture."""

MOST_DRIFT = 0.25
"""A view carried so far astray is given up, m."""

VIEW_SD = (1.0, 1.0, 0.02, 0.1)
"""How far a view may lie from where its corners, or the views before, have it."""


@dataclass
class IceTracker:
    """What is known of the ice from the last frame that showed the rings, or one after it.

    Attributes
    ----------
    key : Keyframe, optional
        What frames are compared with; None while the rings are in view.
    missed : int
        Frames in a row that were carried to where rings should be in view, and are not.
    """

    key: Keyframe | None = None
    missed: int = 0

    def forget(self) -> None:
        """Begin anew from the next frame that does not show the rings."""
        self.key, self.missed = None, 0

    def settle(
        self,
        frames: Sequence[Frame],
        views: Sequence[View],
        last: Seen,
        picture: Picture,
        rig: Array,
        edges: EdgeTracker,
    ) -> list[Seen]:
        """Place frames by points of the ice that are known.

        Parameters
        ----------
        frames, views : sequences of Frame and View
            One or more frames, and where they are expected.
        last, picture : Seen, Picture
            The frame before them, and its picture.
        rig : ndarray, shape (14,)
        edges : EdgeTracker
            Measures the lines, and the rings as soon as they should be in view again.

        Returns
        -------
        list of Seen
            The first of the frames, as many as went well; none where the first does not show
            the same ice.
        """
        if self.key is None:
            cov = np.zeros((4, 4)) if edges.fit is None else edges.fit.cov
            self.key = keyframe(last.index, picture, last.view, rig, cov)
        key = self.key
        views, corners = _recognised(key, frames, views, rig)
        if not corners:
            return []
        if edges.expects(views[0], rig):
            seen = edges.settle(frames[:1], views[:1], rig, last.view)
            if seen:
                self.forget()
                return seen
            self.missed += 1
            views, corners = views[:1], corners[:1]
        else:
            self.missed = 0
        pictures = [frame.picture for frame in frames[: len(views)]]
        lines = edges.lines(pictures, views, rig)
        marks = [joined(both) for both in zip(corners, lines, strict=False)]
        observed = Observations(joined(marks), edges.size, counts=[len(m) for m in marks])
        fits = solve_views(observed, views[: len(marks)], rig, view_sd=VIEW_SD)
        frame, fit = frames[len(fits) - 1], fits[-1]
        if _is_worn(corners[len(fits) - 1], key):
            self.key = keyframe(frame.index, frame.picture, fit.view, rig, fit.cov, key.drift)
        return [
            Seen(frame.index, frame.t, fit.view, each, False, key)
            for frame, fit, each in zip(frames, fits, marks, strict=False)
        ]


def _recognised(
    key: Keyframe, frames: Sequence[Frame], views: Sequence[View], rig: Array
) -> tuple[list[View], list[Marks]]:
    """Find a keyframe's corners in frames, up to one that shows few of them: views and marks."""
    seen: list[View] = []
    found: list[Marks] = []
    if key.drift > MOST_DRIFT:
        return seen, found
    for frame, view in zip(frames, views, strict=True):
        corners = recognise(key, frame.picture, view, rig)
        if corners is None:
            break
        height, width = frame.picture.shape[:2]
        if _aside(corners, view, rig, (width, height)) > NEAR * width:
            free = np.full(4, np.inf)
            view = solve_view(corners, view, rig, (width, height), width=10.0, view_sd=free).view
        seen.append(view)
        found.append(corners)
        if _is_worn(corners, key):
            break
    return seen, found


def _is_worn(corners: Marks, key: Keyframe) -> bool:
    """Whether half of a keyframe's corners are no longer seen: each that is gives two marks."""
    return len(corners) < len(key.ice)


def _aside(corners: Marks, view: View, rig: Array, size: tuple[int, int]) -> float:
    """How far from where a view has them corners were seen, px."""
    assert corners.across is not None
    count = len(corners) // 2
    ice = np.stack([corners.along[:count], corners.across[:count]], axis=-1)
    aside = project(ice, view.vector, rig, size) - corners.pixel[:count]
    return float(np.abs(aside.mean(0)).max())
