from __future__ import annotations

import gc
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest

from curlshot.cli.main import main
from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.data.project import read_project
from curlshot.data.tracks import check_detections
from curlshot.data.trk import Coordinates
from curlshot.data.trk_write import View, project_xml, write_trk, write_trz
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.project_clip import project_cameras
from curlshot.vision.video.reader import Video, open_video


def test_the_clip_or_the_marks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Discs on a table: what is marked, and what the clip shows, by the project's calibration."""
    frames = 40
    writer = cv2.VideoWriter(
        str(tmp_path / "c.mp4"), cv2.VideoWriter.fourcc(*"mp4v"), 25.0, (640, 480)
    )
    places = np.column_stack([-0.6 + 0.02 * np.arange(frames), np.full(frames, 0.1)])
    similarity = np.array([[300.0, 0, 320], [0, -300.0, 240], [0, 0, 1]])
    camera = Camera(0, 0.0, similarity, (640, 480))
    for place in places:
        image = np.full((480, 640, 3), 220, np.uint8)
        centre = np.round(16 * camera.project(place)).astype(int)
        cv2.circle(image, tuple(centre.tolist()), 16 * 24, (40, 40, 160), -1, cv2.LINE_AA, 4)
        writer.write(image)
    writer.release()
    table = check_detections(
        pd.DataFrame(
            {"stone": "puck", "frame": range(frames), "t": np.arange(frames) / 25,
             "x": places[:, 0] + 0.3, "y": places[:, 1]}
        )
    )  # fmt: skip
    system = Coordinates(np.zeros(1, np.int64), np.array([[320.5, 240.5]]), np.zeros(1),
                         np.full((1, 2), 300.0))  # fmt: skip
    view = View(system, (640, 480), ("videos/c.mp4",), frames)
    text = project_xml(table, view, np.full((frames, 2), 50.0))
    write_trz(text, tmp_path / "shot.trz", {"videos/c.mp4": tmp_path / "c.mp4"})
    trz = str(tmp_path / "shot.trz")
    out = tmp_path / "out"
    common = ["--radius", "0.08", "-o", str(out), "-q"]
    assert main(["track", trz, "--camera", trz, *common]) == 0
    found = pd.read_csv(out / "tracks.csv")
    np.testing.assert_allclose(found[["x", "y"]], places, atol=2e-3)
    np.testing.assert_allclose(found["t"], table["t"], atol=1e-6)
    assert main(["estimate", trz, *common]) == 0
    assert main(["run", trz, "--clip", "--camera", trz, "--no-overlay", *common]) == 0
    assert (out / "report.html").exists()
    other = ["-o", str(tmp_path / "other"), "-q"]
    assert main(["run", str(out / "tracks.csv"), "--clip", *other]) == 2
    assert "not a clip" in capsys.readouterr().err
    assert main(["run", trz, "--camera", trz, *common]) == 2
    assert "only clips take --camera" in capsys.readouterr().err


def test_the_clips_of_users_are_read(shared: Path) -> None:
    for path in sorted((shared / "tracker" / "real").glob("*.trz")):
        clip = open_video([path])
        marked = read_project(path)
        seen = {frame.index: frame.t for frame in clip}
        assert len(seen) == clip.expected == marked.timing.count
        frames = marked.masses[0].frames
        frames = frames[marked.timing.includes(frames)]
        np.testing.assert_allclose(
            [seen[int(frame)] for frame in frames], marked.timing.times(frames), atol=0.05
        )
        camera = project_cameras(clip, marked)[0][int(frames[0])]
        place = marked.axes.world(frames[:1], marked.masses[0].marks[:1])
        np.testing.assert_allclose(
            camera.ice(marked.masses[0].marks[0] - 0.5), place[0], rtol=1e-9, atol=1e-12
        )
    sample = open_video([shared / "tracker" / "samples" / "sample.trz"])
    whole = open_video(sample.source.whole.files, VideoConfig(fps=30))
    assert len(list(sample)) == len(list(whole)) == 12


