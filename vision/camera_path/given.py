"""The house as a person gives it: the tee and two points of the 12-ft circle in one frame.

Three points leave open from where the camera looks: every foreshortening in which the two points
lie at one distance from the tee, about as well as a hand can point, is a hypothesis. Where the
edges bear one of them out, it is refined on them and followed as if it had been found. Where they
do not, the simplest stands as it is, y up in the picture, for all frames that show the same
picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import HOUSE
from curlshot.vision.camera_path.follow_house import follow_house
from curlshot.vision.camera_path.joint import HouseTrack, Seen, fit_clip
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.paint import TWELVE, Marks, fixed, joined
from curlshot.vision.optics.placed import Placed, nobody
from curlshot.vision.optics.pose import View, camera
from curlshot.vision.sheet.house import fit_house
from curlshot.vision.sheet.house_fit import HouseFit, start
from curlshot.vision.sheet.lines import y_up
from curlshot.vision.sheet.rings import SQUASHES, Guess
from curlshot.vision.video.disk_cache import Cached
from curlshot.vision.video.flow import similarity
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Image
from curlshot.vision.video.reader import Video

Array = NDArray[np.float64]

FROM_BESIDE = [(squash, turn) for squash in (0.85, 0.7, 0.5) for turn in (-np.pi / 2, np.pi / 2)]
"""Foreshortenings, as `SQUASHES`, of a house that the camera sees from across the sheet."""

CLICK_SD = 0.002
"""How well a hand points at a place, as a fraction of the picture's width."""

SMALLEST = 0.02
"""Least distance of a point on the circle from the tee, as a fraction of the picture's width."""

UNEQUAL = 0.2
"""Difference of the two distances, logarithm, that no camera above the ice explains."""

AWAY = 0.25
"""How far the edges may lead away from the points given, m."""

STILL = 0.004
"""Shift of the picture up to which it is the same, as a fraction of its width."""


@dataclass(frozen=True)
class GivenHouse:
    """A house given by hand.

    Attributes
    ----------
    tee : ndarray, shape (2,)
        Centre of the house, px.
    ring : ndarray, shape (2, 2)
        Two points of the outer edge of the 12-ft circle, px.
    frame : int, optional
        Index of the frame in which they are so; the first of the clip if not given.
    """

    tee: Array
    ring: Array
    frame: int | None = None

    @classmethod
    def of(cls, points: Sequence[float], frame: int | None = None) -> GivenHouse:
        """Make it of the coordinates of the tee and of the two points, px."""
        tee, *ring = np.reshape(np.asarray(points, float), (3, 2))
        return cls(tee, np.array(ring), frame)

    def __str__(self) -> str:
        """Write it as on the command line."""
        numbers = ",".join(f"{value:g}" for value in (*self.tee, *self.ring.ravel()))
        return numbers if self.frame is None else f"{self.frame}:{numbers}"


def follow_given(
    video: Video,
    house: GivenHouse,
    progress: Progress = no_progress,
    placed: Placed = nobody,
    height: float | None = None,
) -> HouseTrack:
    """Follow the house through a clip from where a person says that it is.

    `placed` is told of each frame and its camera, which may be provisional; `height` is how high
    that hangs, m, where a person says it.

    Raises
    ------
    InputError
        Points that cannot be those of a house, or a frame that the clip does not have.
    """
    frame = _frame(video, house)
    fit = fit_given(frame.image, house, frame=frame.index, t=frame.t)
    if fit is None:
        return _as_given(video, frame, house, progress, placed, height)
    return follow_house(video, progress, fit, placed, height)


def hypotheses(house: GivenHouse, size: tuple[int, int]) -> list[Guess]:
    """Give the houses that three points may be of, px: the simplest first.

    Parameters
    ----------
    house : GivenHouse
    size : tuple of int
        Width and height of the picture, px.

    Raises
    ------
    InputError
        Points beside the picture, too near the tee, or at distances from it that differ by more
        than a view from above the ice explains.
    """
    points = np.vstack([house.tee, house.ring])
    reach = np.linalg.norm(house.ring - house.tee, axis=1)
    if not np.isfinite(points).all() or np.abs(points).max() > 10 * max(size):
        raise InputError(f"house {house}: outside a frame of {size[0]} × {size[1]} px")
    if reach.min() < SMALLEST * size[0]:
        raise InputError(
            f"house {house}: the two points on the 12-ft circle must be at least"
            f" {SMALLEST * size[0]:.0f} px from the tee"
        )
    found = []
    for squash, lean in (*SQUASHES, *FROM_BESIDE):
        guess = Guess(house.tee, float(reach.mean()) / HOUSE.twelve_foot, squash, lean, 0.0)
        for _ in range(3):  # its scale follows from the distance of the two points from the tee
            away = np.linalg.norm(_camera(guess, size).ice(house.ring), axis=1)
            stretch = float(np.exp(np.log(away).mean())) / HOUSE.twelve_foot
            guess = replace(guess, scale=guess.scale * stretch)
        found.append((abs(float(np.log(away[0] / away[1]))), guess))
    best = min(unequal for unequal, _ in found)
    if not best < UNEQUAL:
        raise InputError(
            f"house {house}: of two points on one circle, one is {reach.max() / reach.min():.1f}"
            " times as far from the tee as the other"
        )
    unsure = 3 * CLICK_SD * size[0] * float(np.hypot(*(1 / reach)))
    return [guess for unequal, guess in found if unequal <= best + unsure]


