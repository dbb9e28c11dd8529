from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest

from curlshot.report.encode import Encoder


def pictures(count: int, size: tuple[int, int] = (64, 48)) -> list[np.ndarray]:
    return [np.full((size[1], size[0], 3), 20 + 40 * k, np.uint8) for k in range(count)]


def coded(path: Path, times: list[float], size: tuple[int, int] = (64, 48), fps=25.0) -> Encoder:
    with Encoder(path, size, fps) as video:
        for image, t in zip(pictures(len(times), size), times, strict=True):
            video.add(image, t)
    return video


def decoded(path: Path) -> list[av.VideoFrame]:
    with av.open(str(path)) as video:
        return list(video.decode(video=0))


@pytest.mark.parametrize("fps", [25.0, 29.97, 60.0, None])
def test_every_picture_keeps_its_time(tmp_path, fps):
    times = [3.0, 3.04, 3.2, 3.2417]
    video = coded(tmp_path / "a.mp4", times, fps=fps)
    assert video.start == 3.0
    found = [frame.time for frame in decoded(tmp_path / "a.mp4")]
    np.testing.assert_allclose(found, np.array(times) - 3.0, atol=2e-5)


def test_pictures_come_out_in_order(tmp_path):
    coded(tmp_path / "a.mp4", [0.0, 0.04, 0.08, 0.12])
    grey = [frame.to_ndarray(format="bgr24").mean() for frame in decoded(tmp_path / "a.mp4")]
    np.testing.assert_allclose(grey, [20, 60, 100, 140], atol=3)


def test_a_size_that_is_odd_gets_a_row_and_a_column_more(tmp_path):
    coded(tmp_path / "a.mp4", [0.0, 0.04], size=(63, 47))
    frames = decoded(tmp_path / "a.mp4")
    assert {(frame.width, frame.height) for frame in frames} == {(64, 48)}
    last = frames[1].to_ndarray(format="bgr24")
    np.testing.assert_allclose(last[-1], 60, atol=3)


def test_browsers_can_play_it(tmp_path):
    coded(tmp_path / "a.mp4", [0.0, 0.04])
    with av.open(str(tmp_path / "a.mp4")) as video:
        (stream,) = video.streams.video
        assert (stream.codec_context.name, stream.codec_context.pix_fmt) == ("h264", "yuv420p")
    content = (tmp_path / "a.mp4").read_bytes()
    assert content.index(b"moov") < content.index(b"mdat")  # it plays before all of it is there


def test_a_failure_is_not_hidden(tmp_path):
    with pytest.raises(ZeroDivisionError), Encoder(tmp_path / "a.mp4", (64, 48), 25.0) as video:
        video.add(pictures(1)[0], 0.0)
        raise ZeroDivisionError