SIZE = (320, 240)


FRAMES = 12


def pictures(folder: Path) -> list[Path]:
    """Plain pictures whose brightness is ten times their number."""
    folder.mkdir(exist_ok=True)
    files = [folder / f"{n}.png" for n in range(FRAMES)]
    for n, file in enumerate(files):
        cv2.imwrite(str(file), np.full((SIZE[1], SIZE[0], 3), 10 * n, np.uint8))
    return files


def video(path: Path, fps: float = 25.0) -> Path:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), fps, SIZE)
    for n in range(FRAMES):
        writer.write(np.full((SIZE[1], SIZE[0], 3), 10 * n, np.uint8))
    writer.release()
    return path


def project(
    video: tuple[str, ...], frames: range = range(FRAMES), step: float = 0.04, start: float = 0.0
) -> str:
    """A resting stone over a clip, its frames of this duration, s."""
    count = len(frames)
    t = start + step * np.arange(count)
    table = check_detections(
        pd.DataFrame({"stone": "A", "frame": list(frames), "t": t, "x": 0.5, "y": 0.2})
    )
    keys = np.array([0, 6])
    system = Coordinates(
        keys, np.array([[100.0, 90.0], [110.0, 80.0]]), np.array([0.1, -0.2]), np.full((2, 2), 80.0)
    )
    return project_xml(table, View(system, SIZE, video, FRAMES), np.full((count, 2), 50.0))


def times(clip: Video) -> list[tuple[int, float, float]]:
    return [(f.index, round(f.t, 9), float(np.round(f.image.mean(), -1))) for f in clip]


def test_steps_of_the_project_at_its_times(tmp_path: Path) -> None:
    video(tmp_path / "clip.mp4")
    text = project(("clip.mp4",), range(2, 11), start=1.5)
    write_trk(text, tmp_path / "shot.trk")
    clip = open_video([tmp_path / "shot.trk"])
    wanted = [(n, round(1.5 + 0.04 * (n - 2), 9), 10.0 * n) for n in range(2, 11)]
    assert times(clip) == wanted
    assert clip.read == clip.expected == 9
    assert clip.fps == pytest.approx(25)
    assert clip.warnings == []
    assert times(open_video([tmp_path / "shot.trk"], VideoConfig(frames=(4, 6)))) == wanted[2:5]
    text = text.replace('"stepsize" type="int">1', '"stepsize" type="int">3')
    text = text.replace('"stepcount" type="int">9', '"stepcount" type="int">3')
    write_trk(text, tmp_path / "shot.trk")
    clip = open_video([tmp_path / "shot.trk"])
    assert times(clip) == wanted[::3]
    assert clip.expected == 3
    assert clip.fps == pytest.approx(25 / 3)


def test_slow_motion_is_paced_by_the_project(tmp_path: Path) -> None:
    video(tmp_path / "clip.mp4", fps=25.0)
    write_trk(project(("clip.mp4",), step=1 / 240), tmp_path / "shot.trk")
    clip = open_video([tmp_path / "shot.trk"])
    np.testing.assert_allclose([f.t for f in clip], np.arange(FRAMES) / 240, atol=1e-9)
    assert any(
        "a frame lasts 4.167 ms in the project, 40 ms in its video" in w for w in clip.warnings
    )


