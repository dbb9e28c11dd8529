from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import HOUSE
from curlshot.tests.helpers.vision.cameras import ice_points
from curlshot.vision.optics.paint import CENTRE_LINE, CIRCLES, LEFT, RIGHT, TEE_LINE, TWELVE
from curlshot.vision.optics.pose import aim, project
from curlshot.vision.optics.rig import ANYWHERE, HOG_Y, OVERHEAD, start_rig
from curlshot.vision.optics.rig import POSITION as PLACE
from curlshot.vision.sheet.normals import OUTSIDE, lay_out
from curlshot.vision.sheet.stations import BLOCK, THIN

SIZE = (1280, 720)
POSITION = (0.1, -0.2, 8.5)
REACH = 9.0


def view(centre: tuple[float, float] = (640.0, 380.0), scale: float = 130.0) -> np.ndarray:
    return aim(centre, scale, POSITION, SIZE).vector


def rig() -> np.ndarray:
    found = start_rig(OVERHEAD, POSITION)
    found[3:6] = -0.06, 0.0, 0.02
    return found


@pytest.mark.parametrize("centre", [(640.0, 380.0), (100.0, 900.0)])
def test_normals_stand_on_their_lines_inside_the_picture(centre: tuple[float, float]) -> None:
    normals = lay_out(view(centre), rig(), SIZE, reach=REACH, most=48)
    along = normals.along
    places = [ice_points(normals.line, along + step, rig()) for step in (-1e-4, 0.0, 1e-4)]
    before, here, after = (project(place, view(centre), rig(), SIZE) for place in places)
    np.testing.assert_allclose(here, normals.point.T, atol=1e-9)
    tangent = after - before
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    np.testing.assert_allclose(np.linalg.norm(normals.normal, axis=0), 1)
    assert np.abs((tangent.T * normals.normal).sum(0)).max() < 0.02
    assert (normals.point > REACH).all()
    assert (np.array(SIZE) - 1 - REACH > normals.point.T).all()


def test_there_are_as_many_as_wanted_evenly_spread() -> None:
    normals = lay_out(view(), rig(), SIZE, reach=REACH, most=48)
    circle = normals.along[normals.kinds[TWELVE]]
    assert len(circle) == 48
    assert np.ptp(np.diff(circle)) < np.radians(1.1)
    for kind in THIN:
        if kind in normals.kinds:
            along = normals.along[normals.kinds[kind]].reshape(-1, BLOCK)
            assert np.ptp(along, axis=1).max() < BLOCK * 0.05
    assert (lay_out(view(), rig(), SIZE, reach=REACH, lines=False).kinds.keys()) == {0, 1, 2}


@pytest.mark.parametrize("end", [1.0, -1.0])
def test_lines_along_the_sheet_reach_to_the_hog_line(end: float) -> None:
    shared = rig()
    shared[HOG_Y] *= end
    normals = lay_out(view((640.0, 360.0), 40.0), shared, SIZE, reach=REACH, lines=True)
    for kind in (CENTRE_LINE, LEFT, RIGHT):
        assert (end * normals.along[normals.kinds[kind]]).max() > 6.4


def test_thin_lines_are_looked_at_closely_where_they_leave_the_house() -> None:
    normals = lay_out(view(), rig(), SIZE, reach=REACH, most=48)
    middles = normals.along[normals.kinds[TEE_LINE]].reshape(-1, BLOCK).mean(1)
    beyond = np.abs(middles) > HOUSE.twelve_foot
    assert beyond.sum() == 2 * np.count_nonzero(middles[beyond] > 0) >= 4
    assert (~beyond).sum() >= 3


def test_far_sides_are_looked_at_no_farther_than_they_are_wide() -> None:
    aslant = start_rig(OVERHEAD, (0.5, -6.0, 5.0))
    camera = aim((640.0, 460.0), 120.0, aslant[PLACE], SIZE).vector
    normals = lay_out(camera, aslant, SIZE, reach=REACH)
    for kind in (LEFT, RIGHT):
        side = normals.kinds[kind]
        place = ice_points(normals.line[side], normals.along[side], aslant)
        half = 0.05 * np.array([1.0, 0.0])
        ends = [project(place + way, camera, aslant, SIZE) for way in (-half, half)]
        wide = np.hypot(*(ends[1] - ends[0]).T) / 2
        assert wide.min() < 0.7 * REACH
        np.testing.assert_allclose(normals.reach[side], np.minimum(wide, REACH), rtol=0.08)
    assert (normals.reach[normals.kinds[TWELVE]] == REACH).all()


def test_a_side_is_looked_at_though_the_other_is_behind_the_camera() -> None:
    beside = start_rig(ANYWHERE, (2.0, 0.0, 1.0))
    camera = aim((1000.0, 500.0), 100.0, beside[PLACE], SIZE).vector
    assert np.isnan(project(np.array([[2.3, 0.0]]), camera, beside, SIZE)).all()
    normals = lay_out(camera, beside, SIZE, reach=REACH)
    assert np.isfinite(normals.samples[..., normals.kinds[LEFT]]).all()


def test_what_is_seen_of_each_circle_is_told() -> None:
    # The upper edge of the picture runs through the tee.
    normals = lay_out(view((640.0, 0.0)), rig(), SIZE, reach=REACH)
    assert normals.visible[:CIRCLES] == pytest.approx(0.5, abs=0.06)
    away = lay_out(view((640.0, 6000.0)), rig(), SIZE, reach=REACH, lines=False)
    assert not away.kinds


def test_normals_move_with_the_picture_until_they_leave_it() -> None:
    normals = lay_out(view(), rig(), SIZE, reach=REACH, most=48, lines=False)
    later = view((643.0, 376.0))
    moved = normals.moved(later, rig(), SIZE)
    assert moved is not None
    ring = normals.along[normals.kinds[TWELVE]]
    there = HOUSE.twelve_foot * np.stack([np.cos(ring), np.sin(ring)], 1)
    now, normal = moved[..., normals.kinds[TWELVE]]
    np.testing.assert_allclose(now.T, project(there, later, rig(), SIZE), atol=1e-9)
    anew = lay_out(later, rig(), SIZE, reach=REACH, most=48, lines=False)
    np.testing.assert_allclose(normal, anew.normal[:, anew.kinds[TWELVE]], atol=2e-3)
    assert normals.moved(view((700.0, 380.0)), rig(), SIZE) is None
    edge = lay_out(view((640.0, 0.0)), rig(), SIZE, reach=REACH, lines=False)
    a_little = edge.moved(view((640.0, -5.0)), rig(), SIZE)
    assert a_little is not None
    assert 0 < (a_little[0] == OUTSIDE).mean() < 0.1
    assert edge.moved(view((640.0, -30.0)), rig(), SIZE) is None
