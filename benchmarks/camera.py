"""How well the ice is measured, and at what cost: one table of all that the camera must do.

    python -m benchmarks.camera [SHARED] [--kinds NAME ...] [--size 720 1080]
        [--seeds N ...] [--repeat N]

Rendered clips with truth (`curlshot.benchmarks.views`): ice points of the house, seen at their true
pixels, mapped to the ice by the camera found; in mm. Then real stills and real ice set in motion
(`curlshot.benchmarks.stills`), where SHARED is there. A figure with a ! misses its bar.

Columns: `rms`, `95 %`, `max` of points in the house; `high` the rms of points 0.12 m above it;
`guards` that of the ice 4 to 6 m before the tee; `carried` that of points in the house where the
frame itself fixed no camera; `first` that of the first single frame; `lost` frames without a
camera of those that show a third of the 12-ft circle, and + those of them only carried; `in 2 sd`
the share of errors per axis within two stated standard errors, and their rms over the stated;
`ms` CPU a frame beyond decoding and one find, `read` that of decoding, `find` CPU of one find;
with --repeat the least of so many runs.
With --parts the rms of the error's parts: shift, turn and scale (at the rim), and the rest.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.benchmarks import stills
from curlshot.benchmarks.camera_scores import HEAD, Score, line, rms, summary
from curlshot.benchmarks.drawn_views import named
from curlshot.benchmarks.views import HEIGHT, Clip, enlarged
from curlshot.data.sheet import HOUSE, STONE
from curlshot.synthetic import View
from curlshot.synthetic.people import hidden
from curlshot.vision.camera_path.follow_house import HouseFollower
from curlshot.vision.optics.camera import Camera
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit
from curlshot.vision.video.reader import open_video

Array = NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[1]
SHARE = 1 / 3
"""Part of the 12-ft circle that must do to keep the house."""

_AXIS = np.arange(-1.8, 1.81, 0.15)
GRID = np.stack(np.meshgrid(_AXIS, _AXIS), axis=-1).reshape(-1, 2)
GRID = GRID[np.hypot(*GRID.T) <= HOUSE.twelve_foot]
GUARDS = np.stack(np.meshgrid([-1.0, -0.5, 0, 0.5, 1.0], [4.0, 4.5, 5.0, 5.5, 6.0]), -1)
GUARDS = GUARDS.reshape(-1, 2)
_ANGLE = np.linspace(0, 2 * np.pi, 360, endpoint=False)
RIM = HOUSE.twelve_foot * np.stack([np.cos(_ANGLE), np.sin(_ANGLE)], axis=-1)


def in_view(view: View, places: Array, height: float = 0.0) -> tuple[Array, Array]:
    """Pick the places that the picture shows, and tell their pixels."""
    points = np.column_stack([places, np.full(len(places), height)])
    pixels, depth = view.pinhole(points)
    near = (depth > 0.2) & (np.abs(pixels - view.lens.centre) < 2 * view.lens.size[0]).all(-1)
    pixels = view.lens.distort(np.where(near[:, None], pixels, view.lens.centre))
    seen = near & ((pixels >= 0) & (pixels <= np.array(view.lens.size) - 1)).all(-1)
    return places[seen], pixels[seen]


def shown_share(clip: Clip, view: View, t: float) -> float:
    """Part of the 12-ft circle that is in the picture and under nobody."""
    _, pixels = in_view(view, RIM)
    return float((~hidden(view, clip.scene.people, t, pixels)).sum()) / len(RIM)


def parts(places: Array, error: Array) -> Array:
    """Shift, turn and scale of errors (the last two at the rim) and the rest, rms, m."""
    one, none = np.ones(len(places)), np.zeros(len(places))
    x, y = (places / HOUSE.twelve_foot).T
    design = np.concatenate(
        [np.stack([one, none, -y, x], axis=-1), np.stack([none, one, x, y], axis=-1)]
    )
    known, *_ = np.linalg.lstsq(design, error.T.ravel(), rcond=None)
    rest = error.T.ravel() - design @ known
    return np.array(
        [np.hypot(*known[:2]), *np.abs(known[2:]), np.sqrt(2 * np.mean(rest**2))], float
    )


def stated_sd(camera: Camera, places: Array) -> Array:
    """Stated standard error along x and y of each place, shape (n, 2), m."""
    return np.asarray(np.sqrt(np.diagonal(camera.place_cov(places), axis1=-2, axis2=-1)))


def longest_shot(main: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Find the longest run of frames that show the scene itself."""
    label = np.cumsum(np.diff(main.astype(int), prepend=0) != 0) * main
    return np.asarray(main & (label == np.bincount(label[main]).argmax()))