@pytest.fixture
def unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which archives are unpacked."""
    folder = tmp_path / "unpacked"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def test_a_clip_in_an_archive_lasts_as_long_as_it_is_used(tmp_path: Path, unpacked: Path) -> None:
    files = pictures(tmp_path / "f")
    names = {f"videos/{file.name}": file for file in files}
    write_trz(project(tuple(names)), tmp_path / "shot.trz", names)
    shutil.rmtree(tmp_path / "f")
    clip = open_video([tmp_path / "shot.trz"])
    assert len(list(unpacked.iterdir())) == 1
    for _ in range(2):
        assert times(clip) == [(n, round(0.04 * n, 9), 10.0 * n) for n in range(FRAMES)]
    del clip
    gc.collect()
    assert list(unpacked.iterdir()) == []


def test_what_cannot_be_opened_is_named_by_its_project(tmp_path: Path, unpacked: Path) -> None:
    write_trk(project(("clip.mp4",)), tmp_path / "a.trk")
    with pytest.raises(InputError, match=r"a\.trk: its clip clip\.mp4 is missing"):
        open_video([tmp_path / "a.trk"])
    (tmp_path / "clip.mp4").write_bytes(b"no clip")
    with pytest.raises(InputError, match=r"a\.trk: clip\.mp4: not a readable video"):
        open_video([tmp_path / "a.trk"])
    write_trz(project(("v/clip.mp4",)), tmp_path / "a.trz", {"v/clip.mp4": tmp_path / "clip.mp4"})
    with pytest.raises(InputError, match=r"a\.trz: \d*-clip\.mp4: not a readable video"):
        open_video([tmp_path / "a.trz"])
    assert list(unpacked.iterdir()) == []
    write_trk(project(()), tmp_path / "b.trk")
    with pytest.raises(InputError, match=r"b\.trk: a project without a clip"):
        open_video([tmp_path / "b.trk"])


def test_the_calibration_of_a_project_is_a_camera(tmp_path: Path) -> None:
    """Tracker's own formula, with OpenCV's pixels and metres."""
    files = pictures(tmp_path)
    write_trk(project(tuple(file.name for file in files)), tmp_path / "shot.trk")
    clip = open_video([tmp_path / "shot.trk"])
    system = read_project(tmp_path / "shot.trk").axes
    cameras, notes = project_cameras(clip, clip.source.project)
    assert [camera.frame for camera in cameras] == list(range(FRAMES))
    assert "perspective, the height of the caps" in notes[0]
    pixels = np.array([[10.0, 20.0], [200.0, 100.0]])
    for camera in cameras:
        world = system.world([camera.frame] * 2, pixels + 0.5)
        np.testing.assert_allclose(camera.ice(pixels), world, atol=1e-12)
    in_cm = replace(clip.source.project, length_unit="cm")
    (camera, *_), _ = project_cameras(clip, in_cm)
    np.testing.assert_allclose(camera.ice(pixels), cameras[0].ice(pixels) / 100)
    with pytest.raises(InputError, match="“ell”, which is unknown here"):
        project_cameras(clip, replace(clip.source.project, length_unit="ell"))


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("80.0<", "1.0<", "not calibrated"),
        ('"yscale" type="double">80.0', '"yscale" type="double">-80.0', "mirrored"),
    ],
)
def test_a_calibration_that_is_none_is_refused(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    files = pictures(tmp_path)
    text = project(tuple(file.name for file in files)).replace(old, new)
    write_trk(text, tmp_path / "shot.trk")
    clip = open_video([tmp_path / "shot.trk"])
    with pytest.raises(InputError, match=reason):
        project_cameras(clip, clip.source.project)


def test_a_calibration_of_changed_pictures_is_refused(tmp_path: Path) -> None:
    files = pictures(tmp_path)
    item = (
        '<property name="item" type="object"><object class="x.RadialDistortionFilter"/></property>'
    )
    filters = f'<property name="filters" type="collection" class="x">{item}</property>'
    text = project(tuple(file.name for file in files))
    text = text.replace('core.ImageVideo">', f'core.ImageVideo">{filters}')
    write_trk(text, tmp_path / "shot.trk")
    clip = open_video([tmp_path / "shot.trk"])
    assert any("radial distortion) are not applied" in text for text in clip.warnings)
    with pytest.raises(InputError, match="changed by filters"):
        project_cameras(clip, clip.source.project)
