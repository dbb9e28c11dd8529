from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from curlshot.config import Config
from curlshot.data.errors import InputError
from curlshot.data.sheet import STONE
from curlshot.vision.measure import check_size, disc_of, track_camera
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.reader import open_video


def camera(pixels_a_metre: float) -> Camera:
    homography = np.diag([pixels_a_metre, -pixels_a_metre, 1.0])
    homography[:2, 2] = 320, 240
    return Camera(0, 0.0, homography, (640, 480))


@pytest.mark.parametrize(("scale", "fine"), [(5.0, False), (50.0, True), (5000.0, False)])
def test_discs_are_more_than_a_dot_and_less_than_the_picture(scale: float, fine: bool) -> None:
    if fine:
        check_size(STONE.radius, camera(scale))
    else:
        with pytest.raises(InputError, match="verify `radius`"):
            check_size(STONE.radius, camera(scale))


@pytest.mark.parametrize("radius", [0.05, 0.115, 0.291])
def test_what_is_no_stone_by_its_radius_is_not_looked_for_in_a_house(radius: float) -> None:
    with pytest.raises(
        InputError, match=rf"radius {radius:g} m: in a house .* `stick` or `camera`"
    ):
        disc_of(Config().replace(radius=radius))
    assert disc_of(Config().replace(radius=0.12)).radius == 0.12
    assert disc_of(Config().replace(radius=radius, camera=Path("camera.csv"))).cap_radius == 0.0


def test_stones_are_looked_for_in_a_house_and_discs_elsewhere() -> None:
    assert disc_of(Config()) == STONE
    assert disc_of(Config().replace(radius=0.14)).cap_height == STONE.cap_height
    stick = Config().replace(stick=(0.0, 0.0, 10.0, 0.0, 1.0), radius=0.0382)
    assert (disc_of(stick).radius, disc_of(stick).cap_height) == (0.0382, 0.0)
    camera_and_size = Config().replace(camera=Path("camera.csv"), radius=0.0382)
    assert disc_of(camera_and_size).cap_height == 0.0
    assert disc_of(Config().replace(camera=Path("camera.csv"))) == STONE
    # Stones are not all as large as the rules allow.
    smaller = disc_of(Config().replace(camera=Path("camera.csv"), radius=0.145))
    assert (smaller.radius, smaller.cap_height) == (0.145, STONE.cap_height)


def test_a_stick_gives_the_scale_and_no_house(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    cv2.imwrite(str(path), np.full((120, 160, 3), 90, np.uint8))
    settings = Config().replace(stick=(20.0, 20.0, 120.0, 20.0, 0.5), radius=0.05)
    seen = track_camera(open_video([path]), settings)
    assert seen.house is None
    ice = seen.cameras[0].ice(np.array([[20.0, 20.0], [120.0, 20.0]]))
    assert np.hypot(*np.diff(ice, axis=0)[0]) == pytest.approx(0.5)


def test_frames_of_which_none_can_be_read_are_refused(tmp_path: Path) -> None:
    files = (tmp_path / "a.png", tmp_path / "b.png")
    cv2.imwrite(str(files[0]), np.full((120, 160, 3), 90, np.uint8))
    files[1].write_bytes(b"no picture")
    settings = Config().replace(stick=(20.0, 20.0, 120.0, 20.0, 0.5), frames=(1, 1))
    with pytest.raises(InputError, match="none of the selected frames can be read"):
        track_camera(open_video(files, settings.video), settings)


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["a.xlsx"], "a spreadsheet; save it as CSV"),
        (["a.csv"], "not a clip"),
        (["a.trk", "b.mp4"], "not a clip"),
    ],
)
def test_what_is_no_clip_is_refused(names: list[str], said: str) -> None:
    with pytest.raises(InputError, match=said):
        open_video([*map(Path, names)])
