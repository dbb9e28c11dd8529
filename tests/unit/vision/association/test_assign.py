from __future__ import annotations

import numpy as np

from curlshot.vision.association.assign import assign


def test_a_row_gives_up_what_it_likes_best_where_that_is_cheaper_in_all() -> None:
    assert sorted(assign(np.array([[1.0, 2.0], [1.1, 9.0]]))) == [(0, 1), (1, 0)]
