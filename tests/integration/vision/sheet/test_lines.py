from __future__ import annotations

import cv2
import numpy as np
import pytest

from curlshot.synthetic import PAINTS, Scene, render_still, still_camera
from curlshot.vision.optics.pose import View, project, turned
from curlshot.vision.optics.rig import OVERHEAD, SIDE_L, SIDE_R, start_rig
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.lines import back_end, sides, upright

SIZE = (960, 540)
SCALE = 90.0


def level() -> tuple[View, np.ndarray]:
    rig = start_rig(OVERHEAD, (0.0, 0.0, 9.0))
    rig[3:6] = 0
    return View(np.array([0.0, 0.0, 0.0, np.log(SCALE * 9)])), rig


def picture(paint: str, roll: float = 0.0) -> np.ndarray:
    path = still_camera(size=SIZE, position=(0, 0, 9.0), target=(0, 0), px_per_m=SCALE, roll=roll)
    return render_still(Scene(paint=PAINTS[paint]), path)


@pytest.mark.parametrize("paint", ["teal-red", "navy-orange", "grey-red"])
@pytest.mark.parametrize("angle", [-0.2, 0.03, 0.3])
def test_lines_give_the_rotation(paint: str, angle: float) -> None:
    view, rig = turned(*level(), angle)
    found, _ = upright(picture(paint), view, rig)
    assert abs(found.vector[2]) < np.radians(0.3)


def test_black_lines_that_end_at_the_house_give_the_rotation() -> None:
    view, rig = level()
    image = np.full((SIZE[1], SIZE[0], 3), 230, np.uint8)
    for ends in ([[0.0, -2.7], [0.0, 2.7]], [[-2.3, 0.0], [2.3, 0.0]]):
        first, last = np.round(project(np.array(ends), view.vector, rig, SIZE)).astype(int)
        cv2.line(image, first.tolist(), last.tolist(), (30, 30, 30), 2, cv2.LINE_AA)
    tee = np.round(project(np.zeros((1, 2)), view.vector, rig, SIZE)[0]).astype(int)
    cv2.circle(image, tee.tolist(), round(1.829 * SCALE), (120, 50, 40), -1, cv2.LINE_AA)
    found, _ = upright(image, *turned(view, rig, 0.06))
    assert abs(found.vector[2]) < np.radians(0.3)


@pytest.mark.parametrize("noise", [1, 6])
def test_without_lines_nothing_turns(noise: int) -> None:
    view, rig = level()
    plain = np.full((SIZE[1], SIZE[0], 3), 220, np.uint8)
    noisy = plain + np.random.default_rng(0).integers(0, noise, plain.shape, dtype=np.uint8)
    found, same = upright(noisy, view, rig)
    np.testing.assert_array_equal(found.vector, view.vector)
    np.testing.assert_array_equal(same, rig)


def test_sides_are_found_where_they_are() -> None:
    view, rig = level()
    found = sides(picture("teal-red"), view, rig)
    assert found[SIDE_L] == pytest.approx(-2.375, abs=0.03)
    assert found[SIDE_R] == pytest.approx(2.36, abs=0.03)
    blank = np.full((SIZE[1], SIZE[0], 3), 220, np.uint8)
    np.testing.assert_array_equal(sides(blank, view, rig), rig)


@pytest.mark.parametrize("turn", [1.35, -1.35, np.pi / 2 + 0.1])
def test_the_sheets_sides_tell_centre_line_from_tee_line(turn: float) -> None:
    found, _ = upright(picture("teal-red", turn), *level())
    # What matters is the axis: which end is up, the picture says.
    assert abs(np.sin(found.vector[2] - turn)) < np.sin(np.radians(0.4))


@pytest.mark.parametrize("turn", [0.8, -1.2, 3.0])
def test_up_is_up_in_the_picture_however_the_circles_were_fitted(turn: float) -> None:
    bare = picture("teal-red")
    bare[:, :215] = bare[:, -215:] = bare[0, SIZE[0] // 3]
    found, _ = upright(bare, *turned(*level(), turn))
    assert abs(found.vector[2]) < np.radians(0.4)


@pytest.mark.parametrize("ahead", [-0.9, 0.9])
def test_from_beside_the_sheet_y_points_away_from_the_back_line(ahead: float) -> None:
    # Now one end of the sheet is higher in the picture, now the other.
    path = still_camera(
        size=SIZE[::-1], position=(5.5, ahead, 5.5), target=(0.0, 0.3), px_per_m=SCALE
    )
    lying = render_still(Scene(paint=PAINTS["navy-orange"]), path)
    found = find_house(np.asarray(np.rot90(lying, -1), np.uint8).copy())
    assert found is not None
    across, down = path.at(0.0).project(np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])).T
    seen = np.stack([SIZE[0] - 1 - down, across], axis=-1)
    np.testing.assert_allclose(found.camera.ice(seen), [[0.0, 1.0], [1.0, 0.0]], atol=0.02)


def test_the_back_line_is_at_one_end() -> None:
    view, rig = level()
    assert back_end(picture("teal-red"), view, rig) == -1
    assert back_end(picture("teal-red"), *turned(view, rig, np.pi)) == 1
    assert back_end(np.full((SIZE[1], SIZE[0], 3), 220, np.uint8), view, rig) == 0


@pytest.mark.parametrize("turn", [-0.2, 0.01, 0.4])
def test_where_no_line_is_seen_the_sheets_sides_give_the_rotation(turn: float) -> None:
    view, rig = level()
    image = np.full((SIZE[1], SIZE[0], 3), 60, np.uint8)
    corners = np.array([[-2.3, -4.0], [2.3, -4.0], [2.3, 4.0], [-2.3, 4.0]])
    corners = np.round(project(corners, view.vector, rig, SIZE)).astype(int)
    cv2.fillPoly(image, [corners], (225, 225, 225))
    # A broom handle across the tee is no line.
    handle = np.round(project(np.array([[0.1, 0.3], [0.4, 1.2]]), view.vector, rig, SIZE))
    cv2.line(image, *handle.astype(int).tolist(), (40, 40, 40), 2, cv2.LINE_AA)
    spun = cv2.warpAffine(
        image, cv2.getRotationMatrix2D((479.5, 269.5), np.degrees(turn), 1.0), SIZE,
        borderValue=(60, 60, 60),
    )  # fmt: skip
    noise = np.random.default_rng(0).integers(0, 12, spun.shape, dtype=np.uint8)
    found, _ = upright(spun + noise, *level())
    assert abs(found.vector[2]) == pytest.approx(abs(turn), abs=np.radians(0.4))
