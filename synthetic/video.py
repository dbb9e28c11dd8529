"""H.264 with exact presentation times: steady, varying or broken frame rates."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import ArrayLike, NDArray

TICK = Fraction(1, 90_000)


def on_ticks(times: ArrayLike) -> NDArray[np.float64]:
    """Return times, s, rounded to what the container can hold."""
    return np.round(np.asarray(times, float) / float(TICK)) * float(TICK)


def write_video(
    path: Path,
    frames: Iterable[tuple[float, NDArray[np.uint8]]],
    *,
    fps: float,
    crf: int = 21,
    fields: bool = False,
) -> None:
    """Write (time in s, BGR picture) pairs as an MP4 file of H.264.

    Parameters
    ----------
    path : Path
        File to write.
    frames : iterable of (float, ndarray)
        Times must rise; pictures have even width and height.
    fps : float
        Nominal rate, 1/s; the times are what counts.
    crf : int
        Compression, 0 (none) to 51.
    fields : bool
        Encode pictures as interlaced ones, whose lower lines were taken first.
    """
    # The index first: then a copy that breaks off can be read as far as it goes.
    with av.open(str(path), "w", options={"movflags": "+faststart"}) as container:
        stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1001))
        stream.pix_fmt = "yuv420p"
        stream.options = {"crf": str(crf), "preset": "veryfast", "threads": "1"}
        if fields:
            stream.options = {**stream.options, "x264-params": "bff=1"}
        stream.codec_context.time_base = TICK
        for t, picture in frames:
            if not stream.codec_context.is_open:
                stream.height, stream.width = picture.shape[:2]
            frame = av.VideoFrame.from_ndarray(picture, format="bgr24")
            frame.time_base = TICK
            frame.pts = round(t / float(TICK))
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
