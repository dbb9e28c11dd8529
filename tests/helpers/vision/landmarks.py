"""A scene with a graphic, and the true views of its camera."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.synthetic import Graphic, broadcast_camera, sample_scene
from curlshot.synthetic.camera import CameraPath
from curlshot.vision.optics.paint import fixed
from curlshot.vision.optics.pose import View, project
from curlshot.vision.optics.resection import solve_view
from curlshot.vision.optics.rig import OVERHEAD, start_rig

SIZE = (1280, 720)
PATH = broadcast_camera(start=0.0, end=6.0, target=((0.0, 4.2), (0.3, 3.4)), shake=0.0)
SCENE = replace(sample_scene(), graphics=(Graphic(40, 30, row=34),))


def truth(path: CameraPath, t: float) -> tuple[View, np.ndarray]:
    """The library's parameters of the camera that renders."""
    true = path.at(t)
    rig = start_rig(OVERHEAD, true.position)
    rig[3:6] = 0
    start = View(np.array([0.0, 0.0, 0.0, np.log(true.focal)]))
    ice = np.stack(np.meshgrid([-1.5, 0, 1.5], [3.0, 4.0, 5.0]), axis=-1).reshape(-1, 2)
    pixels = true.project(np.c_[ice, np.zeros(len(ice))])
    view = solve_view(
        fixed(ice, pixels, 0.1), start, rig, SIZE, view_sd=np.full(4, np.inf), width=1e4,
        iterations=50,
    ).view  # fmt: skip
    assert np.abs(project(ice, view.vector, rig, SIZE) - pixels).max() < 0.01
    return view, rig
