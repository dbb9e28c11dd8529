from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.cameras import SD, SIZE, marks, true_rig, views
from curlshot.vision.optics.resection import solve_view


def test_stated_errors_of_a_view_are_the_scatter_of_its_fits() -> None:
    rng = np.random.default_rng(7)
    rig, view = true_rig(), views(1)[0]
    fits = [solve_view(marks(rng, view.vector, rig, SD), view, rig, SIZE) for _ in range(300)]
    scatter = np.cov(np.array([f.view.vector for f in fits]).T)
    stated = np.mean([f.cov for f in fits], axis=0)
    spread = np.sqrt(np.linalg.eigvalsh(np.linalg.solve(stated, scatter)))
    assert 0.8 < spread.min() < spread.max() < 1.2
