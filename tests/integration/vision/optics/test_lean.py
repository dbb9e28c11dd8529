from __future__ import annotations

import numpy as np
import pytest

from curlshot.synthetic import CameraPath, Key
from curlshot.tests.helpers.vision.clip_marks import seen_marks
from curlshot.vision.optics.adjust import solve
from curlshot.vision.optics.lean import fit_leaning
from curlshot.vision.optics.pose import aim
from curlshot.vision.optics.rig import ANYWHERE, OVERHEAD, POSITION, start_rig

SIZE = (1280, 720)


@pytest.mark.parametrize("place", [(0.3, 3.0, 9.0), (-2.5, -1.5, 8.0), (0.2, -0.1, 8.5)])
def test_it_leans_as_the_camera_does_from_wherever_it_begins(
    place: tuple[float, float, float],
) -> None:
    rng = np.random.default_rng(2)
    keys = [(0.1, 1.3, 95.0), (0.0, 0.6, 100.0), (0.1, 0.2, 120.0)]
    paths = [CameraPath(SIZE, place, (Key(0.0, *key),)) for key in keys]
    true = [path.at(0.0) for path in paths]
    frames = [seen_marks(view, rng, 5, 0.05) for view in true]
    above = (0.0, 0.0, 8.5)
    views = [aim(v.project([[0.0, 0.0, 0.0]])[0], v.scale(0, 0), above, SIZE) for v in true]
    rig = start_rig(OVERHEAD, above)
    found = fit_leaning(frames, views, rig, SIZE)
    np.testing.assert_allclose(found.rig[POSITION], place, atol=0.15)
    alone = solve(frames, views, rig, SIZE, prior=ANYWHERE, iterations=40)
    assert found.cost <= alone.cost
