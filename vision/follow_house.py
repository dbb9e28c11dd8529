"""Follow the house through a clip: one camera place, pan, tilt, roll and zoom per frame.

The house is found once. From then on each frame is predicted, its edges are measured along
their normals and the view is refined. When the clip has been read, place, distortion and painted
radii are fitted jointly to many frames, and every view again with these held.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from data.errors import SceneError
from data.progress import Progress, no_progress
from vision.adjust import solve
from vision.clip import Clip, Frame, Image
from vision.flow import carried, similarity
from vision.house import HouseFit, find_house, judge
from vision.joint import HouseTrack, Seen, fit_clip
from vision.marks import measure
from vision.pose import (
    ANYWHERE,
    CIRCLES,
    OVERHEAD,
    Prior,
    View,
    joined,
)

Array = NDArray[np.float64]

FIND_EVERY = 5
"""Frames from one attempt to find the house to the next."""

LOOK_BACK = 60
"""Frames kept while the house has not been found, to be followed backwards from the first find."""

SETTLED_PX = 1.5
"""Correction below which the edges need not be measured anew from the corrected view, px."""

CARRY_MAX_S = 4.0
"""A view carried longer than this without rings is given up."""


@dataclass
class _Piece:
    """Frames without a cut in between, and what was found first."""

    rig: Array
    prior: Prior
    seen: list[Seen] = field(default_factory=list)

    @property
    def length(self) -> int:
        return sum(s.found for s in self.seen)


def follow_house(
    clip: Clip, progress: Progress = no_progress, first: HouseFit | None = None
) -> HouseTrack:
    """Follow the house through a clip.

    Parameters
    ----------
    clip : Clip
        Read once, in order; a single picture is a clip of one frame.
    progress : Progress
    first : HouseFit, optional
        The house in the frame of its camera: the piece that shows it is used. Else it is looked
        for, and the longest piece is used.

    Raises
    ------
    SceneError
        No house can be made out in any frame.
    """
    pieces = _read(clip, progress, first)
    if not pieces:
        raise SceneError(
            f"{clip.files[0]}: no house in view; point at it with --house, or for another scene"
            " with a still camera use --stick X1,Y1,X2,Y2,METRES"
        )
    best = max(pieces, key=lambda p: p.length) if first is None else pieces[0]
    progress("camera", 0, 1)
    track = fit_clip(best.seen, best.rig, best.prior, clip.size)
    which = "the longest" if first is None else "the one given"
    track = replace(track, warnings=(*_left_out(best, len(pieces), which), *track.warnings))
    progress("camera", 1, 1)
    return track


def _read(clip: Clip, progress: Progress, given: HouseFit | None) -> list[_Piece]:
    pieces: list[_Piece] = []
    piece: _Piece | None = None
    waiting: deque[Frame] = deque(maxlen=LOOK_BACK)
    before: Image | None = None
    for count, frame in enumerate(clip):
        progress("house", count + 1, clip.expected)
        if piece is not None:
            seen = _next(piece, frame, before)
            if seen is None:
                _trim(piece)
                piece, last_try = None, -FIND_EVERY
                waiting.clear()
            else:
                piece.seen.append(seen)
        if piece is None:
            if given is not None and not pieces:
                fit = given if frame.index == given.camera.frame else None
            elif not waiting or count - last_try >= FIND_EVERY or clip.expected == count + 1:
                last_try = count
                fit = find_house(frame.image)
            else:
                fit = None
            if fit is not None:
                piece = _start(fit, frame, waiting)
                pieces.append(piece)
                waiting.clear()
            if piece is None:
                waiting.append(frame)
        before = frame.image
    return [p for p in pieces if p.length]


def _start(fit: HouseFit, frame: Frame, waiting: deque[Frame]) -> _Piece:
    """From the house in one frame, follow it back through the frames before."""
    piece = _Piece(fit.rig, OVERHEAD if fit.overhead else ANYWHERE)
    first = Seen(frame.index, frame.t, fit.view, fit.evidence.marks, True)
    piece.seen.append(first)
    after = frame.image
    for earlier in reversed(waiting):
        seen = _next(piece, earlier, after)
        if seen is None:
            break
        piece.seen.append(seen)
        after = earlier.image
    piece.seen.reverse()
    return piece


def _trim(piece: _Piece) -> None:
    """Take carried frames off the end: a cut may have come among them."""
    while piece.seen and not piece.seen[-1].found:
        piece.seen.pop()


def _next(piece: _Piece, frame: Frame, before: Image | None) -> Seen | None:
    """Follow into one more frame; None where the scene is another one."""
    last = piece.seen[-1]
    speed = np.zeros(4)
    if len(piece.seen) > 1 and piece.seen[-2].found and last.found:
        speed = last.view.vector - piece.seen[-2].view.vector
    seen = _settle(piece, frame, View(last.view.vector + speed))
    if seen is not None:
        return seen
    size = (frame.image.shape[1], frame.image.shape[0])
    matrix = None if before is None else similarity(before, frame.image)
    if matrix is None:
        return None
    ghosts = carried(matrix, last.view, piece.rig, size)
    if len(ghosts) < 8:
        return None
    moved = solve([ghosts], [last.view], piece.rig, size, view_sd=(1, 1, 0.02, 0.1)).views[0]
    seen = _settle(piece, frame, moved)
    if seen is not None:
        return seen
    since = next((s.t for s in reversed(piece.seen) if s.found), frame.t)
    if abs(frame.t - since) > CARRY_MAX_S:
        return None
    if (frame.index - piece.seen[0].index) % FIND_EVERY == 0:
        fit = find_house(frame.image)
        if fit is not None:
            seen = _settle(piece, frame, fit.view)
            if seen is not None:
                return seen
    lines = measure(frame.image, moved.vector, piece.rig, reach=_reach(size)).marks
    marks = joined([ghosts, lines.pick(lines.line >= CIRCLES)])
    view = solve([marks], [moved], piece.rig, size, view_sd=(1, 1, 0.02, 0.1)).views[0]
    return Seen(frame.index, frame.t, view, marks, False)


def _reach(size: tuple[int, int]) -> float:
    return max(7.0, 0.007 * size[0])


def _settle(piece: _Piece, frame: Frame, view: View) -> Seen | None:
    """Refine a predicted view on the rings; None where they are not there."""
    size = (frame.image.shape[1], frame.image.shape[0])
    reach = _reach(size)
    for _ in range(3):
        evidence = measure(frame.image, view.vector, piece.rig, reach=reach)
        if judge(evidence) == 0:
            return None
        fit = solve(
            [evidence.marks], [view], piece.rig, size, view_sd=(np.inf, np.inf, 0.02, np.inf)
        )
        shift = np.abs(fit.views[0].vector - view.vector)
        view = fit.views[0]
        if shift[:3].max() * view.focal < SETTLED_PX:
            break
    marks = evidence.marks.pick(fit.inliers[0])
    return Seen(frame.index, frame.t, view, marks, True)


def _left_out(piece: _Piece, pieces: int, which: str) -> tuple[str, ...]:
    if pieces == 1:
        return ()
    first, last = piece.seen[0].index, piece.seen[-1].index
    return (
        f"the house is shown in {pieces} separate pieces; only {which} is used, frames"
        f" {first} to {last}",
    )
