"""Clips whose truth is known: render, write, and keep them on disk between test runs."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from curlshot.synthetic.camera import CameraPath, View
from curlshot.synthetic.ice import Picture
from curlshot.synthetic.people import hidden
from curlshot.synthetic.render import Studio, expose, in_cut, motion_of
from curlshot.synthetic.scene import Graphic, Scene
from curlshot.synthetic.video import on_ticks, write_video

Frames = Iterator[tuple[float, Picture]]

STATE = ("x", "y", "theta", "vx", "vy", "omega")


@dataclass(frozen=True)
class TrueHit:
    """One hit: time, the faster and the other stone, normal from one to the other, e.

    `before` and `after` hold (vx, vy, omega) of both stones; `position` holds their places.
    """

    t: float
    stones: tuple[str, str]
    normal: tuple[float, float]
    restitution: float
    before: tuple[tuple[float, float, float], tuple[float, float, float]]
    after: tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Truth:
    """All that is true of a clip.

    Attributes
    ----------
    tracks : DataFrame
        One row per stone and frame: stone, frame, t, x, y, theta, vx, vy, omega, and
        `visible`, the fraction of the cap that lies in the picture and under nothing.
    camera : DataFrame
        One row per frame: frame, t, h11 … h33 (ice metres to undistorted pixels, h33 = 1),
        k1, k2 (see `curlshot.synthetic.camera`), f_px, cam_x, cam_y, cam_z, and `main`, 0 while
        a cut shows something else.
    hits : tuple of TrueHit
        In order of time.
    friction : float
        Coefficient of the ice, at 1 m/s.
    size : tuple of int
        Width and height of the picture, px.
    fps : float
        Nominal frame rate, 1/s.
    """

    tracks: pd.DataFrame
    camera: pd.DataFrame
    hits: tuple[TrueHit, ...]
    friction: float
    size: tuple[int, int]
    fps: float


def frame_times(
    fps: float,
    duration: float,
    *,
    dropped: Sequence[int] = (),
    jitter: float = 0.0,
    rng: np.random.Generator | None = None,
) -> NDArray[np.float64]:
    """Return times of the frames, s: steady, less the dropped ones, moved by up to ± jitter frames.

    `rng` is needed for a jitter only.
    """
    index = np.arange(round(duration * fps), dtype=float)
    kept = np.delete(index, list(dropped))
    if jitter and rng is not None:
        kept[1:] += rng.uniform(-jitter, jitter, len(kept) - 1)
    return on_ticks(kept / fps)


def pictures(
    scene: Scene,
    camera: CameraPath,
    times: ArrayLike,
    *,
    shutter: float = 0.01,
    supersample: int = 1,
) -> Frames:
    """Render (t, BGR picture) at the times given, s; each exposed for `shutter` seconds."""
    moments = np.asarray(times, float)
    studio = Studio(scene, motion_of(scene, float(moments.max()) + 0.1), supersample)
    rng = np.random.default_rng([scene.seed, 2])
    for t in moments:
        yield float(t), expose(studio, camera, float(t), shutter, rng)


def render_still(
    scene: Scene,
    camera: CameraPath,
    t: float = 0.0,
    *,
    shutter: float = 0.01,
    supersample: int = 1,
) -> Picture:
    """One picture of the scene at time t, s; its truth is `describe(scene, camera, [t])`."""
    return next(pictures(scene, camera, [t], shutter=shutter, supersample=supersample))[1]


def describe(scene: Scene, camera: CameraPath, times: ArrayLike, *, fps: float = 25.0) -> Truth:
    """Return the truth of frames at these times, s, without rendering them."""
    moments = np.asarray(times, float)
    motion = motion_of(scene, float(moments.max()) + 0.1)
    rows, cameras = [], []
    for frame, t in enumerate(moments):
        cut = in_cut(scene, float(t))
        shown = camera if cut is None or cut.camera is None else cut.camera
        view = shown.at(float(t))
        cameras.append(
            (frame, t, *view.homography.ravel(), view.lens.k1, view.lens.k2, view.focal,
             *view.position, int(cut is None))
        )  # fmt: skip
        states = motion.at(float(t))
        seen = [0.0] * len(states) if cut is not None else _visible(scene, view, states, float(t))
        for stone, state, visible in zip(scene.stones, states, seen, strict=True):
            rows.append((stone.name, frame, t, *state, visible))
    tracks = pd.DataFrame(rows, columns=["stone", "frame", "t", *STATE, "visible"])
    names = [s.name for s in scene.stones]
    hits = tuple(
        TrueHit(
            h.t, (names[h.first], names[h.second]), h.normal, scene.impact.restitution, h.before,
            h.after,
        )
        for h in motion.hits
        if h.t <= moments.max()
    )  # fmt: skip
    homography = [f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]
    columns = ["frame", "t", *homography, "k1", "k2", "f_px", "cam_x", "cam_y", "cam_z", "main"]
    return Truth(
        tracks.sort_values(["stone", "frame"], ignore_index=True),
        pd.DataFrame(cameras, columns=columns),
        hits,
        scene.ice.friction(1.0),
        camera.size,
        fps,
    )


def render_clip(
    scene: Scene,
    camera: CameraPath,
    path: Path,
    *,
    fps: float = 25.0,
    duration: float = 6.0,
    times: ArrayLike | None = None,
    shutter: float = 0.01,
    crf: int = 21,
    supersample: int = 1,
    draw: Callable[..., Frames] = pictures,
    fields: bool = False,
) -> Truth:
    """Render a clip to `path` (MP4, H.264) and return its truth.

    Parameters
    ----------
    scene, camera : Scene, CameraPath
        What is seen, and by what; the camera's size is the clip's.
    path : Path
        File to write.
    fps, duration : float
        Rate, 1/s, and length, s.
    times : array-like, optional
        Times of the frames, s, instead of a steady rate: see `frame_times`.
    shutter : float
        Exposure, s; each frame's time is the middle of it.
    crf : int
        Compression of H.264, 0 to 51.
    supersample : int
        Render so many times larger: for tilts beyond some 30°.
    draw : callable
        The renderer: `pictures` or one of its form.
    fields : bool
        Encode the frames as interlaced ones: see `tests.synthetic.conversion.interlaced`.
    """
    moments = frame_times(fps, duration) if times is None else on_ticks(times)
    frames = draw(scene, camera, moments, shutter=shutter, supersample=supersample)
    write_video(path, frames, fps=fps, crf=crf, fields=fields)
    return describe(scene, camera, moments, fps=fps)


def cached_clip(
    scene: Scene,
    camera: CameraPath,
    *,
    fps: float = 25.0,
    duration: float = 6.0,
    times: ArrayLike | None = None,
    shutter: float = 0.01,
    crf: int = 21,
    supersample: int = 1,
    draw: Callable[..., Frames] = pictures,
    fields: bool = False,
) -> tuple[Path, Truth]:
    """As `render_clip`, but rendered once per machine: kept in the folder for temporary files.

    The key is made of the parameters and of the renderer's own source.
    """
    moments = frame_times(fps, duration) if times is None else on_ticks(times)
    how = (shutter, crf, supersample, draw.__name__, fields)
    what = (scene, camera, fps, moments.tolist(), how, _source())
    key = hashlib.sha256(repr(what).encode()).hexdigest()[:24]
    folder = Path(tempfile.gettempdir()) / "curlshot-clips"
    folder.mkdir(exist_ok=True)
    clip = folder / f"{key}.mp4"
    if not clip.exists():
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            fresh = Path(scratch) / clip.name
            truth = render_clip(
                scene, camera, fresh, fps=fps, times=moments, shutter=shutter, crf=crf,
                supersample=supersample, draw=draw, fields=fields,
            )  # fmt: skip
            fresh.replace(clip)
        return clip, truth
    return clip, describe(scene, camera, moments, fps=fps)


@cache
def _source() -> str:
    files = sorted(Path(__file__).parent.glob("[!t]*.py"))
    return hashlib.sha256(b"".join(f.read_bytes() for f in files)).hexdigest()


def _visible(scene: Scene, view: View, states: NDArray[np.float64], t: float) -> list[float]:
    """Return the part of each stone's cap that is seen."""
    radii, heights = (
        np.array([[getattr(stone, name)] for stone in scene.stones]).reshape(-1, 1)
        for name in ("cap_radius", "cap_height")
    )
    spread = radii * np.sqrt((np.arange(60) + 0.5) / 60)
    angles = np.arange(60) * np.pi * (3 - np.sqrt(5))
    x, y = states[:, :1] + spread * np.cos(angles), states[:, 1:2] + spread * np.sin(angles)
    discs = np.stack([x, y, np.broadcast_to(heights, x.shape)], axis=-1)
    undistorted, depth = view.pinhole(discs)
    off = np.abs(undistorted - view.lens.centre).max(axis=(1, 2), initial=0.0)
    near = (depth >= 0.5).all(-1) & (off <= np.hypot(*view.lens.size))
    pixels = view.lens.distort(undistorted[near])
    w, h = view.lens.size
    seen = ((pixels >= -0.5) & (pixels <= [w - 0.5, h - 0.5])).all(-1)
    seen &= ~hidden(view, scene.people, t, pixels)
    for graphic in scene.graphics:
        seen &= ~_under(graphic, pixels)
    visible = np.zeros(len(states))
    visible[near] = seen.mean(-1)
    return [float(share) for share in visible]


def _under(graphic: Graphic, pixels: NDArray[np.float64]) -> NDArray[np.bool_]:
    right = graphic.x + 6 * graphic.row
    bottom = graphic.y + len(graphic.rows) * graphic.row
    low = (pixels >= [graphic.x, graphic.y]).all(-1)
    return np.asarray(low & (pixels < [right, bottom]).all(-1))
