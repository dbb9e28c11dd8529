from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.config import VideoConfig
from curlshot.synthetic import still_camera
from curlshot.vision.optics.camera import Camera, CameraError
from curlshot.vision.video.picture import Planes
from curlshot.vision.video.reader import Video, open_video

Image = NDArray[np.uint8]

W, H = 320, 180
SHOWN = 100
SHEET = np.array([[110, 0], [210, 0], [W - 1, H], [0, H]])
"""Corners of a lit sheet in a dark hall."""


def scene(seed: int, light: float = 1.0, width: int = W) -> Image:
    """Something of every lightness, smooth enough to be coded well."""
    random = np.random.default_rng(seed).integers(60, 255, (9, 16, 3), np.uint8)
    return np.asarray(light * cv2.resize(random, (width, H)), np.uint8)


def hall(light: float) -> Image:
    """A sheet between boards that are black where it is dim."""
    picture = np.full((H, W, 3), 60, np.uint8)
    picture[:, 110:210] = 230
    return np.asarray(light * picture, np.uint8)


def barred(picture: Image, left: int, right: int, above: int = 0) -> Image:
    out = picture.copy()
    out[:, :left] = out[:, W - right :] = out[:above] = out[H - above :] = 0
    return out


def video(path: Path, pictures: Sequence[Image], crf: int = 28) -> Video:
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.height, stream.width = pictures[0].shape[:2]
        stream.pix_fmt = "yuv420p"
        stream.options = {"crf": str(crf)}
        for k, picture in enumerate(pictures):
            frame = av.VideoFrame.from_ndarray(picture, format="bgr24")
            frame.pts, frame.time_base = k, Fraction(1, 25)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return open_video([path])


def lit_clip(clip: Video) -> Video:
    """The same clip, its bars cut off."""
    clip.cut_bars()
    return clip