def least_time(work: Callable[[], HouseFit | None], repeat: int) -> tuple[HouseFit | None, float]:
    """Do the same several times; what comes of it, and the least CPU time, s."""
    least, found = np.inf, None
    for _ in range(repeat):
        start = time.thread_time()
        found = work()
        least = min(least, time.thread_time() - start)
    return found, least


def followed(path: Path) -> tuple[tuple[Camera, ...], float]:
    """Follow the house through a clip: cameras, and CPU time, s.

    That of this thread alone: decoding goes on in others.
    """
    clip = open_video([path])
    follower, spent = HouseFollower(clip.size), 0.0
    for frame in clip:
        start = time.thread_time()
        follower.look(frame)
        spent += time.thread_time() - start
    start = time.thread_time()
    track = follower.finish()
    spent += time.thread_time() - start
    return () if track is None else track.cameras, spent


def measure(clip: Clip, height: int, repeat: int = 1) -> Score:
    """Follow the house through a clip and compare every frame's camera with the true one."""
    path, truth = clip.render(height)
    films = enlarged(clip.camera, height / HEIGHT)
    score = Score(clip, len(truth.camera))
    start = time.process_time()
    pictures = [frame.image for frame in open_video([path]) if frame.index == 0]
    decoding = time.process_time() - start
    main = truth.camera["main"].to_numpy() == 1
    due = longest_shot(main)
    times = truth.camera["t"].to_numpy()
    shares = np.array([shown_share(clip, films.at(float(t)), float(t)) for t in times])
    due &= shares >= SHARE
    score.due = int(due.sum())
    fit, score.finding = least_time(lambda: find_house(pictures[0]), repeat)
    if fit is not None:
        places, pixels = in_view(films.at(0.0), GRID)
        score.first = rms([fit.camera.ice(pixels) - places])
    runs = [followed(path) for _ in range(repeat)]
    spent = min(seconds for _, seconds in runs) - score.finding
    score.following, score.decoding = spent / score.frames, decoding / score.frames
    cameras = runs[0][0]
    known = {c.frame: c for c in cameras}
    for frame in np.flatnonzero(due):
        score.lost += frame not in known
        score.only_carried += frame in known and not known[int(frame)].found
    for camera in cameras:
        if main[camera.frame]:
            compare(score, camera, films.at(float(times[camera.frame])))
        else:
            score.false += 1
    return score


def compare(score: Score, camera: Camera, true: View) -> None:
    """Add the errors of one frame's camera."""
    places, pixels = in_view(true, GRID)
    guards, seen = in_view(true, GUARDS)
    if len(guards):
        score.guards.append(camera.ice(seen) - guards)
    if len(places) < 3:
        return
    error = camera.ice(pixels) - places
    (score.house if camera.found else score.carried).append(error)
    with np.errstate(divide="ignore"):
        score.scaled.append(error / stated_sd(camera, places))
    if camera.found:
        score.parts.append(parts(places, error))
        places, pixels = in_view(true, GRID, STONE.cap_height)
        score.high.append(camera.ice(pixels, STONE.cap_height) - places)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("shared", type=Path, nargs="?", default=ROOT.parent / "shared")
    parser.add_argument("--kinds", nargs="+", default=[], help="only clips whose names begin so")
    parser.add_argument("--size", nargs="+", type=int, default=[720, 1080], choices=[720, 1080])
    parser.add_argument("--seeds", nargs="*", type=int, default=range(4), help="of random clips")
    parser.add_argument("--repeat", type=int, default=1, help="runs of which the fastest counts")
    parser.add_argument("--parts", action="store_true", help="split the errors")
    parser.add_argument("--no-stills", action="store_true", help="rendered clips only")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    for height in options.size:
        print(f"\nRendered at {height} lines; errors in mm\n{HEAD}", flush=True)
        scores = []
        for clip in named(options.kinds, options.seeds):
            scores.append(measure(clip, height, options.repeat))
            print(line(scores[-1], options.parts), flush=True)
        if scores:
            print(summary(scores), flush=True)
    if options.shared.exists() and not options.no_stills and not options.kinds:
        print()
        stills.score(options.shared)


if __name__ == "__main__":
    main()
