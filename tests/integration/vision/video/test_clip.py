from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.reader import open_video


def test_a_rate_for_a_video_is_ignored_aloud(shared: Path) -> None:
    clip = open_video([shared / "clips" / "collision-pucks.mp4"], VideoConfig(fps=10))
    assert "its own times" in clip.warnings[0]


def test_real_clip_with_title_cards(shared: Path) -> None:
    clip = open_video([shared / "clips" / "collision-pucks.mp4"], VideoConfig(frames=(2, 32)))
    frames = list(clip)
    assert len(frames) == 31
    assert clip.size == (320, 240)
    np.testing.assert_allclose(np.diff([frame.t for frame in frames]), 1001 / 30000, atol=1e-3)


WIDTH, HEIGHT = 96, 64


def picture(index: int) -> NDArray[np.uint8]:
    """A picture that shows its number as a bar and does not compress well."""
    image = np.full((HEIGHT, WIDTH, 3), 20, np.uint8)
    image[:32, : 2 * index + 2] = 200
    image[32:] = np.random.default_rng(index).integers(0, 255, (32, WIDTH, 3))
    return image


def number(frame: Frame) -> int:
    """Read the number off the bar."""
    return round(float((frame.image[4:28].mean(axis=(0, 2)) > 110).sum())) // 2 - 1


def write_clip(
    path: Path, times: Sequence[float], *, pixel: Fraction = Fraction(1), **options: str
) -> Path:
    """Write H.264 with the given presentation times, s; B-frames come out of order.

    Its pixels are meant to be shown so many times as wide as high.
    """
    clock = Fraction(1, 90_000)
    with av.open(str(path), "w", options=options) as container:
        stream = container.add_stream("libx264", rate=30)
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        stream.codec_context.time_base = clock
        stream.codec_context.sample_aspect_ratio = pixel
        stream.options = {"bf": "2", "g": "10"}
        for index, t in enumerate(times):
            frame = av.VideoFrame.from_ndarray(picture(index), format="bgr24")
            frame.pts, frame.time_base = round(t / clock), clock
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def uneven(n: int = 40) -> NDArray[np.float64]:
    """Times of a clip whose rate varies and that drops frames."""
    steps = np.random.default_rng(7).uniform(0.01, 0.2, n - 1)
    return np.concatenate([[0.0], np.cumsum(steps)])


@pytest.mark.parametrize("name", ["clip.mp4", "clip.mov", "clip.mkv", "Kürling 1.mp4"])
def test_times_are_those_of_the_container(tmp_path: Path, name: str) -> None:
    times = uneven()
    clip = open_video([write_clip(tmp_path / name, times)])
    frames = list(clip)
    assert [frame.index for frame in frames] == list(range(40))
    assert [number(frame) for frame in frames] == list(range(40))
    np.testing.assert_allclose([frame.t for frame in frames], times, rtol=0, atol=1e-3)
    assert clip.size == (WIDTH, HEIGHT)
    assert clip.warnings == []
    assert all(frame.image.dtype == np.uint8 for frame in frames)


def test_a_clip_can_be_read_again(tmp_path: Path) -> None:
    clip = open_video([write_clip(tmp_path / "clip.mp4", np.arange(12) / 25)])
    first = [(frame.index, frame.t) for frame in clip]
    for frame in clip:
        if frame.index == 5:
            break
    assert [(frame.index, frame.t) for frame in clip] == first
    assert clip.expected == clip.source.frames == 12
    assert clip.fps == pytest.approx(25, rel=0.02)  # the last frame may last longer


def test_squeezed_pictures_are_shown_as_they_are_meant(tmp_path: Path) -> None:
    plain, squeezed = (
        open_video([write_clip(tmp_path / f"{k}.mp4", np.arange(3) / 25, pixel=pixel)])
        for k, pixel in enumerate((Fraction(1), Fraction(4, 3)))
    )
    assert plain.size == (WIDTH, HEIGHT)
    assert squeezed.size == (2 * round(WIDTH * 2 / 3), HEIGHT)
    for one, other in zip(plain, squeezed, strict=True):
        assert other.image.shape[1::-1] == squeezed.size
        wide = cv2.resize(one.image, squeezed.size, interpolation=cv2.INTER_LINEAR)
        assert np.abs(wide[4:28].astype(float) - other.image[4:28]).mean() < 4


def test_a_range_of_frames_keeps_numbers_and_times(tmp_path: Path) -> None:
    path = write_clip(tmp_path / "clip.mp4", uneven())
    clip = open_video([path], VideoConfig(frames=(7, 11)))
    frames = list(clip)
    assert [frame.index for frame in frames] == [7, 8, 9, 10, 11]
    assert [number(frame) for frame in frames] == [7, 8, 9, 10, 11]
    np.testing.assert_allclose([frame.t for frame in frames], uneven()[7:12], atol=1e-3)
    assert clip.expected == 5
    assert clip.warnings == []
    assert len(list(open_video([path], VideoConfig(frames=(35, None))))) == 5
    for wrong in ((5, 4), (-1, None), (40, None)):
        with pytest.raises(InputError):
            open_video([path], VideoConfig(frames=wrong))


