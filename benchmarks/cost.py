"""What tracking costs: ``python -m benchmarks.cost [CLIP.mp4 ...]`` from the root.

CPU time, all threads, of the whole of ``curlshot track`` against that of decoding the same clip
with OpenCV alone, in the same run: of either as a process of its own, with the start of Python
and the most memory held, and within one, with its parts. Without a clip, one is rendered: 12 s of
1080 lines with eight stones, two sweepers and a camera that pans and zooms. What memory longer
clips take is told by ``--lengths``: of it, and of it with its last second, in which all is at rest
but the camera, shown backwards and forwards again and again.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from itertools import cycle, islice
from pathlib import Path
from pkgutil import resolve_name
from typing import Any
from unittest import mock

import cv2
import numpy as np
import pandas as pd

from curlshot.cli.threads import LIMITS, use_one_thread
from curlshot.report.encode import Encoder
from curlshot.synthetic.camera import broadcast_camera
from curlshot.synthetic.clip import cached_clip
from curlshot.synthetic.scenes import random_scene, sweepers
from curlshot.vision.video.picture import Image
from curlshot.vision.video.reader import open_video

FPS = 30.0

PARTS = {
    "camera, frame by frame": "curlshot.vision.camera_path.follow_house.HouseFollower.look",
    "camera, in the end": "curlshot.vision.camera_path.follow_house.HouseFollower.finish",
    "stones, frame by frame": "curlshot.vision.association.watch.Watch.look",
    "stones, placed in the end": "curlshot.vision.association.watch.Watch.finish",
    "association": "curlshot.vision.track.follow",
    "angles": "curlshot.vision.track.angles_in_parts",
    "hits": "curlshot.physics.local_fit.hit_detection.detect_hits",
    "filter": "curlshot.physics.kalman.smoothed",
}
"""Parts of the work and the functions that do it; none calls another."""

DECODE = """
import sys, cv2
capture = cv2.VideoCapture(sys.argv[1])
while capture.read()[0]:
    pass
