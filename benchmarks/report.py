"""CPU time of the report and of the annotated clip, against that of the tracking itself.

Run with ``python -m benchmarks.report [CLIP]``; the sample clip if none is named.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2

from curlshot import pipeline
from curlshot.report.overlay import write_overlay
from curlshot.report.page import write_report
from curlshot.vision.optics.camera import camera_table


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    start = time.process_time()
    value = work()
    return value, time.process_time() - start


def main(clip: Path, folder: Path) -> None:
    cv2.setNumThreads(1)
    measured, tracking = timed(lambda: pipeline.measure([clip]))
    done = pipeline.analyse(measured)
    assert measured.clip is not None
    house = measured.house
    _, overlay = timed(
        lambda: write_overlay(
            measured.clip,  # type: ignore[arg-type]
            measured.cameras,
            done.tracks,
            done.results.collisions,
            folder / "overlay.mp4",
            radius=done.results.radius,
        )
    )
    path, page = timed(
        lambda: write_report(
            folder,
            results=done.results,
            tracks=done.tracks,
            simulations={str(m): table for m, table in done.simulations.groupby("model")},
            cameras=camera_table(measured.cameras),
            overlay=folder / "overlay.mp4",
            house=house,
        )
    )
    frames = measured.frames
    width, height = measured.clip.whole_size
    print(f"{clip.name}: {frames} frames of {width} x {height}")
    for name, seconds in (("tracking", tracking), ("overlay", overlay), ("report", page)):
        print(f"{name:<10s} {seconds:6.2f} s CPU   {1000 * seconds / frames:6.1f} ms a frame")
    print(f"overlay costs {overlay / tracking:.2f} of the tracking")
    print(f"overlay.mp4 {(folder / 'overlay.mp4').stat().st_size / 1e6:.2f} MB")
    print(f"report.html {path.stat().st_size / 1e6:.2f} MB (3 allowed)")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("clip", nargs="?", type=Path, default=pipeline.sample_clip())
    named = parser.parse_args().clip
    with tempfile.TemporaryDirectory() as out:
        main(named, Path(out))
