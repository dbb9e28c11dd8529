"""Errors that video coding adds to the place of whole pictures.

A codec repeats what has hardly moved since the picture before, and copies what has moved, to a
fraction of a pixel. So all edges of a picture may be displaced together, which its own residuals
do not show. But they show how coarsely the film was compressed: in clips with truth the error
follows from them and from the motion between pictures.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.linear import Linear, Observations

Array = NDArray[np.float64]
Index = NDArray[np.int64]

COPIED, REPEATED = 0.24, 0.28
"""How far pictures are aside, in residuals of their edges: those that move by much, and how much
more those are that hardly move. By clips with truth of eleven makers: of their places 95 to 97 %
then lie within two standard errors."""

MUCH = 4.0
"""Motion from one picture to the next, in residuals, by which pictures are repeated half as
often."""

NONE = 0.07
"""The same by which a camera that hardly moves differs from one that stands: a picture that is
repeated is aside by no more than the camera has moved."""

NEAR = 2
"""Steps before and after a picture over which motion is averaged: shaking cameras turn back."""

LASTING = 12
"""Frames before and after one that moves in which a picture that stands is aside as well: a film
stands when a camera has hardly begun to move, and where it comes to rest it stays aside."""


def motion(observed: Observations, at: Linear, views: Array, places: Array, index: Index) -> Array:
    """Estimate the image motion of each frame's edges per frame of the clip, r.m.s., px.

    Parameters
    ----------
    observed : Observations
    at : Linear
    views : ndarray, shape (frames, 4)
    places : ndarray, shape (frames, 3)
        Where the camera is, m: one that glides on and turns back hardly moves the picture.
    index : ndarray of int, shape (frames,)
        Of the frames in the clip, ascending: some between them may be missing.

    Returns
    -------
    ndarray, shape (frames,)
    """
    squares = np.zeros(max(len(views) - 1, 1))
    steps = np.diff(np.hstack([views, -places]), axis=0) / np.diff(index)[:, None]
    for k, step in enumerate(steps):
        part = observed.parts[k]
        by_step = np.concatenate([at.by_view[:, part], at.by_place[:, part]])
        along = observed.sd[part] * (step @ by_step)
        # Along normals there is half of what goes in any direction.
        squares[k] = 2 * along @ along / max(len(along), 1)
    near = [squares[max(k - NEAR, 0) : k + NEAR] for k in range(len(views))]
    return np.sqrt([around.mean() for around in near])


def astray(moved: Array, rms: Array) -> Array:
    """Estimate the standard deviation per axis of the displacement of whole pictures, px.

    Parameters
    ----------
    moved : ndarray, shape (frames,)
        How far the edges move from frame to frame, px; of frames in the order of time.
    rms : ndarray, shape (frames,)
        Residual of the edges, px; NaN where there are none.
    """
    residual = np.nan_to_num(rms)
    shares = np.square(moved / np.maximum(residual, 1e-9))
    about = np.pad(shares, LASTING)
    lately: Array = np.lib.stride_tricks.sliding_window_view(about, 2 * LASTING + 1).max(-1)
    aside: Array = residual * (COPIED + REPEATED / (1 + shares / MUCH**2))
    return aside * lately / (lately + NONE**2)