def fit_given(
    image: Image, house: GivenHouse, *, frame: int = 0, t: float = 0.0
) -> HouseFit | None:
    """Refine a given house on the edges of its picture; None where they do not bear it out.

    Raises
    ------
    InputError
        As `hypotheses`.
    """
    size = (image.shape[1], image.shape[0])
    fit = fit_house(image, hypotheses(house, size), frame=frame, t=t)
    if fit is None:
        return None
    tee, *ring = np.linalg.norm(fit.camera.ice(np.vstack([house.tee, house.ring])), axis=1)
    off = max(float(tee), *(abs(float(r) - HOUSE.twelve_foot) for r in ring))
    return fit if off < AWAY else None


def _frame(video: Video, house: GivenHouse) -> Frame:
    shown = None
    for frame in video:
        if house.frame is None or frame.index == house.frame:
            return frame
        if shown is not None and house.frame in video.duplicates:
            return shown
        shown = frame
    if shown is not None and house.frame in video.duplicates:
        return shown
    if house.frame is None:
        raise InputError(f"{video.files[0]}: none of the selected frames can be read")
    raise InputError(
        f"house {house}: frame {house.frame} is not among the selected frames of"
        f" {video.files[0].name}, {video.first} to {video.first + video.expected - 1}"
    )


def _camera(guess: Guess, size: tuple[int, int]) -> Camera:
    view, rig, _ = start(guess, size)
    return camera(view, rig, size)


def _as_given(
    video: Video,
    frame: Frame,
    house: GivenHouse,
    progress: Progress,
    placed: Placed,
    height: float | None,
) -> HouseTrack:
    """Take the three points for what they are, in all frames that show the same picture."""
    guess = hypotheses(house, video.size)[0]
    view, rig, prior = start(guess, video.size)
    view, rig = y_up(view, rig, video.size)
    marks = _marks(house, view, rig, video.size)
    seen = [Seen(frame.index, frame.t, view, Cached(marks), True)]
    track = fit_clip(seen, rig, prior.at_height(height), video.size)
    given = replace(track.cameras[0], rms_px=float("nan"), quality=0.0)
    cameras = []
    for done, other in enumerate(video, 1):
        if other.index == frame.index:
            cameras.append(given)
            placed(other, cameras[-1])
        elif _same(frame.image, other.image):
            cameras.append(replace(given, frame=other.index, t=other.t, found=False))
            placed(other, cameras[-1])
        progress("camera", done, video.expected)
    note = (
        f"house {house}: no rings found there; the camera is set by the three points alone, with"
        " y up in the frame"
    )
    if len(cameras) < video.read:
        note += f", and only the {len(cameras)} frames with the same image are used"
    return replace(track, cameras=tuple(cameras), warnings=(note, *track.warnings))


def _marks(house: GivenHouse, view: View, rig: Array, size: tuple[int, int]) -> Marks:
    """Write the three points as marks, each as well known as a hand points."""
    sd = CLICK_SD * size[0]
    seen = camera(view, rig, size)
    x, y = seen.ice(house.ring).T
    along = np.arctan2(y, x)
    ends = np.array([-1e-3, 1e-3])[:, None] + along
    one, two = seen.project(HOUSE.twelve_foot * np.stack([np.cos(ends), np.sin(ends)], axis=-1))
    normal = (two - one)[:, ::-1] * [1.0, -1.0]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    ring = Marks(np.full(2, TWELVE), along, house.ring, normal, np.full(2, sd))
    return joined([fixed(np.zeros((1, 2)), house.tee[None], sd), ring])


def _same(one: Image, two: Image) -> bool:
    """Whether two pictures show the same scene from the same view."""
    matrix = similarity(one, two)
    if matrix is None:
        return False
    h, w = one.shape[:2]
    corners = np.array([[0, 0], [w, 0], [0, h], [w, h]], float)
    shift = corners @ matrix[:, :2].T + matrix[:, 2] - corners
    return bool(np.abs(shift).max() < STILL * w)
