"""Interlaced recordings: a bar that moves, its fields woven with plain numpy."""

from pathlib import Path

import av
import numpy as np
import pytest

from curlshot.vision.video.deinterlace import deinterlaced
from curlshot.vision.video.reader import open_video

WIDTH, HEIGHT, FRAMES, STEP = 320, 96, 12, 6
"""Size, px, frames, and how far the bar goes from field to field, px."""


def field(number: int) -> np.ndarray:
    """Luma of the moment of a field: a bar of 20 px at 40 px and further right by the steps."""
    luma = np.full((HEIGHT, WIDTH), 60, np.uint8)
    left = 40 + STEP * number
    luma[:, left : left + 20] = 200
    return luma


def write(path: Path, interlaced: bool) -> Path:
    with av.open(str(path), "w") as out:
        stream = out.add_stream("libx264", rate=25)
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        stream.options = {"crf": "8"} | ({"x264-params": "bff=1"} if interlaced else {})
        for number in range(FRAMES):
            luma = field(2 * number)
            if interlaced:  # the lower lines are those of the first moment
                luma[0::2] = field(2 * number + 1)[0::2]
            grey = np.full((HEIGHT // 2, WIDTH), 128, np.uint8)
            frame = av.VideoFrame.from_ndarray(np.concatenate([luma, grey]), format="yuv420p")
            frame.pts = number
            out.mux(stream.encode(frame))
        out.mux(stream.encode())
    return path


def middles(luma: np.ndarray) -> np.ndarray:
    """Where the bar is in each row, px."""
    bright = np.clip(luma.astype(float) - 80, 0, None)[8:-8]
    return bright @ np.arange(luma.shape[1]) / bright.sum(1)


def test_frames_without_a_time_are_shown_when_they_were_decoded(tmp_path: Path) -> None:
    with av.open(str(write(tmp_path / "bar.mp4", True))) as container:
        stream = container.streams.video[0]
        frames = list(container.decode(stream))
        ticks = [frame.pts for frame in frames]
        for frame, tick in zip(frames, ticks, strict=True):
            frame.pts, frame.dts = None, tick
        clock = [frame.pts * frame.time_base for frame in deinterlaced(iter(frames), stream)]
        assert clock == [tick * stream.time_base for tick in ticks]


@pytest.mark.parametrize("interlaced", [True, False])
def test_a_picture_is_of_one_moment_its_first_field(tmp_path: Path, interlaced: bool) -> None:
    frames = list(open_video([write(tmp_path / "bar.mp4", interlaced)]))
    assert [frame.index for frame in frames] == list(range(FRAMES))
    for frame in frames:
        assert frame.t == pytest.approx(frame.index / 25)
        rows = middles(frame.picture.luma)  # type: ignore[union-attr]
        assert np.abs(rows - (40 + 9.5 + 2 * STEP * frame.index)).max() < 1.0
