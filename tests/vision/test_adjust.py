from __future__ import annotations

import numpy as np

from tests.vision.cameras import SD, SIZE, marks, true_rig, views
from vision.adjust import solve
from vision.rig import OVERHEAD, R4, R8, start_rig


def test_stated_errors_of_the_rig_cover() -> None:
    rig, truth = true_rig(), views(8)
    inside, count = 0, 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        frames = [marks(rng, v.vector, rig, SD) for v in truth]
        solution = solve(frames, truth, start_rig(OVERHEAD), SIZE, prior=OVERHEAD, iterations=30)
        sd = np.sqrt(np.diag(solution.rig_cov))
        for which in (0, 1, 2, R8, R4):
            inside += abs(solution.rig[which] - rig[which]) < 2.2 * sd[which]
            count += 1
    assert inside / count > 0.85


def test_shared_errors_let_the_prior_hold() -> None:
    rng = np.random.default_rng(5)
    rig, truth = true_rig(), views(1)
    frames = [marks(rng, truth[0].vector, rig, SD)]
    alone = solve(frames, truth, start_rig(OVERHEAD), SIZE, prior=OVERHEAD, sharing=1)
    shared = solve(frames, truth, start_rig(OVERHEAD), SIZE, prior=OVERHEAD, sharing=50)
    assert (np.diag(shared.rig_cov)[:3] > np.diag(alone.rig_cov)[:3]).all()
    assert (np.sqrt(np.diag(shared.rig_cov)) <= OVERHEAD.sd * 1.001).all()
