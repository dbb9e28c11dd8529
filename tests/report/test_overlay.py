from __future__ import annotations

import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from report.overlay import write_overlay
from vision.camera import Camera
from vision.clip import open_clip

SIZE = (321, 241)  # odd both ways
TIMES = [0.0, 0.04, 0.08, 0.2, 0.24, 0.25, 0.3, 0.5]
GREY = 120
CHROMIUM_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def camera(frame: int, **kwargs) -> Camera:
    homography = np.array([[60.0, 0, 160], [0, -60.0, 120], [0, 0, 1]])
    return Camera(frame, 0.0, homography, SIZE, **kwargs)


def uneven_clip(path: Path) -> Path:
    """A clip with gaps in time, even in size."""
    with av.open(str(path), "w") as out:
        stream = out.add_stream("libx264", rate=25, options={"crf": "10", "bf": "0"})
        stream.width, stream.height, stream.pix_fmt = 320, 240, "yuv420p"
        stream.codec_context.time_base = Fraction(1, 1000)
        for t in TIMES:
            frame = av.VideoFrame.from_ndarray(np.full((240, 320, 3), GREY, np.uint8), "bgr24")
            frame.pts, frame.time_base = round(t * 1000), Fraction(1, 1000)
            out.mux(stream.encode(frame))
        out.mux(stream.encode())
    return path


def pictures(folder: Path, count: int = 6) -> list[Path]:
    paths = []
    for k in range(count):
        path = folder / f"{k:03}.png"
        cv2.imwrite(str(path), np.full((SIZE[1], SIZE[0], 3), GREY, np.uint8))
        paths.append(path)
    return paths


def read(path: Path) -> tuple[list[float], list[np.ndarray]]:
    with av.open(str(path)) as video:
        frames = list(video.decode(video=0))
        assert frames[0].format.name == "yuv420p"
        return [f.time for f in frames], [f.to_ndarray(format="bgr24") for f in frames]


def test_every_frame_keeps_its_time(tmp_path, shot):
    clip = open_clip([uneven_clip(tmp_path / "in.mp4")])
    told = []
    out = tmp_path / "out" / "overlay.mp4"
    write_overlay(clip, [], shot.tracks, (), out, progress=lambda *step: told.append(step))
    times, images = read(out)
    np.testing.assert_allclose(times, TIMES, atol=1e-4)
    assert told[-1] == ("overlay", len(TIMES), clip.expected)
    assert np.abs(images[3].astype(int) - GREY).max() < 15, "without a camera nothing is drawn"
    assert [p.name for p in out.parent.iterdir()] == ["overlay.mp4"]


def test_odd_sizes_and_frames_without_a_camera(tmp_path, shot):
    clip = open_clip(pictures(tmp_path), fps=30.0)
    out = tmp_path / "overlay.mp4"
    cameras = [camera(k, k1=-0.05) for k in range(6) if k != 2]
    write_overlay(clip, cameras, shot.tracks, shot.results.collisions, out)
    times, images = read(out)
    np.testing.assert_allclose(times, np.arange(6) / 30, atol=1e-4)
    assert images[0].shape == (242, 322, 3)
    changed = [np.abs(image.astype(int) - GREY).max() > 40 for image in images]
    assert changed == [True, True, False, True, True, True]
    with av.open(str(out)) as video:
        assert float(video.duration / 1e6) == pytest.approx(6 / 30, abs=0.002)
    head = out.read_bytes()
    assert head.index(b"moov") < head.index(b"mdat"), "starts before it is all there"


def test_lines_fall_where_the_camera_says(tmp_path, shot):
    clip = open_clip(pictures(tmp_path, 1))
    cam = camera(0, k1=-0.1)
    still = shot.tracks[shot.tracks["stone"] == "D"]
    out = tmp_path / "overlay.mp4"
    write_overlay(clip, [cam], still, (), out, rings=(1.829,))
    _, (image,) = read(out)
    angles = np.linspace(0.1, 2 * np.pi, 40)
    ring = cam.project(1.829 * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    inside = (ring > 3).all(axis=1) & (ring < np.array(SIZE) - 4).all(axis=1)
    assert inside.sum() > 30
    away = np.abs(image.astype(int) - GREY).max(axis=2)
    for x, y in np.round(ring[inside]).astype(int):
        assert away[y - 1 : y + 2, x - 1 : x + 2].max() > 40
    # Between the rings' place and the stone nothing is drawn.
    x, y = np.round(cam.project(np.array([0.9, 0.9]))).astype(int)
    assert away[y - 3 : y + 4, x - 3 : x + 4].max() < 40


def test_no_rings_where_there_is_no_house(tmp_path, shot):
    clip = open_clip(pictures(tmp_path, 1))
    still = shot.tracks[shot.tracks["stone"] == "D"]
    out = tmp_path / "overlay.mp4"
    write_overlay(clip, [camera(0)], still, (), out, rings=None)
    _, (image,) = read(out)
    away = np.abs(image.astype(int) - GREY).max(axis=2)
    assert away[:, 230:].max() < 20
    assert away.max() > 40


def test_nothing_is_left_of_a_failure(tmp_path, shot):
    class Broken:
        size, fps, expected = (320, 240), 25.0, 5

        def __iter__(self):
            yield from open_clip(pictures(tmp_path, 2))
            raise OSError("the disk went away")

    folder = tmp_path / "out"
    with pytest.raises(OSError, match="went away"):
        write_overlay(Broken(), [], shot.tracks, (), folder / "overlay.mp4")
    assert list(folder.iterdir()) == []


def test_points_behind_a_tilted_camera_are_not_drawn(tmp_path, shot):
    tilted = np.array([[60.0, 0, 160], [0, -60.0, 120], [0, -0.7, 1]])
    cam = Camera(0, 0.0, tilted, SIZE, k1=-0.3)
    clip = open_clip(pictures(tmp_path, 1))
    write_overlay(clip, [cam], shot.tracks, (), tmp_path / "overlay.mp4")
    times, _ = read(tmp_path / "overlay.mp4")
    assert times == [0.0]


@pytest.mark.skipif(shutil.which("chromium") is None, reason="no chromium to play it in")
def test_it_plays_in_a_browser(tmp_path, shot):
    clip = open_clip(pictures(tmp_path), fps=25.0)
    write_overlay(clip, [camera(0)], shot.tracks, (), tmp_path / "overlay.mp4")
    page = tmp_path / "page.html"
    page.write_text(
        """<!DOCTYPE html><title>wait</title><video src="overlay.mp4" muted></video><p>wait</p>
        <script>const v = document.querySelector("video"), p = document.querySelector("p");
        v.onerror = () => p.textContent = "error " + v.error.message;
        v.onloadeddata = () => p.textContent = `${v.videoWidth} ${v.duration.toFixed(2)}`;
        </script>""",
        encoding="utf-8",
    )
    done = subprocess.run(
        ["chromium", *CHROMIUM_FLAGS, f"--user-data-dir={tmp_path / 'profile'}", "--timeout=5000",
         "--dump-dom", page.as_uri()],
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert "<p>322 0.24</p>" in done.stdout
