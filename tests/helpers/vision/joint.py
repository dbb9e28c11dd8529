"""What tests of joint share."""

from __future__ import annotations

import numpy as np

from curlshot.synthetic.camera import Lens
from curlshot.synthetic.camera import View as TrueView
from curlshot.tests.helpers.vision.clip_marks import SIZE, seen_marks
from curlshot.vision.camera_path.joint import Seen
from curlshot.vision.optics.pose import View
from curlshot.vision.video.disk_cache import Cached

HOUSE = np.array([(x, y) for x in np.linspace(-1.5, 1.5, 5) for y in np.linspace(-1.5, 1.5, 5)])


def true_view(x: float, focal: float) -> TrueView:
    """A camera 9 m above a place beside the tee, tilted a little, by its own arithmetic."""
    c, s = np.cos(0.1), np.sin(0.1)
    look = np.array([[1, 0, 0], [0, -c, -s], [0, s, -c]])
    return TrueView(np.array([x, -0.3, 9.0]), look, focal, Lens(SIZE, -0.03, 0.01))


def clip(
    rng: np.random.Generator, kinds: int = 5, noise: float = 0.2, count: int = 8, zoom: float = 30.0
) -> list[Seen]:
    found = []
    for k in range(count):
        true = true_view(0.1, 950.0 + zoom * k)
        start = View(np.array([-0.1, 0.0, 0.0, np.log(true.focal)]))
        found.append(Seen(k, k / 25, start, Cached(seen_marks(true, rng, kinds, noise)), True))
    return found
