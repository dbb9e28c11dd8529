"""What tracking costs: ``python -m benchmarks.cost [CLIP.mp4 ...]`` from the root.

CPU time, all threads, of the whole of ``curlshot track`` against that of decoding the same clip
with OpenCV alone, in the same run, with its parts and the most memory held. Without a clip, one
is rendered: 12 s of 1080 lines with eight stones, two sweepers and a camera that pans and zooms.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from pkgutil import resolve_name
from typing import Any
from unittest import mock

import cv2
import numpy as np
import pandas as pd

import pipeline
from tests.synthetic.camera import broadcast_camera
from tests.synthetic.clip import cached_clip
from tests.synthetic.scenes import random_scene, sweepers

PARTS = {
    "camera, frame by frame": "vision.follow_house.HouseFollower.look",
    "camera, in the end": "vision.follow_house.HouseFollower.finish",
    "stones, frame by frame": "vision.watch.Watch.look",
    "stones, placed in the end": "vision.watch.Watch.finish",
    "association": "vision.track.follow",
    "angles": "vision.track.handle_angles",
    "hits": "physics.contacts.find_contacts",
    "filter": "physics.kalman.smooth",
}
"""Parts of the work and the functions that do it; none calls another."""


def long_clip() -> Path:
    scene = random_scene(np.random.default_rng(11), resting=7)
    scene = replace(scene, people=sweepers(scene, 12.0))
    view = broadcast_camera(size=(1920, 1080), end=6.0, px_per_m=(190.0, 147.0))
    return cached_clip(scene, view, fps=30.0, duration=12.0)[0]


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


def rows(clip: Path, repeats: int) -> pd.DataFrame:
    """Time all of it a few times; of each part the least, for the machine may be busy."""
    runs: list[dict[str, float]] = []
    for _ in range(repeats):
        spent: dict[str, float] = defaultdict(float)
        start = time.process_time()
        frames = decoded(clip)
        alone = time.process_time() - start
        with tempfile.TemporaryDirectory() as folder, timed(spent):
            start = time.process_time()
            code = pipeline.main(["track", str(clip), "-q", "-o", folder])
            whole = time.process_time() - start
        assert code == 0
        parts = {**spent, "decoding, tables, the rest": whole - sum(spent.values())}
        runs.append({"decoding by OpenCV alone": alone, "curlshot track": whole, **parts})
    table = pd.DataFrame(runs).min().to_frame("s")
    table["ms/frame"] = 1e3 * table["s"] / frames
    table["times decoding"] = table["s"] / table["s"].iloc[0]
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="*", type=Path)
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    for clip in arguments.clips or [long_clip()]:
        decoded(clip)  # from now on the file is at hand
        print(clip)
        print(rows(clip, arguments.repeats).round(2).to_string())
    held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{held:.0f} MB at most")


if __name__ == "__main__":
    main()
