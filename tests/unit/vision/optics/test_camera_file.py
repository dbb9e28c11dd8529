from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest

from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.data.tracks import write_table
from curlshot.synthetic import still_camera
from curlshot.vision.optics.camera import Camera, camera_table
from curlshot.vision.optics.camera_file import given_cameras, read_cameras
from curlshot.vision.video.reader import Video, open_video

SIZE = (320, 240)


def cameras(count: int) -> list[Camera]:
    path = still_camera(size=SIZE, target=(0.1, 0.4), px_per_m=30, k1=-0.05)
    view = path.at(0.0)
    return [
        Camera(
            k, k / 25, view.homography, SIZE, k1=view.lens.k1, f_px=view.focal,
            position=view.position, rms_px=0.2, found=k != 1,
        )
        for k in range(count)
    ]  # fmt: skip


@pytest.fixture
def clip(tmp_path: Path) -> Video:
    pictures = [tmp_path / f"{k}.png" for k in range(3)]
    for picture in pictures:
        cv2.imwrite(str(picture), np.full((*SIZE[::-1], 3), 200, np.uint8))
    return open_video(pictures, VideoConfig(fps=25.0))


def test_what_is_written_is_read_back(clip: Video, tmp_path: Path) -> None:
    path = tmp_path / "camera.csv"
    table = camera_table(cameras(3))
    table["remark"] = "seen"
    write_table(table, path)
    found, notes = given_cameras(clip, path)
    assert [c.frame for c in found] == [0, 1, 2]
    assert [c.found for c in found] == [True, False, True]
    assert len(notes) == 1
    for one, two in zip(found, cameras(3), strict=True):
        assert one.t == two.t and one.size == SIZE
        pixel = np.array([[20.0, 30.0], [300.0, 200.0]])
        np.testing.assert_allclose(one.ice(pixel, 0.12), two.ice(pixel, 0.12), atol=1e-6)


def test_one_row_is_a_still_camera(clip: Video, tmp_path: Path) -> None:
    path = tmp_path / "still.csv"
    # In any scale, with no more than the homography.
    matrix = -2.5 * cameras(1)[0].homography
    names = [f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]
    pd.DataFrame([matrix.ravel()], columns=names).to_csv(path, index=False)
    found, notes = given_cameras(clip, path)
    assert [c.frame for c in found] == [0, 1, 2]
    assert all(c.position is None and c.found and np.isnan(c.rms_px) for c in found)
    np.testing.assert_allclose(found[2].homography, cameras(1)[0].homography)
    assert any("position of the camera is not given" in note for note in notes)


def test_frames_without_a_camera_are_left_out(clip: Video, tmp_path: Path) -> None:
    path = tmp_path / "camera.csv"
    write_table(camera_table(cameras(2)), path)
    found, notes = given_cameras(clip, path)
    assert [c.frame for c in found] == [0, 1]
    assert any("no camera for 1 of 3 frames" in note for note in notes)
    table = camera_table(cameras(2))
    write_table(table.assign(frame=table["frame"] + 50), path)
    with pytest.raises(InputError, match=r"frames 50 to 51, none of the selected ones"):
        given_cameras(clip, path)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"h12": np.nan}, "line 3: h12 is not a number"),
        ({"h12": "much"}, "line 3: h12 is not a number"),
        ({"k1": "inf"}, "line 3: k1 is not a number"),
        ({"h11": 0.0, "h21": 0.0, "h31": 0.0}, "line 3: the homography is singular"),
        ({"h33": 0.0}, "line 3: h33 is 0"),
        ({"k1": -3.0}, "line 3: k1 and k2 fold"),
        ({"cam_z": -8.0}, "line 3: cam_z is not above"),
        ({"frame": 0}, "line 3: a repeated frame"),
        ({"frame": 0.5}, "line 3: frame is not a whole number"),
        ({"frame": -1}, "line 3: frame is not a whole number"),
    ],
)
def test_a_row_that_makes_no_sense_is_named(
    change: dict[str, float | str], match: str, tmp_path: Path
) -> None:
    path = tmp_path / "camera.csv"
    table = camera_table(cameras(3)).astype(object)
    for name, value in change.items():
        table.loc[1, name] = value
    table.to_csv(path, index=False)
    with pytest.raises(InputError, match=match):
        read_cameras(path)


def test_a_mirrored_homography_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "camera.csv"
    table = camera_table(cameras(1))
    table[["h11", "h21", "h31"]] *= -1
    table.to_csv(path, index=False)
    with pytest.raises(InputError, match="mirrored"):
        read_cameras(path)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "not a table of cameras"),
        ("frame,h11,h12\n0,1,2\n1,1,2\n", "no column h13, h21"),
        ("stone,t,x,y\nA,0,0,0\n", "no column h11"),
        ("frame,h11,h11 \n0,1,1\n", "column h11 occurs twice"),
        ("a,b\n1,2,3\n1,2,3,4\n", "not a table of cameras|no column"),
        ("\x00\x01\x02", "not a table of cameras|no column"),
        (
            "frame," + ",".join(f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)) + "\n",
            "has no row",
        ),
    ],
)
def test_what_is_no_table_of_cameras_is_said_so(text: str, match: str, tmp_path: Path) -> None:
    path = tmp_path / "camera.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=match) as caught:
        read_cameras(path)
    assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match="no such file"):
        read_cameras(tmp_path / "none.csv")
    with pytest.raises(InputError, match="a folder"):
        read_cameras(tmp_path)
