from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.tracks import detection


def test_what_only_learning_needs_can_be_left_out() -> None:
    seen = detection((0.3, -0.2))._replace(
        cap_samples=np.ones((9, 3)), granite_samples=np.ones((5, 3))
    )
    left = seen.without_samples()
    assert left.cap_samples.size == left.granite_samples.size == 0
    assert left._replace(cap_samples=seen.cap_samples, granite_samples=seen.granite_samples) == seen
