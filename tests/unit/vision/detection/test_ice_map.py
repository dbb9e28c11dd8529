from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.detection.ice_map import rectify
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.pose import View, camera
from curlshot.vision.optics.rig import OVERHEAD, start_rig

SIZE, HEIGHT = (1280, 720), 8.0
RIG = start_rig(OVERHEAD, (0.3, -0.2, HEIGHT))


def drawn(focal: float, turn: float, height: float) -> tuple[np.ndarray, Camera, np.ndarray]:
    """A picture with a blot at a place this high above the ice, its camera and that place."""
    look = camera(View(np.array([0.05, 0.02, turn, np.log(focal)])), RIG, SIZE)
    place = np.array([0.45, 0.62])
    u, v = look.project(place[None], height)[0]
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    blot = 200 * np.exp(-0.5 * ((x - u) ** 2 + (y - v) ** 2) / 3.0**2)
    return np.repeat(blot[..., None], 3, 2).astype(np.uint8), look, place


@pytest.mark.parametrize("height", [0.0, 0.12])
@pytest.mark.parametrize("scale", [45.0, 80.0])
def test_a_blot_lies_on_the_map_where_it_lies_on_the_ice(height: float, scale: float) -> None:
    image, look, place = drawn(900.0, 0.4, height)
    ice = rectify(image, look, (-1.5, 1.5, -1.0, 2.0), scale=scale, height=height)
    assert ice is not None
    light = ice.image[..., 0].astype(float)
    row, column = np.indices(light.shape)
    middle = np.array([(light * column).sum(), (light * row).sum()]) / light.sum()
    np.testing.assert_allclose(ice.place(middle[0], middle[1]), place, atol=0.1 / scale)


def test_what_the_picture_does_not_show_is_not_valid_or_not_on_the_map() -> None:
    image, look, _ = drawn(900.0, 0.0, 0.0)
    ice = rectify(image, look, (-9.0, 9.0, -9.0, 9.0), scale=30.0)
    assert ice is not None
    row, column = np.indices(ice.valid.shape)
    seen = look.project(ice.place(column, row))
    inside = np.all((seen > 1) & (seen < np.array(SIZE) - 2), axis=-1)
    outside = np.any((seen < -2) | (seen > np.array(SIZE) + 1), axis=-1)
    assert ice.valid[inside].all()
    assert not ice.valid[outside].any()
    assert rectify(image, look, (50.0, 52.0, 0.0, 2.0), scale=30.0) is None
