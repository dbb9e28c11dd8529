"""Clips that browsers play: H.264 in MP4, each picture at its own time."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any, Self

import av
import cv2
import numpy as np

from curlshot.vision.video.picture import Image
from curlshot.vision.video.source import DEFAULT_IMAGE_FPS

_TIME_BASE = Fraction(1, 90_000)  # fine enough for any rate, exact for 24, 25, 30, 50 and 60


class Encoder:
    """An H.264 file that browsers play, frame by frame, each at its own time."""

    def __init__(self, path: Path, size: tuple[int, int], fps: float | None) -> None:
        self._pad = (size[1] % 2, size[0] % 2)
        self._step = 1 / fps if fps else 1 / DEFAULT_IMAGE_FPS
        self.start: float | None = None
        self._waiting: tuple[Image, int] | None = None
        self._container: Any = av.open(
            str(path), "w", format="mp4", options={"movflags": "+faststart"}
        )
        self._stream: Any = self._container.add_stream(
            "libx264",
            rate=Fraction(fps or DEFAULT_IMAGE_FPS).limit_denominator(1001),
            options={
                "preset": "ultrafast",
                "crf": "24",
                # A whole picture every half second: stepping back has little to decode again.
                "g": str(max(round((fps or DEFAULT_IMAGE_FPS) / 2), 1)),
                # What OpenCV turns colours by; players read it here.
                "x264-params": "colorprim=bt709:transfer=bt709:colormatrix=smpte170m",
            },
        )
        self._stream.width, self._stream.height = size[0] + self._pad[1], size[1] + self._pad[0]
        self._stream.pix_fmt = "yuv420p"
        self._stream.codec_context.time_base = _TIME_BASE

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if kind is None:
                self._send(self._step)
                self._container.mux(self._stream.encode())
        finally:
            self._container.close()

    def add(self, image: Image, t: float) -> None:
        """Take the next picture, seen from time `t` (s) on."""
        if self.start is None:
            self.start = t
        pts = round((t - self.start) / _TIME_BASE)
        if self._waiting is not None:
            self._step = float((pts - self._waiting[1]) * _TIME_BASE)
            self._send(self._step)
        self._waiting = (image, pts)

    def _send(self, lasts: float) -> None:
        """Code the picture that waited to learn how long it is shown."""
        if self._waiting is None:
            return
        image, pts = self._waiting
        if any(self._pad):
            bottom, right = self._pad
            image = np.asarray(
                cv2.copyMakeBorder(image, 0, bottom, 0, right, cv2.BORDER_REPLICATE), np.uint8
            )
        planes = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2YUV_I420), np.uint8)
        frame = av.VideoFrame.from_ndarray(planes, format="yuv420p")
        frame.pts, frame.time_base = pts, _TIME_BASE
        frame.duration = round(lasts / _TIME_BASE)
        self._container.mux(self._stream.encode(frame))
