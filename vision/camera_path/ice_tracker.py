"""Tracking where no rings are in view: by landmarks (corners in the ice) and straight lines.

Frames that can be predicted are placed together, as those that show the rings are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.camera_path.edge_tracker import EdgeTracker
from curlshot.vision.camera_path.joint import Seen
from curlshot.vision.camera_path.keyframe import Keyframe, keyframe
from curlshot.vision.camera_path.landmarks import Landmarks
from curlshot.vision.optics.linear import Observations
from curlshot.vision.optics.paint import Marks, joined
from curlshot.vision.optics.pose import VIEW_SIZE, View
from curlshot.vision.optics.resection import solve_view, solve_views
from curlshot.vision.video.disk_cache import Cached
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Picture

Array = NDArray[np.float64]

NEAR = 0.002
"""How far a view may be aside for lines to be looked for from it, widths of the picture."""

MOST_DRIFT = 0.25
"""A view carried so far astray is given up, m."""

FROM_CORNERS_SD = (1.0, 1.0, 0.02, 0.1)
"""How far a view may lie from where its corners, or the views before, have it."""


@dataclass
class IceTracker:
    """What is known of the ice from the last frame that showed the rings, or one after it.

    Attributes
    ----------
    landmarks : Landmarks, optional
        What is looked for; None while the rings are in view.
    missed : int
        Frames in a row that were carried to where rings should be in view, and are not.
    """

    landmarks: Landmarks | None = None
    missed: int = 0
    _cov: Array = field(default_factory=lambda: np.zeros((VIEW_SIZE, VIEW_SIZE)))

    def forget(self) -> None:
        """Begin anew from the next frame that does not show the rings."""
        self.landmarks, self.missed = None, 0

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
        rig : ndarray, shape (15,)
        edges : EdgeTracker
            Measures the lines, and the rings as soon as they should be in view again.

        Returns
        -------
        list of Seen
            The first of the frames, as many as went well; none where the first does not show
            the same ice.
        """
        landmarks = self.landmarks
        if landmarks is None:
            cov = self._cov if edges.fit is None else edges.fit.cov
            landmarks = Landmarks(keyframe(last.index, picture, last.view, rig, cov))
        placed, corners = _recognised(landmarks, frames, views, rig)
        key = landmarks.key
        if not corners and last.index != key.frame:
            # What is left of the corners does not do: those of the frame before may.
            key = keyframe(last.index, picture, last.view, rig, self._cov, key.drift)
            landmarks = Landmarks(key)
            placed, corners = _recognised(landmarks, frames, views, rig)
        self.landmarks = landmarks
        if not corners:
            return []
        if edges.expects(placed[0], rig):
            seen = edges.settle(frames[:1], placed[:1], rig, last.view)
            if seen:
                self.forget()
                return seen
            self.missed += 1
            placed, corners = placed[:1], corners[:1]
        else:
            self.missed = 0
        pictures = [frame.picture for frame in frames[: len(placed)]]
        lines = edges.lines(pictures, placed, rig)
        marks = [joined(both) for both in zip(corners, lines, strict=False)]
        observed = Observations(joined(marks), edges.size, counts=[len(m) for m in marks])
        fits = solve_views(observed, placed[: len(marks)], rig, view_sd=FROM_CORNERS_SD)
        frame, fit = frames[len(fits) - 1], fits[-1]
        self._cov = fit.cov
        if _is_worn(corners[len(fits) - 1], key):
            key_now = keyframe(frame.index, frame.picture, fit.view, rig, fit.cov, key.drift)
            self.landmarks = Landmarks(key_now)
        return [
            Seen(frame.index, frame.t, fit.view, Cached(each), False, key)
            for frame, fit, each in zip(frames, fits, marks, strict=False)
        ]


def _recognised(
    landmarks: Landmarks, frames: Sequence[Frame], views: Sequence[View], rig: Array
) -> tuple[list[View], list[Marks]]:
    """Find landmarks in frames, up to one that shows few of them: views and marks."""
    seen: list[View] = []
    found: list[Marks] = []
    if landmarks.key.drift > MOST_DRIFT:
        return seen, found
    for frame, view in zip(frames, views, strict=True):
        known = landmarks.find(frame.picture, view, rig)
        if known is None:
            break
        height, width = frame.picture.shape[:2]
        if known.aside > NEAR * width:
            free = np.full(VIEW_SIZE, np.inf)
            view = solve_view(
                known.marks, view, rig, (width, height), width=10.0, view_sd=free
            ).view
        seen.append(view)
        found.append(known.marks)
        if _is_worn(known.marks, landmarks.key):
            break
    return seen, found


def _is_worn(corners: Marks, key: Keyframe) -> bool:
    """Whether half of a keyframe's corners are no longer seen: each that is gives two marks."""
    return len(corners) < len(key.ice)
