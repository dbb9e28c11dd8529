"""Follow the house through a clip: one camera place, pan, tilt, roll and zoom per frame.

The house is found once. From then on each frame is predicted, its edges are measured along
their normals and the view is refined. Where that fails, the picture before is recognised in it,
and last the house is found anew. What all frames share is fitted when the clip has been read.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import SceneError
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import HOUSE
from curlshot.vision.camera_path.edge_tracker import EdgeTracker
from curlshot.vision.camera_path.joint import HouseTrack, Seen, fit_clip
from curlshot.vision.camera_path.piece import MOST_MISSED, Piece
from curlshot.vision.camera_path.replay import Glimpse, glimpse, has_jumped, is_nearer, is_replay
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.paint import TWELVE
from curlshot.vision.optics.placed import Placed, nobody
from curlshot.vision.optics.pose import View
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit, at_height
from curlshot.vision.video.disk_cache import DiskCache
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import image_of
from curlshot.vision.video.reader import Video

Array = NDArray[np.float64]

FIND_EVERY, FIND_RARELY = 5, 15
"""Frames from one attempt to find the house to the next: one more after each failure, till the
second. What is found then is followed back through the frames kept."""

LOOK_BACK, MOST_WAITING = 100, 72 * 1920 * 1080
"""Frames kept while the house has not been found, to be followed backwards from the first find;
and pixels that they may have together: beyond that there are fewer of them."""

FULLER, ELSEWHERE = 0.2, 1.0
"""How much more of the 12-ft circle must be in view for another house to take the place of one that
is cut, and distance of two tees, m, from which on they are of two houses."""

BESIDE = np.array([(way * apart, 0.0) for way in (-1, 1) for apart in np.arange(4.2, 6.1, 0.2)])
"""Where tees of the sheets beside may be, m: sheets are 4.4 to 5 m wide, with paths between."""

MOST_SPANS = 5
"""Runs of frames left out that one warning names: more are for the table of cameras."""

PATIENCE = 12
"""Frames in a row that may fail before following gives up and only finding is left."""

ROOM = 400
"""Frames whose marks, some 30 kB each, need not be put aside: as many as most shots have."""


class HouseFollower:
    """Follows the house frame by frame, in one pass.

    Parameters
    ----------
    size : tuple of int
        Width and height of the pictures, px.
    first : HouseFit, optional
        The house in the frame of its camera: what shows that one is the shot. Else it is looked
        for, and the longest piece is the shot.
    height : float, optional
        How high the camera hangs, m, where somebody says it.
    """

    def __init__(
        self,
        size: tuple[int, int],
        first: HouseFit | None = None,
        height: float | None = None,
    ) -> None:
        self._size, self._height = size, height
        self._first = first
        self._looked: list[int] = []
        self._cache = DiskCache(ROOM)
        self._pieces: list[Piece] = []
        self._piece: Piece | None = None
        self._ahead: list[Frame] = []
        self._waiting: deque[Frame] = deque(maxlen=_looked_back(size))
        self._between = FIND_EVERY
        self._since_find = FIND_EVERY

    def look(self, frame: Frame) -> Sequence[tuple[Frame, Camera]]:
        """Take in one more frame; a few are placed together where they can be predicted.

        Returns
        -------
        sequence of (Frame, Camera)
            Frames placed thereby, in order, with provisional cameras: as a rule this one, or
            some and this one; after a find also those before it; none where no house is seen, or
            while too little is known of what its frames share.
        """
        self._looked.append(frame.index)
        self._ahead.append(frame)
        placed: list[tuple[Frame, Camera]] = []
        while len(self._ahead) >= self._stride:
            placed += self._placed_next()
        return placed

    def catch_up(self) -> Sequence[tuple[Frame, Camera]]:
        """Place the frames that still wait to be placed together with the next; as `look`."""
        placed: list[tuple[Frame, Camera]] = []
        while self._ahead:
            placed += self._placed_next()
        if self._piece is None:
            return placed
        self._piece.give_up_missed()
        return [*placed, *self._piece.let_go()]

    @property
    def _stride(self) -> int:
        """How many frames are followed together."""
        return 1 if self._piece is None or self._piece.lost else self._piece.edges.stride

    def _placed_next(self) -> Sequence[tuple[Frame, Camera]]:
        """As `_go_on`; before them those that a piece which ends there has held back."""
        piece = self._piece
        placed = self._go_on()
        if piece is None or piece is self._piece:
            return placed
        return [*piece.let_go(), *placed]

    def _go_on(self) -> Sequence[tuple[Frame, Camera]]:
        """Place the next frame, or the next few."""
        piece, frames = self._piece, self._ahead[: self._stride]
        if piece is not None:
            seen = piece.follow(frames)
            if seen and self._has_cut_away(piece, frames[0], seen[0]):
                seen, piece.lost = [], PATIENCE
            if seen and piece.missed > FIND_EVERY:
                # Carried on through a dissolve, say: what is fixed to the ice is not it.
                house = self._find(frames[0])
                if house is not None:
                    return self._start(self._ahead.pop(0), house)
                if piece.missed > min(MOST_MISSED, _looked_back(self._size)):
                    seen, piece.lost = [], PATIENCE
            if seen:
                del self._ahead[: len(seen)]
                return self._taken(piece, frames[: len(seen)], seen)
            self._miss(piece)
        frame = self._ahead.pop(0)
        house = self._find(frame)
        if house is not None:
            return self._start(frame, house)
        self._waiting.append(frame)
        return []

    def _has_cut_away(self, piece: Piece, frame: Frame, seen: Seen) -> bool:
        """Whether a frame that a piece was lost before, or leapt to, is of something else."""
        if not (piece.lost or piece.leapt):
            return False
        return self._is_elsewhere(piece, glimpse(frame.picture, seen.view, piece.rig, frame.t))

    def _taken(
        self, piece: Piece, frames: Sequence[Frame], seen: Sequence[Seen]
    ) -> Sequence[tuple[Frame, Camera]]:
        """Take in frames that a piece has followed, or begin anew with a fuller house in them."""
        if piece.missed:  # they may be another's
            self._waiting.extend(frames)
        else:
            self._waiting.clear()
        other = self._fuller(piece, frames[-1], seen)
        if other is not None:
            self._pieces.remove(piece)
            self._piece = None
            self._waiting.extend([*piece.taken_back(), *frames[:-1]])
            return self._start(frames[-1], other)
        placed = piece.take(frames, seen)
        self._watch_for_cuts(piece)
        return placed

    def _miss(self, piece: Piece) -> None:
        """Count a frame into which a piece could not be followed; give it up after a while."""
        piece.lost += 1
        if piece.lost == 1:
            self._since_find = self._between = FIND_EVERY
        if piece.lost > PATIENCE:
            piece.give_up_missed()
            self._piece = None

    def _fuller(self, piece: Piece, frame: Frame, seen: Sequence[Seen]) -> HouseFit | None:
        """Look for a fuller house in the last frame that was followed, if that found is cut."""
        if not piece.second_look_due(len(seen)):
            return None
        before, piece.in_view = piece.in_view, 1.0
        camera = piece.camera(seen[-1])
        if _most_beside(camera) < before:
            return None
        house = find_house(image_of(frame.picture), frame=frame.index, t=frame.t)
        if house is None or float(house.evidence.visible[TWELVE]) < before + FULLER:
            return None
        tee = camera.ice(house.camera.project(np.zeros((1, 2))))
        return house if float(np.hypot(*tee[0])) > ELSEWHERE else None

    def _watch_for_cuts(self, piece: Piece) -> None:
        """End a piece that has been cut to a replay, or from one, without losing the house."""
        now = piece.glimpse_due()
        if now is None:
            return
        jumped = bool(piece.glimpses) and has_jumped(now, piece.glimpses[-1])
        like = [*piece.glimpses[:-1], *self._elsewhere(piece)]
        if jumped and self._is_elsewhere(piece, now) and piece.give_up_cut(like):
            self._piece = None
            self._since_find = self._between = FIND_EVERY
        else:
            piece.keep(now)

    def _is_elsewhere(self, piece: Piece, now: Glimpse) -> bool:
        """Whether a piece shows a replay now, or goes on with what was before a replay."""
        return is_replay(now, piece.glimpses) or (
            bool(piece.glimpses) and is_nearer(now, self._elsewhere(piece), piece.glimpses[-1])
        )

    def _elsewhere(self, piece: Piece) -> list[Glimpse]:
        """Give what the other pieces showed last."""
        return [p.glimpses[-1] for p in self._pieces if p is not piece and p.glimpses]

    def _find(self, frame: Frame) -> HouseFit | None:
        """Look for the house, now and then; the first is the one given, if one is."""
        if self._first is not None and not self._pieces:
            return self._first if frame.index == self._first.camera.frame else None
        self._since_find += 1
        if self._since_find < self._between:
            return None
        self._since_find, self._between = 0, min(self._between + 1, FIND_RARELY)
        # Not the frame's own picture in colour: that would be kept as long as the frame.
        return find_house(image_of(frame.picture), frame=frame.index, t=frame.t)

    def finish(self) -> HouseTrack | None:
        """Fit what all frames of the shot share; None where no house was seen."""
        self.catch_up()
        pieces = [p for p in self._pieces if p.found]
        if not pieces:
            return None
        if self._first is None:
            best, which = max(pieces, key=lambda p: p.found), "the longest"
        else:
            best, which = pieces[0], "the one given"
        best.relight()
        track = fit_clip(best.seen, best.rig, best.prior, self._size, best.edges.edge)
        left_out = *_left_out(best, pieces, which), *_unseen(pieces, self._looked)
        return replace(track, warnings=(*left_out, *track.warnings))

    def _start(self, frame: Frame, house: HouseFit) -> list[tuple[Frame, Camera]]:
        """Begin a piece, or go on with one that shows the same; then follow it back."""
        piece, view = self._same(house, frame)
        if piece is None:
            prior = house.prior.at_height(self._height)
            edges = EdgeTracker(self._size, house.evidence.palette, house.edge, house.evidence)
            # One that is asked for needs no second look.
            in_view = 1.0 if self._first is not None else float(house.evidence.visible[TWELVE])
            view, rig = house.view, house.rig
            if prior.height is not None:
                view, rig = at_height(house, prior)
            piece = Piece(self._size, rig, prior, edges, self._cache, house.vague, in_view)
            self._pieces.append(piece)
        if self._piece is not None and not (self._piece is piece and piece.goes_on_at(view)):
            self._piece.give_up_missed()
        self._piece = piece
        last = piece.seen[-1].index if piece.seen else -1
        waiting = [before for before in self._waiting if before.index > last]
        placed = piece.enter(frame, view, house.evidence.marks, waiting)
        self._waiting.clear()
        return placed

    def _same(self, house: HouseFit, frame: Frame) -> tuple[Piece | None, View]:
        """Find the piece whose camera explains a house as well, and its view in this frame.

        What that piece showed long before it was cut is shown again; it does not go on.
        """
        now = glimpse(frame.picture, house.view, house.rig, frame.t)
        for piece in self._pieces:
            if not piece.edges.looks_like(house.evidence.palette):
                continue
            if is_replay(now, piece.glimpses):
                continue
            view = piece.explains(house)
            if view is not None:
                return piece, view
        return None, house.view


def follow_house(
    video: Video,
    progress: Progress = no_progress,
    first: HouseFit | None = None,
    placed: Placed = nobody,
    height: float | None = None,
) -> HouseTrack:
    """Follow the house through a clip.

    Parameters
    ----------
    video : Video
        Read once, in order; a single picture is a clip of one frame.
    progress : Progress
    first, height : HouseFit, float, optional
        As for `HouseFollower`.
    placed : Placed
        Told of each frame that has a camera, and of the camera as it is known by then.

    Raises
    ------
    SceneError
        No house can be made out in any frame.
    """
    follower = HouseFollower(video.size, first, height)
    for frame in video:
        progress("house", video.decoded, video.expected)
        for seen, provisional in follower.look(frame):
            placed(seen, provisional)
    for seen, provisional in follower.catch_up():
        placed(seen, provisional)
    progress("camera", 0, 1)
    track = follower.finish()
    progress("camera", 1, 1)
    if track is None:
        raise SceneError(
            f"{video.files[0]}: no house in view (two of its circles must be visible); give its"
            " place with `house`, or for another scene with a fixed camera use `stick`"
        )
    return track


def _looked_back(size: tuple[int, int]) -> int:
    """How many pictures of a size, px, wait for the house to be found."""
    return min(LOOK_BACK, max(MOST_WAITING // (size[0] * size[1]), 1))


def _left_out(best: Piece, pieces: Sequence[Piece], which: str) -> tuple[str, ...]:
    if len(pieces) == 1:
        return ()
    others = ", ".join(_span(piece) for piece in pieces if piece is not best)
    return (
        f"the house is visible in {len(pieces)} separate parts; only {which} is used, frames"
        f" {_span(best)}; left out: {others}",
    )


def _unseen(pieces: Sequence[Piece], looked: Sequence[int]) -> tuple[str, ...]:
    """Say in which of the frames that were looked at the house is not followed."""
    seen = {s.index for piece in pieces for s in piece.seen}
    runs = [list(run) for known, run in groupby(looked, seen.__contains__) if not known]
    gaps = [_frames(run[0], run[-1]) for run in runs]
    if not gaps:
        return ()
    shown = gaps if len(gaps) <= MOST_SPANS else [*gaps[:MOST_SPANS], "…"]
    return (f"the house is not found in frames {', '.join(shown)}; they are left out",)


def _span(piece: Piece) -> str:
    return _frames(piece.seen[0].index, piece.seen[-1].index)


def _frames(first: int, last: int) -> str:
    return f"{first}" if first == last else f"{first} to {last}"


def _most_beside(camera: Camera) -> float:
    """Share of the 12-ft circle that the house of a sheet beside shows in a picture, at most."""
    angles = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    around = HOUSE.twelve_foot * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    pixels = camera.project(BESIDE[:, None] + around)
    return float(((pixels >= 0) & (pixels < camera.size)).all(-1).mean(1).max())
