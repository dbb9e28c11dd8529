from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from curlshot.config import VideoConfig
from curlshot.report import overlay
from curlshot.report.overlay import _scene, draw, write_overlay
from curlshot.tests.helpers.report.clips import GREY, SIZE, camera, pictures
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.reader import open_video

TIMES = [0.0, 0.04, 0.08, 0.2, 0.24, 0.25, 0.3, 0.5]


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


def read(path: Path) -> tuple[list[float], list[np.ndarray]]:
    with av.open(str(path)) as video:
        frames = list(video.decode(video=0))
        assert frames[0].format.name == "yuv420p"
        return [f.time for f in frames], [f.to_ndarray(format="bgr24") for f in frames]


def test_every_frame_keeps_its_time(tmp_path, shot):
    clip = open_video([uneven_clip(tmp_path / "in.mp4")])
    told = []
    out = tmp_path / "out" / "overlay.mp4"
    write_overlay(clip, [], shot.tracks, (), out, progress=lambda *step: told.append(step))
    times, images = read(out)
    np.testing.assert_allclose(times, TIMES, atol=1e-4)
    assert told[-1] == ("overlay", len(TIMES), clip.expected)
    assert np.abs(images[3].astype(int) - GREY).max() < 15, "without a camera nothing is drawn"
    assert [p.name for p in out.parent.iterdir()] == ["overlay.mp4"]


def test_odd_sizes_and_frames_without_a_camera(tmp_path, shot):
    clip = open_video(pictures(tmp_path), VideoConfig(fps=30.0))
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
    clip = open_video(pictures(tmp_path, 1))
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
    clip = open_video(pictures(tmp_path, 1))
    still = shot.tracks[shot.tracks["stone"] == "D"]
    out = tmp_path / "overlay.mp4"
    write_overlay(clip, [camera(0)], still, (), out, rings=None)
    _, (image,) = read(out)
    away = np.abs(image.astype(int) - GREY).max(axis=2)
    assert away[:, 230:].max() < 20
    assert away.max() > 40


def test_nothing_is_left_of_a_failure(tmp_path, shot):
    class Broken:
        size, whole_size, fps, expected = SIZE, SIZE, 25.0, 5

        def uncut(self):
            yield from open_video(pictures(tmp_path, 2)).uncut()
            raise OSError("the disk went away")

    folder = tmp_path / "out"
    with pytest.raises(OSError, match="went away"):
        write_overlay(Broken(), [], shot.tracks, (), folder / "overlay.mp4")
    assert list(folder.iterdir()) == []


def test_points_behind_a_tilted_camera_are_not_drawn(tmp_path, shot):
    tilted = np.array([[60.0, 0, 160], [0, -60.0, 120], [0, -0.7, 1]])
    cam = Camera(0, 0.0, tilted, SIZE, k1=-0.3)
    clip = open_video(pictures(tmp_path, 1))
    write_overlay(clip, [cam], shot.tracks, (), tmp_path / "overlay.mp4")
    times, _ = read(tmp_path / "overlay.mp4")
    assert times == [0.0]


def test_the_first_picture_keeps_its_time(tmp_path, shot):
    clip = open_video([uneven_clip(tmp_path / "in.mp4")], VideoConfig(frames=(3, 6)))
    start = write_overlay(clip, [], shot.tracks, (), tmp_path / "overlay.mp4")
    assert start == pytest.approx(TIMES[3], abs=1e-4)
    times, _ = read(tmp_path / "overlay.mp4")
    np.testing.assert_allclose(times, np.array(TIMES[3:7]) - TIMES[3], atol=1e-4)


def test_one_can_step_back_quickly(tmp_path, shot):
    clip = open_video(pictures(tmp_path, 60), VideoConfig(fps=25.0))
    write_overlay(clip, [], shot.tracks, (), tmp_path / "overlay.mp4")
    with av.open(str(tmp_path / "overlay.mp4")) as video:
        whole = [k for k, frame in enumerate(video.decode(video=0)) if frame.key_frame]
    assert max(np.diff([*whole, 60])) <= 13


def test_colours_survive(tmp_path, shot):
    path = tmp_path / "colours.png"
    image = np.zeros((240, 320, 3), np.uint8)
    patches = [(200, 60, 30), (40, 160, 60), (30, 40, 190), (230, 230, 230)]
    for k, colour in enumerate(patches):
        image[:, 80 * k : 80 * k + 80] = colour
    cv2.imwrite(str(path), image)
    write_overlay(open_video([path, path]), [], shot.tracks, (), tmp_path / "overlay.mp4")
    _, images = read(tmp_path / "overlay.mp4")
    for k, colour in enumerate(patches):
        seen = images[0][20:-20, 80 * k + 20 : 80 * k + 60].mean(axis=(0, 1))
        np.testing.assert_allclose(seen, colour, atol=8)


