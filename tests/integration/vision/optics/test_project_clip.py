from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest

from curlshot.cli.main import main
from curlshot.config import VideoConfig
from curlshot.data.project import read_project
from curlshot.data.tracks import check_detections
from curlshot.data.trk import Coordinates
from curlshot.data.trk_write import View, project_xml, write_trz
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.project_clip import project_cameras
from curlshot.vision.video.reader import open_video


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
