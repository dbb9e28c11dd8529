from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.cli.main import main
from curlshot.pipeline import sample_clip
from curlshot.report.check import check_figure
from curlshot.report.looks import Look
from curlshot.tests.helpers.report.looking import SIZE, camera, stone, table
from curlshot.vision.detection.detection import Refusal
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.frame import Frame


def house_picture() -> np.ndarray:
    image = np.full((SIZE[1], SIZE[0], 3), 230, np.uint8)
    cv2.circle(image, (160, 120), round(50 * 1.829), (160, 60, 20), -1, cv2.LINE_AA)
    return image


def drawn_frame(figure, number: int) -> np.ndarray:
    frames = [ax for part in figure.subfigs for ax in part.axes if ax.images]
    return np.asarray(frames[number].images[0].get_array())


def test_the_model_is_drawn_where_the_camera_puts_it() -> None:
    look = Look(Frame(5, 0.2, house_picture()), camera(5), (), [Refusal(1.0, 0.5, 0.3, "a broom")])
    figure = check_figure([look], table(1, 0), (1.829, 1.2, 0.6))
    shown = drawn_frame(figure, 0)[..., ::-1].astype(int)
    slant = round(50 * 1.2 / np.sqrt(2))
    ring = shown[120 + slant, 160 + slant]
    assert ring[1] > 150, "the paint has 60 of green, the ring drawn on it 255"
    assert np.abs(shown[120 + 33, 160 + 33] - (160, 60, 20)).max() < 5, "nothing between rings"
    refused = shown[120 - 25 - 15 : 120 - 25 + 15, 210 - 15 : 210 + 15]
    assert ((refused[..., 2] > 150) & (refused[..., 0] < 120)).any()
    words = " ".join(part.get_supxlabel() for part in figure.subfigs)
    assert "a broom" in words


@pytest.mark.parametrize("sign", [1, -1])
def test_the_back_line_is_behind_the_tee_as_stones_come(sign: int) -> None:
    frames = (Frame(k, k / 25, house_picture()) for k in range(2))
    looks = [Look(f, camera(f.index), [stone(0.0, 0.5 * sign * f.index)]) for f in frames]
    above = check_figure(looks, table(2, 0), (1.829,)).subfigs[1].subfigs[0].axes[0]
    _, tee, back, *_ = (float(np.mean(line.get_ydata())) for line in above.lines)
    assert (tee, back) == pytest.approx((0.0, sign * 1.829), abs=1e-3)


def test_a_single_picture_is_large_and_has_no_course_in_time() -> None:
    look = Look(Frame(5, 0.2, house_picture()), camera(5), ())
    figure = check_figure([look], table(1, 0), (1.829,))
    picture, above = (ax for part in figure.subfigs for ax in part.axes)
    figure.draw_without_rendering()
    assert picture.get_window_extent().width > 1.5 * above.get_window_extent().width
    assert above.get_title("left") == "from above"


@pytest.mark.parametrize("turned", [False, True])
def test_frames_fill_the_width_of_the_sheet_whichever_side_is_longer(turned: bool) -> None:
    image = np.ascontiguousarray(np.rot90(house_picture())) if turned else house_picture()
    high, wide = image.shape[:2]
    seen = [replace(camera(k), size=(wide, high)) for k in range(12)]
    looks = [Look(Frame(k, k / 25, image), seen[k], ()) for k in range(12)]
    figure = check_figure(looks, table(12, 0), (1.829,))
    figure.draw_without_rendering()
    frames = [ax.get_window_extent() for ax in figure.subfigs[0].axes]
    assert sum(frame.width for frame in frames) > 0.85 * figure.bbox.width * 12 / (4 + 2 * turned)


def test_without_a_house_the_sheet_shows_the_table_and_no_empty_panel() -> None:
    """A puck 0.1 m beside the mark of the scale, in a picture 0.8 by 0.6 m."""
    image = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    cv2.circle(image, (140, 80), 10, (255, 255, 255), -1)
    homography = np.array([[400.0, 0, 100], [0, -400.0, 80], [0, 0, 1]])
    looks = [Look(Frame(k, k / 25, image), Camera(k, k / 25, homography, SIZE), ()) for k in (0, 1)]
    unknown = table(2, 0).assign(rms_px=np.nan, sd=0.0)
    figure = check_figure(looks, unknown, ())
    _, foot = figure.subfigs
    (above,) = foot.axes
    assert above.get_xlim() == pytest.approx((-0.25, 0.55), abs=0.02)
    assert above.get_ylim() == pytest.approx((-0.4, 0.2), abs=0.02)
    (shown,) = above.images
    picture = np.asarray(shown.get_array())
    rows, columns = np.nonzero(picture[..., 0] > 128)
    x0, x1, y0, y1 = shown.get_extent()
    x = x0 + (columns.mean() + 0.5) * (x1 - x0) / picture.shape[1]
    y = y1 - (rows.mean() + 0.5) * (y1 - y0) / picture.shape[0]
    assert (x, y) == pytest.approx((0.1, 0.0), abs=0.004)
    assert not foot.subfigs


def test_the_average_is_sharp_only_if_the_camera_was_followed() -> None:
    def sharpness(cameras: list[Camera]) -> float:
        looks = []
        for k in range(6):
            moved = np.roll(house_picture(), 4 * k, axis=1)
            looks.append(Look(Frame(k, k / 25, moved), cameras[k], ()))
        average = next(
            ax for ax in check_figure(looks, table(6, 0), (1.829,)).subfigs[1].subfigs[0].axes
        )
        picture = np.asarray(average.images[0].get_array()).astype(float)
        return float(np.abs(np.diff(picture[picture.shape[0] // 2], axis=0)).max())

    shift = np.eye(3)
    followed = []
    for k in range(6):
        shift[0, 2] = 4 * k
        c = camera(k)
        followed.append(Camera(k, c.t, shift @ c.homography, SIZE))
    assert sharpness(followed) > 1.3 * sharpness([camera(k) for k in range(6)])


def test_the_command_writes_the_sheet_whole(tmp_path, capsys) -> None:
    out = tmp_path / "out"
    assert main(["check", str(sample_clip()), "--frames", "0:30", "-o", str(out), "-q"]) == 0
    said = capsys.readouterr().out
    assert "carried over in 0" in said
    assert [item.name for item in out.iterdir()] == ["check.png"]
    assert cv2.imread(str(out / "check.png")).shape[1] > 1500


def test_a_table_of_tracks_is_no_clip(tmp_path, capsys) -> None:
    path = tmp_path / "tracks.csv"
    path.write_text("t,x,y\n0,0,0\n")
    assert main(["check", str(path), "-o", str(tmp_path / "out")]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
