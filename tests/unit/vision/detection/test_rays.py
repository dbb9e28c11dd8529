from __future__ import annotations

import numpy as np

from curlshot.vision.detection.rays import Look, cameras_of, chained, sample_rays, straight
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.pose import aim, camera
from curlshot.vision.optics.rig import OVERHEAD, start_rig

SIZE = (480, 360)
POSITION = (0.4, -0.3, 6.0)


def overhead_camera() -> Camera:
    return camera(aim((240.0, 180.0), 90.0, POSITION, SIZE), start_rig(OVERHEAD, POSITION), SIZE)


def gradient() -> np.ndarray:
    """A picture whose colours tell where its pixels are."""
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    return np.stack([x / 2, y / 2, np.full_like(x, 90)], axis=-1).astype(np.uint8)


def test_rays_are_read_where_the_camera_shows_them() -> None:
    seen = overhead_camera()
    places = np.array([[0.2, -0.4], [-0.7, 0.5]])
    profile = straight([(0.05, 0.12), (0.2, 0.0)], np.linspace(0.05, 0.2, 16))
    looks = [Look(gradient(), seen, places)]
    rays = sample_rays(looks, cameras_of(looks), profile, 24)
    assert rays.inside.all()
    around = np.stack([np.cos(rays.angle), np.sin(rays.angle)], axis=-1)
    for index, height in ((0, 0.12), (15, 0.0)):
        ice = places[:, None] + around * rays.radius[index]
        there = seen.project(ice, height)
        np.testing.assert_allclose(rays.bgr[:, :, index, :2], there / 2, atol=1.1)
    assert (rays.bgr[..., 2] == 90).all()


def test_what_is_beside_the_picture_is_not_inside() -> None:
    seen = overhead_camera()
    edge = seen.ice([[SIZE[0] - 4.0, 180.0]])
    looks, profile = [Look(gradient(), seen, edge)], straight([(0.1, 0), (0.2, 0)], [0.1, 0.2])
    rays = sample_rays(looks, cameras_of(looks), profile, 4)
    assert rays.at(0.1)[0].tolist() == [False, True, True, True]


def test_chained_profiles_keep_the_samples_of_both() -> None:
    one = straight([(0.1, 0.0), (0.3, 0.2)], np.array([0.1, 0.2, 0.3]))
    two = straight([(0.4, 0.1), (0.6, 0.1)], np.array([0.45, 0.6]))
    both = chained(one, two)
    np.testing.assert_allclose(both.node_radius @ both.mix, both.radius, atol=1e-6)
    np.testing.assert_allclose(both.node_height @ both.mix, [0, 0.1, 0.2, 0.1, 0.1], atol=1e-6)