"""

TRACK = """
import sys
from curlshot import pipeline
assert main(["track", *sys.argv[1:]]) == 0
"""

HELD = """
print(next(line for line in open("/proc/self/status") if "VmHWM" in line).split()[1])
"""
"""Tells the most memory that was held, kB; what rusage tells may be that of who asks."""


def long_clip(duration: float = 12.0) -> Path:
    scene = random_scene(np.random.default_rng(11), resting=7)
    scene = replace(scene, people=sweepers(scene, duration))
    view = broadcast_camera(size=(1920, 1080), end=6.0, px_per_m=(190.0, 147.0))
    return cached_clip(scene, view, fps=FPS, duration=duration)[0]


def lengthened(clip: Path, frames: int, path: Path) -> None:
    """Write a clip of so many frames: another, then its last second backwards and forwards."""
    source, count = open_video([clip]), 0
    last: deque[Image] = deque(maxlen=round(FPS))
    with Encoder(path, source.size, FPS) as film:
        for count, frame in enumerate(islice(source, frames), 1):
            film.add(frame.image, (count - 1) / FPS)
            last.append(frame.image)
        sway = cycle([*reversed(last)][1:] + [*last][1:])
        for index, image in zip(range(count, frames), sway, strict=False):
            film.add(image, index / FPS)


def lengths(counts: Sequence[int] = (360, 3600, 9000)) -> pd.DataFrame:
    """Tell the most memory, MB, and the time that clips of so many frames take."""
    clip, rows = long_clip(), []
    with tempfile.TemporaryDirectory() as folder:
        for frames in counts:
            path = Path(folder) / f"{frames}.mp4"
            lengthened(clip, frames, path)
            seconds, held = tracked(path)
            rows.append({"frames": frames, "MB": held, "ms/frame": 1e3 * seconds / frames})
    return pd.DataFrame(rows).round(1)


def process(code: str, *arguments: str) -> tuple[float, float]:
    """CPU time of a process of Python, s, and the most memory that it held, MB (Linux)."""
    command = [sys.executable, "-c", code + HELD, *arguments]
    # As whoever has installed it runs it: with bytecode that is kept from run to run.
    left_out = {*LIMITS, "PYTHONDONTWRITEBYTECODE"}
    clean = {name: value for name, value in os.environ.items() if name not in left_out}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=clean) as child:
        assert child.stdout is not None
        told = child.stdout.read()
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    assert child.returncode == 0
    return used.ru_utime + used.ru_stime, int(told.split()[-1]) / 1024


def tracked(clip: Path) -> tuple[float, float]:
    """As `process`, of ``curlshot track``."""
    with tempfile.TemporaryDirectory() as folder:
        return process(TRACK, str(clip), "-q", "-o", folder)


def decoded(clip: Path) -> int:
    """Decode a clip with OpenCV and do nothing with it; the number of frames."""
    capture, frames = cv2.VideoCapture(str(clip)), 0
    while capture.read()[0]:
        frames += 1
    capture.release()
    return frames


@contextmanager
def timed(spent: dict[str, float]) -> Iterator[None]:
    """Add up the CPU time spent in each of the parts, s, while others decode what comes next."""

    def watched(part: str, work: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any, **kwargs: Any) -> Any:
            start = time.thread_time()
            try:
                return work(*args, **kwargs)
            finally:
                spent[part] += time.thread_time() - start

        return call

    with ExitStack() as stack:
        for part, name in PARTS.items():
            stack.enter_context(mock.patch(name, watched(part, resolve_name(name))))
        yield


def whole(clip: Path, repeats: int) -> pd.DataFrame:
    """Time both as processes of their own, in turn."""
    runs = [(*process(DECODE, str(clip)), *tracked(clip)) for _ in range(repeats)]
    alone, alone_mb, whole, whole_mb = np.min(runs, axis=0)
    table = pd.DataFrame({"s": [alone, whole], "MB": [alone_mb, whole_mb]})
    table.index = pd.Index(["process: decoding by OpenCV", "process: curlshot track"])
    return table


def parts(clip: Path, repeats: int) -> pd.DataFrame:
    """Time all of it a few times; of each part the least, for the machine may be busy."""
    runs: list[dict[str, float]] = []
    for _ in range(repeats):
        spent: dict[str, float] = defaultdict(float)
        start = time.process_time()
        decoded(clip)
        alone = time.process_time() - start
        with tempfile.TemporaryDirectory() as folder, timed(spent):
            start = time.process_time()
            code = main(["track", str(clip), "-q", "-o", folder])
            whole = time.process_time() - start
        assert code == 0
        parts = {**spent, "decoding, tables, the rest": whole - sum(spent.values())}
        runs.append({"decoding by OpenCV": alone, "curlshot track": whole, **parts})
    return pd.DataFrame(runs).min().to_frame("s")


def relative(table: pd.DataFrame, frames: int) -> pd.DataFrame:
    """Add the time per frame, and that of the first row's."""
    table.insert(1, "ms/frame", 1e3 * table["s"] / frames)
    table.insert(2, "times decoding", table["s"] / table["s"].iloc[0])
    return table.round(2).fillna("")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="*", type=Path)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--lengths", action="store_true", help="memory by length of the clip only")
    arguments = parser.parse_args()
    if arguments.lengths:
        print(lengths().to_string(index=False))
        return
    if not os.environ.keys() >= {*LIMITS}:
        # The command sees to that before it loads libraries; here they are loaded by now.
        use_one_thread()
        os.execv(sys.executable, sys.orig_argv)
    for clip in arguments.clips or [long_clip()]:
        frames = decoded(clip)  # from now on the file is at hand
        print(clip)
        for table in (whole(clip, arguments.repeats), parts(clip, arguments.repeats)):
            print(relative(table, frames).to_string())


if __name__ == "__main__":
    main()