@pytest.mark.parametrize(("crf", "traces"), [(10, 0), (36, 8)])
def test_bars_are_cut_off(tmp_path: Path, crf: int, traces: int) -> None:
    pictures = [barred(scene(k), 110, 110) for k in range(5)]
    pictures[2] = barred(scene(2), 110, 110, above=H // 2)  # all black for a moment
    lit = lit_clip(video(tmp_path / "pillars.mp4", pictures, crf))
    width, height = lit.size
    assert lit.bars == ((W - width) // 2, 0) and lit.whole_size == (W, H)
    assert SHOWN <= width <= SHOWN + traces and height == H
    aside = (W - width) // 2
    for whole, part in zip(list(lit.uncut()), lit, strict=True):
        assert (part.index, part.t) == (whole.index, whole.t)
        assert part.picture.shape == (H, width, 3)
        # Colours stay with what they are colours of.
        assert isinstance(whole.picture, Planes)
        same = replace(whole.picture, frame=None).image[:, aside : W - aside].astype(int)
        np.testing.assert_allclose(part.image[:, 2:-2], same[:, 2:-2], atol=1)
    assert lit.read == 5 and not lit.warnings


@pytest.mark.parametrize("at", [(4, 15), (100, H - 6)])
def test_a_title_on_a_bar_leaves_it_one(tmp_path: Path, at: tuple[int, int]) -> None:
    """Taken for picture, the ends of the bars passed for the sides of the sheet: axes turned."""
    pictures = [barred(scene(k), 0, 0, above=24) for k in range(4)]
    for picture in pictures:
        cv2.putText(picture, "Final, end 7", at, cv2.FONT_HERSHEY_DUPLEX, 0.55, (255,) * 3, 2)
    lit = lit_clip(video(tmp_path / "title.mp4", pictures, crf=15))
    assert lit.size == (W, H - 2 * 24)


def test_bars_are_told_by_few_pictures(tmp_path: Path) -> None:
    clip = video(tmp_path / "pillars.mp4", [barred(scene(0), 110, 110)] * 30)
    assert len(list(clip.source.key_pictures())) < 3
    assert lit_clip(clip).size[0] < W


def test_of_a_part_of_a_clip_all_pictures_are_asked(tmp_path: Path) -> None:
    bars = [barred(scene(0), 110, 110)] * 30
    whole = video(tmp_path / "clip.mp4", [*bars, *[scene(1)] * 20])
    assert lit_clip(open_video(whole.files, VideoConfig(frames=(0, 29)))).size[0] < W
    assert (
        len(list(open_video(whole.files, VideoConfig(frames=(25, 34))).source.key_pictures())) == 10
    )


def test_pictures_of_another_size_have_no_say(tmp_path: Path) -> None:
    paths = [tmp_path / f"{size}.ts" for size in (1, 2)]
    video(paths[0], [barred(scene(0), 110, 110)] * 3)
    video(paths[1], [barred(scene(0), 110, 110)[: H // 2]] * 3)
    paths[0].write_bytes(b"".join(path.read_bytes() for path in paths))
    lit = lit_clip(open_video(paths[:1]))
    assert lit.size[0] < W and len(list(lit)) == 3


def test_bars_that_give_way_between_the_pictures_that_are_asked_are_told_of(tmp_path: Path) -> None:
    fading = [cv2.addWeighted(barred(scene(0), 110, 110), 1 - k, scene(0), k, 0.0)
              for k in np.linspace(0, 1, 20)]  # fmt: skip
    lit = lit_clip(video(tmp_path / "clip.mp4", fading))
    assert any(lit.bars) and not lit.warnings
    assert len(list(lit)) == 20
    (warning,) = lit.warnings
    assert "bars" in warning and "`frames`" in warning
    assert lit_clip(open_video(lit.files, VideoConfig(frames=(0, 19)))).size == (W, H)


def test_above_and_below_and_of_pictures(tmp_path: Path) -> None:
    paths = [tmp_path / f"{k}.png" for k in range(2)]
    for k, path in enumerate(paths):
        cv2.imwrite(str(path), barred(scene(k), 0, 0, 23))
    lit = lit_clip(open_video(paths, VideoConfig(fps=25.0)))
    assert lit.size == (W, H - 48)  # to an even number
    assert [frame.image.shape for frame in lit] == [(H - 48, W, 3)] * 2


@pytest.mark.parametrize(
    "pictures",
    [
        [scene(k) for k in range(4)],
        [scene(0, light) for light in (0.0, 0.03, 0.3, 1.0)],  # fades in
        [hall(0.1 * k) for k in range(1, 11)],  # a dark hall fades in, begun with its ice alone
        [scene(0, 0.05)] * 4,  # hardly to be seen
        [*[barred(scene(0), 110, 110)] * 30, *[scene(1)] * 20],  # a title, say
        [barred(scene(k), 60, 160) for k in range(4)],  # the axis is who knows where
        [barred(scene(k), 110, 0) for k in range(4)],
        [barred(scene(k), 4, 4) for k in range(4)],
        [cv2.fillPoly(0 * scene(0), [SHEET], (230, 220, 210))] * 4,
    ],
    ids=["none", "fade", "hall", "night", "title", "uneven", "one side", "narrow", "sheet"],
)
def test_what_is_not_taken_for_bars(tmp_path: Path, pictures: list[Image]) -> None:
    clip = lit_clip(video(tmp_path / "clip.mp4", pictures))
    assert clip.bars == (0, 0) and clip.size == clip.whole_size == (W, H)
    frames = list(clip)
    assert frames[0].index == 0 and frames[-1].index == len(pictures) - 1


def test_a_night_whose_picture_fades_in_between_bars(tmp_path: Path) -> None:
    pictures = [barred(scene(0, light), 110, 110) for light in (0.0, 0.05, 0.4)]
    assert lit_clip(video(tmp_path / "clip.mp4", pictures)).size == (SHOWN, H)


def test_cameras_in_pixels_of_the_whole(tmp_path: Path) -> None:
    path = still_camera(size=(SHOWN, H), target=(0.1, 0.4), px_per_m=30, k1=-0.05)
    view = path.at(0.0)
    root = np.random.default_rng(3).normal(size=(9, 9)) * 1e-3
    error = CameraError(root @ root.T, 0.1 * root @ root.T, 1e-3)
    seen = Camera(
        3, 0.12, view.homography / view.homography[2, 2], (SHOWN, H), k1=view.lens.k1, k2=0.03,
        f_px=view.focal, position=view.position, error=error,
    )  # fmt: skip
    clip = lit_clip(video(tmp_path / "pillars.mp4", [barred(scene(0), 110, 110)] * 4, crf=10))
    (shown,) = clip.finish([seen])
    assert shown.size == (W, H) == clip.whole_size and clip.size == seen.size
    ice = np.array([[0.0, 0.0], [1.2, -0.7], [-1.5, 1.9]])
    for height in (0.0, 0.12):
        moved = shown.project(ice, height) - seen.project(ice, height)
        np.testing.assert_allclose(moved, np.tile([110.0, 0.0], (3, 1)), atol=1e-9)
    np.testing.assert_allclose(shown.place_cov(ice, 0.12), seen.place_cov(ice, 0.12), rtol=1e-9)
    np.testing.assert_allclose(shown.rotation, seen.rotation, atol=1e-12)