def test_labels_show_the_spin_and_the_colour_of_the_team(tmp_path, shot):
    clip = open_video(pictures(tmp_path, 3), VideoConfig(fps=25.0))
    moving = shot.tracks[shot.tracks["frame"] < 3].assign(x=0.0, y=0.0, vx=1.0, vy=0.0)
    one = moving[moving["stone"] == "A"].assign(team="#00ff00", omega=1.5)
    shown = {}
    for name, table in {
        "both": one, "slow": one.assign(omega=0.0), "unknown": one.assign(team="Norway")
    }.items():  # fmt: skip
        out = tmp_path / f"{name}.mp4"
        write_overlay(clip, [camera(k) for k in range(3)], table, (), out)
        shown[name] = read(out)[1][1].astype(int)

    def green(image: np.ndarray) -> int:
        return int((image[..., 1] - image[..., [0, 2]].max(-1) > 60).sum())

    def dark(image: np.ndarray) -> int:
        return int((image < 60).all(-1).sum())

    assert green(shown["both"]) > 10 > green(shown["unknown"])
    assert dark(shown["both"]) > 1.15 * dark(shown["slow"])


def test_the_name_of_a_hit_stays_until_it_can_be_read(shot):
    hit = shot.results.collisions[0]
    scene = _scene(shot.tracks, [hit], None, 0.1455)
    blank = np.full((240, 320, 3), GREY, np.uint8)

    def changed(since: float, rows: slice) -> bool:
        frame = Frame(-1, hit.t + since, blank)  # of which no stone is known
        plain = Frame(-1, hit.t - 0.5, blank)
        images = [draw(f, camera(-1), scene)[rows].astype(int) for f in (frame, plain)]
        return bool(np.abs(images[0] - images[1]).any())

    name, ice = slice(30, 50), slice(60, 240)
    assert [changed(s, name) for s in (0.0, 0.3, 1.0, 1.9, 2.1)] == [True] * 4 + [False]
    assert [changed(s, ice) for s in (0.0, 0.3, 1.0)] == [True, True, False]


def test_the_ring_of_a_hit_hides_no_name(shot, monkeypatch):
    hit = shot.results.collisions[0]
    state = hit.before[hit.stones[0]]
    still = shot.tracks[shot.tracks["stone"] == "D"].assign(x=state.x, y=state.y)
    blank = np.full((240, 320, 3), GREY, np.uint8)
    index = int(still["frame"].iloc[0])

    def shown(since: float) -> np.ndarray:
        return draw(Frame(index, hit.t + since, blank), camera(index), scene)[60:]

    scene = _scene(still, [hit], None, 0.1455)
    times = np.arange(0, 0.5, 0.04)
    without, rings = shown(-0.5), [shown(since) for since in times]
    monkeypatch.setattr(overlay, "_label", lambda *_: None)
    letters = (without != shown(-0.5)).any(-1) & (without > 200).all(-1)
    assert letters.sum() > 8
    assert any((ring[letters] < 60).any() for ring in map(shown, times))
    assert all((ring[letters] > 200).all() for ring in rings)


def test_of_a_broken_rack_a_few_names_are_written(shot):
    hit = shot.results.collisions[0]
    blank = np.full((480, 320, 3), GREY, np.uint8)
    frame = Frame(-1, hit.t + 1.0, blank)
    shown = {
        count: draw(frame, camera(-1), _scene(shot.tracks, [hit] * count, None, 0.1455))
        for count in (5, 6, 30)
    }
    written = {n: np.flatnonzero((image != GREY).any(axis=(1, 2))) for n, image in shown.items()}
    assert written[5].max() < written[6].max() == pytest.approx(written[30].max(), abs=3)


def test_of_a_stone_that_does_not_turn_no_angle_is_shown(shot):
    tracks = shot.tracks.copy()
    tracks.loc[tracks["stone"] == "D", "theta"] = 0.0  # of an unknown zero
    states = _scene(tracks, [], None, 0.1455).states
    shown = {state.stone for row in states.values() for state in row if np.isfinite(state.theta)}
    assert "D" not in shown
    assert "A" in shown
