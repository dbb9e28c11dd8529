"""Rendered pictures of stones at known places, and what is found in them."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.synthetic.camera import CameraPath, still_camera
from curlshot.synthetic.clip import describe, render_still
from curlshot.synthetic.physics import Start
from curlshot.synthetic.scene import Colour, Scene, Stone
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.stones import SEARCH, Search, search_picture
from curlshot.vision.optics.camera import Camera

RED, YELLOW, BLUE = (30, 24, 150), (20, 190, 220), (170, 80, 30)
CAMERA = still_camera(px_per_m=140.0, target=(0.0, 0.6))


def camera_of(path: CameraPath, scene: Scene) -> Camera:
    row = describe(scene, path, [0.0]).camera.iloc[0]
    matrix = np.array([[row[f"h{i}{j}"] for j in (1, 2, 3)] for i in (1, 2, 3)])
    place = row[["cam_x", "cam_y", "cam_z"]].to_numpy(float)
    return Camera(0, 0.0, matrix, path.size, row["k1"], row["k2"], row["f_px"], place)


def scene_of(places: list[tuple[float, float, Colour]], **more: object) -> Scene:
    stones = tuple(
        Stone(str(n), Start(x, y, theta=float(n)), cap) for n, (x, y, cap) in enumerate(places)
    )
    return replace(Scene(stones=stones), **more)  # type: ignore[arg-type]


def look(scene: Scene, path: CameraPath = CAMERA, search: Search = SEARCH) -> tuple[Detection, ...]:
    image = np.asarray(render_still(scene, path), np.uint8)
    return search_picture(image, camera_of(path, scene), search=search).stones


def misses(found: tuple[Detection, ...], scene: Scene) -> NDArray[np.float64]:
    """Distance of each true stone to the nearest detection, m."""
    seen = np.array([(s.x, s.y) for s in found]).reshape(-1, 2)
    true = np.array([(s.start.x, s.start.y) for s in scene.stones])
    return np.asarray(np.hypot(*(true[:, None] - seen[None]).transpose(2, 0, 1)).min(1))


def without_colours(scene: Scene, path: CameraPath = CAMERA) -> NDArray[np.uint8]:
    grey = cv2.cvtColor(np.asarray(render_still(scene, path), np.uint8), cv2.COLOR_BGR2GRAY)
    return np.repeat(grey[..., None], 3, axis=2)
