from __future__ import annotations

import struct
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.vision.video.picture import (
    Planes,
    brightened,
    channels_at,
    colours_at,
    image_of,
    reduced,
)
from curlshot.vision.video.reader import open_video

WIDTH, HEIGHT = 96, 64


def smooth_picture() -> NDArray[np.uint8]:
    small = np.random.default_rng(3).integers(20, 235, (5, 7, 3), dtype=np.uint8)
    return np.asarray(cv2.resize(small, (WIDTH, HEIGHT), interpolation=cv2.INTER_LINEAR))


def write(path: Path, image: NDArray[np.uint8], pixels: str) -> Path:
    """One picture as H.264 of good quality, in a format of pixels."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264rgb" if pixels == "bgr24" else "libx264", rate=25)
        stream.height, stream.width = image.shape[:2]
        stream.pix_fmt, stream.options = pixels, {"crf": "2"}
        container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="bgr24")))
        container.mux(stream.encode())
    return path


def first(path: Path) -> Planes:
    found = next(iter(open_video([path]))).picture
    assert isinstance(found, Planes)
    return found


def everywhere(shape: tuple[int, ...]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    x, y = np.meshgrid(np.arange(shape[1]), np.arange(shape[0]))
    return x.astype(np.float32), y.astype(np.float32)


@pytest.mark.parametrize(
    "pixels", ["yuv420p", "yuvj420p", "yuv422p", "yuv444p", "yuv420p10le", "bgr24"]
)
def test_colours_are_those_of_the_picture_in_any_format(tmp_path: Path, pixels: str) -> None:
    true = smooth_picture()
    planes = first(write(tmp_path / "clip.mp4", true, pixels))
    assert planes.shape == true.shape
    sampled = colours_at(planes, *everywhere(true.shape)).astype(float)
    assert np.abs(sampled - true).mean() < 4.0
    assert np.abs(sampled - image_of(planes).astype(float)).mean() < 3.5
    assert np.abs((sampled - true).mean((0, 1))).max() < 2.0  # the encoder rounds down


def test_colours_between_pixels_are_where_they_belong(tmp_path: Path) -> None:
    # A soft edge between two colours of one lightness: only chroma tells where it is.
    x = np.arange(WIDTH)
    share = 1 / (1 + np.exp(-(x - 40.3) / 3))
    red, blue = np.array([60.0, 60.0, 200.0]), np.array([220.0, 99.0, 80.0])
    row = share[:, None] * red + (1 - share[:, None]) * blue
    image = np.tile(np.round(row).astype(np.uint8), (HEIGHT, 1, 1))
    planes = first(write(tmp_path / "clip.mp4", image, "yuv420p"))
    fine = np.arange(20, 60, 0.1, dtype=np.float32)[None]
    seen = colours_at(planes, fine, np.full_like(fine, 30.0))[0].astype(float)
    middle = float(np.interp(0.0, seen[:, 2] - seen[:, 0], fine[0]))
    assert middle == pytest.approx(40.3, abs=0.15)


@pytest.mark.parametrize("quarter", [0, 1, 2, 3])
def test_a_clip_held_otherwise_is_shown_upright(tmp_path: Path, quarter: int) -> None:
    path = write(tmp_path / "clip.mp4", smooth_picture(), "yuv420p")
    raw = bytearray(path.read_bytes())
    at = raw.index(b"tkhd") + 44  # the matrix of ISO/IEC 14496-12, 8.3.2
    c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarter]
    one = 1 << 16
    raw[at : at + 36] = struct.pack(">9i", c * one, s * one, 0, -s * one, c * one, 0, 0, 0, 1 << 30)
    path.write_bytes(raw)
    capture = cv2.VideoCapture(str(path))
    _, expected = capture.read()
    capture.release()
    planes, clip = first(path), open_video([path])
    assert clip.size == expected.shape[1::-1] == planes.shape[1::-1]
    np.testing.assert_allclose(image_of(planes).astype(int), expected.astype(int), atol=3)
    sampled = colours_at(planes, *everywhere(planes.shape))
    assert np.abs(sampled.astype(int) - expected).mean() < 4


def test_a_picture_in_colour_is_sampled_as_it_is() -> None:
    image = smooth_picture()
    np.testing.assert_array_equal(colours_at(image, *everywhere(image.shape)), image)
    assert image_of(image) is image


@pytest.mark.parametrize("times", [1, 2, 3, 4])
def test_a_smaller_picture_shows_the_same(tmp_path: Path, times: int) -> None:
    true = smooth_picture()
    planes = first(write(tmp_path / "clip.mp4", true, "yuv420p"))
    x, y = everywhere((HEIGHT // times - 2, WIDTH // times - 2))
    smaller, whole = reduced(planes, times), reduced(true, times)
    assert smaller.shape == whole.shape == (HEIGHT // times, WIDTH // times, 3)
    seen = colours_at(smaller, x + 0.6, y + 0.3).astype(float)
    assert np.abs(seen - colours_at(whole, x + 0.6, y + 0.3)).mean() < 4.0


def test_channels_are_the_colours_unrounded(tmp_path: Path) -> None:
    planes = first(write(tmp_path / "clip.mp4", smooth_picture(), "yuv420p"))
    x, y = (place[2:-2, 2:-2] + np.float32(0.3) for place in everywhere(planes.shape))
    for picture in (planes, planes.image):
        seen = np.clip(np.moveaxis(channels_at(picture, x, y), 0, -1), 0, 255)
        assert np.abs(seen - colours_at(picture, x, y)).max() < 1


def test_a_picture_in_another_light_has_each_colour_times_its_gain(tmp_path: Path) -> None:
    planes, gain = first(write(tmp_path / "clip.mp4", smooth_picture(), "yuv420p")), [0.7, 0.9, 1.0]
    before = colours_at(planes, *everywhere(planes.shape)).astype(float)
    for picture in (planes, before.astype(np.uint8)):
        lit = brightened(picture, np.array(gain))
        after = colours_at(lit, *everywhere(planes.shape)).astype(float)
        assert np.abs(after - before * gain).max() < 1.0
        assert np.abs(image_of(lit) - after).mean() < 2.0
    assert brightened(planes, np.ones(3)) is planes
