from __future__ import annotations

import numpy as np

from vision.clip import Frame
from vision.edge_tracker import EdgeTracker
from vision.outline import Rim
from vision.paint import FIXED, joined
from vision.piece import Piece
from vision.pose import aim
from vision.rig import OVERHEAD, start_rig

SIZE = (640, 360)
POSITION = (0.0, 0.0, 8.5)


def test_a_house_that_was_found_ends_the_row_of_frames_that_missed_it() -> None:
    rig = start_rig(OVERHEAD, POSITION)
    view = aim((320.0, 180.0), 75.0, POSITION, SIZE)
    edges = EdgeTracker(SIZE, np.full((FIXED, 2, 3), np.nan), Rim())
    piece = Piece(SIZE, rig, OVERHEAD, edges)
    bare = [Frame(i, i / 25, np.full((SIZE[1], SIZE[0], 3), 230, np.uint8)) for i in range(3)]
    piece.missed = 20
    placed = piece.enter(bare[2], view, joined([]), bare[:2])
    assert placed[-1][0] is bare[2] and placed[-1][1].found
    assert piece.missed == 0
