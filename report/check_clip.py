"""Check a clip: follow the camera, look for stones in a few frames, and show both."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from curlshot.config import Config, with_settings
from curlshot.data.arguments import checked_paths
from curlshot.data.inputs import find_inputs
from curlshot.data.progress import Progress, no_progress
from curlshot.report.check import check_figure
from curlshot.report.looks import Look, check_lines, check_table, frames_to_show
from curlshot.vision.detection.glance import glance
from curlshot.vision.detection.stones import Search
from curlshot.vision.measure import track_camera
from curlshot.vision.video.reader import open_video


def check(
    inputs: str | Path | Sequence[str | Path],
    config: Config = Config(),
    progress: Progress = no_progress,
    **settings: Any,
) -> tuple[Figure, list[str]]:
    """Follow the camera and look for stones in a few frames, for a person to judge.

    Parameters
    ----------
    inputs : str or Path, or sequence of them
        A video or pictures.
    config, **settings
        What is known of the clip, as for `curlshot.run`.
    progress : callable
        Called as the work goes on.

    Returns
    -------
    Figure
        The contact sheet (see `curlshot.report.check.check_figure`).
    list of str
        The same in a few lines.

    Raises
    ------
    curlshot.data.errors.CurlshotError
        Where the input cannot be used; one line says why.

    Examples
    --------
    >>> import curlshot
    >>> figure, lines = curlshot.check(curlshot.sample_clip(), frames=(0, 0))
    >>> lines[0]
    'input       sample.mp4: 1 frame'
    >>> figure.savefig("check.png")
    """
    config = with_settings(config, settings)
    files = find_inputs(checked_paths("inputs", inputs))
    video = open_video(files, config.video)
    seen = track_camera(video, config, progress)
    cameras = seen.cameras
    radii = () if seen.house is None else seen.house.painted
    table = check_table(cameras, radii[0] if radii else 0.0)
    by_frame = {camera.frame: camera for camera in cameras}
    chosen = frozenset(frames_to_show(table))
    frames = []
    for done, frame in enumerate(video, 1):
        if frame.index in chosen:
            frames.append(frame)
        progress("frames to show", done, video.expected)
    placed = [(frame.image, by_frame[frame.index]) for frame in frames]
    stones = glance(placed, seen.disc, Search.of(config.search))
    looks = [
        Look(frame, by_frame[frame.index], found.stones, found.refused)
        for frame, found in zip(frames, stones, strict=True)
    ]
    lines = check_lines(files[0].name, video.read, table, looks, (*video.warnings, *seen.warnings))
    title = f"{files[0].name}: {' '.join(lines[1].split())}"
    radius = config.stones.radius
    return check_figure(looks, table, radii, title=title, radius=radius), lines
