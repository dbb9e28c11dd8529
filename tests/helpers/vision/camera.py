"""What tests of camera share."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from curlshot.vision.optics.camera import (
    Camera,
)

Array = NDArray[np.float64]
SIZE = (1280, 720)


class Pinhole:
    """A pinhole camera in three dimensions, to compare with: looks down, y of the ice up."""

    def __init__(self, place: tuple[float, float, float], pan: float, tilt: float, roll: float):
        down = np.diag([1.0, -1.0, -1.0])
        about_x = [[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]]
        about_y = [[np.cos(pan), 0, np.sin(pan)], [0, 1, 0], [-np.sin(pan), 0, np.cos(pan)]]
        about_z = [[np.cos(roll), -np.sin(roll), 0], [np.sin(roll), np.cos(roll), 0], [0, 0, 1]]
        self.turn = np.array(about_z) @ np.array(about_y) @ np.array(about_x) @ down
        self.place = np.array(place)
        self.f = 1500.0
        self.centre = np.array([(SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2])

    def pixels(self, xyz: Array) -> Array:
        seen = (xyz - self.place) @ self.turn.T
        return self.centre + self.f * seen[..., :2] / seen[..., 2:]

    def camera(self, k1: float = 0.0, k2: float = 0.0) -> Camera:
        inner = np.array([[self.f, 0, self.centre[0]], [0, self.f, self.centre[1]], [0, 0, 1]])
        to_ice = np.column_stack([self.turn[:, 0], self.turn[:, 1], -self.turn @ self.place])
        homography = inner @ to_ice
        return Camera(
            3, 0.12, homography / homography[2, 2], SIZE, k1, k2, self.f, position=self.place
        )


places = st.tuples(st.floats(-3, 3), st.floats(-3, 3))