@pytest.mark.parametrize("part", [0.3, 0.6, 0.95])
@pytest.mark.parametrize("even", [True, False])
def test_a_truncated_clip_is_used_as_far_as_it_goes(
    tmp_path: Path, part: float, even: bool
) -> None:
    times = np.arange(40) / 25 if even else uneven()
    raw = write_clip(tmp_path / "whole.mp4", times, movflags="+faststart").read_bytes()
    path = tmp_path / "cut.mp4"
    path.write_bytes(raw[: int(part * len(raw))])
    clip = open_video([path])
    frames = list(clip)
    assert 40 * part - 8 < len(frames) < 40
    np.testing.assert_allclose([f.t for f in frames], times[: len(frames)], atol=1e-3)
    assert len(clip.warnings) == 1
    assert "of 40 frames; used as far as it goes" in clip.warnings[0]
    list(clip)
    assert len(clip.warnings) == 1


def test_a_clip_without_its_index_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    raw = write_clip(tmp_path / "whole.mp4", uneven()).read_bytes()
    path = tmp_path / "cut.mp4"
    path.write_bytes(raw[: len(raw) // 2])
    with pytest.raises(InputError, match=r"cut\.mp4: not a readable video"):
        open_video([path])
    assert capfd.readouterr() == ("", "")


def test_what_is_no_clip_is_refused_in_one_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    text = tmp_path / "text.mp4"
    text.write_text("This is no video.\n" * 50)
    empty = tmp_path / "empty.mp4"
    empty.write_bytes(b"")
    noise = tmp_path / "noise.png"
    noise.write_bytes(np.random.default_rng(3).bytes(999))
    (tmp_path / "folder").mkdir()
    for path, reason in (
        (text, "not a readable video"),
        (empty, "the file is empty"),
        (noise, "not a readable picture"),
        (tmp_path / "none.mp4", "no such file"),
        (tmp_path / "folder", "a folder"),
    ):
        with pytest.raises(InputError, match=reason) as refusal:
            open_video([path])
        assert str(path) in str(refusal.value)
        assert "\n" not in str(refusal.value)
    with pytest.raises(InputError, match="no clip"):
        open_video([])
    assert capfd.readouterr() == ("", "")


def test_a_video_that_is_refused_is_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_clip(tmp_path / "clip.mp4", np.arange(3) / 25, movflags="faststart")
    hollow = tmp_path / "hollow.mp4"  # with its index and no picture
    raw = path.read_bytes()
    hollow.write_bytes(raw[: raw.index(b"mdat") + 4])
    opened = []
    plain = av.open

    def watched(name: str) -> object:
        opened.append(plain(name))
        return opened[-1]

    monkeypatch.setattr(av, "open", watched)
    for which, frames, reason in (
        (hollow, None, "not a readable video"),
        (path, (5, None), "only 3"),
    ):
        with pytest.raises(InputError, match=reason):
            open_video([which], VideoConfig(frames=frames))
        with pytest.raises(AssertionError, match="not open"):
            next(opened[-1].demux())
    assert len(opened) == 2


def test_two_videos_are_too_many(tmp_path: Path) -> None:
    paths = [write_clip(tmp_path / name, np.arange(3) / 25) for name in ("a.mp4", "b.mp4")]
    with pytest.raises(InputError, match="one video at a time"):
        open_video(paths)


def write_pictures(folder: Path, count: int, suffix: str = ".png") -> list[Path]:
    paths = [folder / f"Bild {index + 1}{suffix}" for index in range(count)]
    for index, path in enumerate(paths):
        ok, raw = cv2.imencode(suffix, picture(index))
        assert ok
        raw.tofile(path)
    return paths


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".bmp"])
def test_pictures_have_the_rate_that_is_given(tmp_path: Path, suffix: str) -> None:
    clip = open_video(write_pictures(tmp_path, 12, suffix), VideoConfig(fps=10))
    frames = list(clip)
    assert [number(frame) for frame in frames] == list(range(12))
    np.testing.assert_allclose([frame.t for frame in frames], np.arange(12) / 10)
    assert clip.fps == 10
    ranged = open_video(clip.files, VideoConfig(fps=10, frames=(3, 5)))
    assert [frame.t for frame in ranged] == pytest.approx([0.3, 0.4, 0.5])


def test_pictures_that_are_missing_leave_their_time(tmp_path: Path) -> None:
    paths = write_pictures(tmp_path, 8)
    clip = open_video([*paths[:3], *paths[5:]], VideoConfig(fps=10))
    assert [frame.index for frame in clip] == [0, 1, 2, 3, 4, 5]
    assert [frame.t for frame in clip] == pytest.approx([0, 0.1, 0.2, 0.5, 0.6, 0.7])
    (warning,) = clip.warnings
    assert "missing" in warning
    assert "up to 3 time steps" in warning
    assert not open_video(paths, VideoConfig(fps=10)).warnings


def test_a_single_picture_has_no_rate(tmp_path: Path) -> None:
    clip = open_video(write_pictures(tmp_path, 1))
    (frame,) = clip
    np.testing.assert_array_equal(frame.image, picture(0))
    assert frame.t == 0
    assert clip.fps is None


def test_bad_pictures_are_left_out_with_a_warning(tmp_path: Path) -> None:
    paths = write_pictures(tmp_path, 6)
    paths[0].write_bytes(b"")
    paths[2].write_bytes(b"no picture")
    cv2.imwrite(str(paths[4]), np.zeros((10, 10, 3), np.uint8))
    clip = open_video(paths)
    assert [frame.index for frame in clip] == [1, 3, 5]
    assert [frame.t for frame in clip] == pytest.approx([0.04, 0.12, 0.2])
    assert "25 a second assumed" in clip.warnings[0]
    assert "not a readable picture" in clip.warnings[1]
    assert "differs in size" in clip.warnings[3]
    for path in paths:
        path.write_bytes(b"")
    with pytest.raises(InputError, match="not a readable picture"):
        open_video(paths)
