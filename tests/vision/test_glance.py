from __future__ import annotations

import numpy as np
import pytest

from tests.vision.test_follow import sighting
from vision import glance as module
from vision.camera import Camera
from vision.glance import glance
from vision.sighting import Refusal, Sighting
from vision.stones import Findings

RED, BLUE = np.array([120.0, 190.0, 165.0]), np.array([50.0, 140.0, 92.0])


def stone(x: float, colour: np.ndarray, score: float) -> Sighting:
    around = np.zeros((20, 3))
    return sighting((x, 0.0), colour, score)._replace(
        cap_samples=around + colour, granite_samples=around + np.array([90.0, 128.0, 128.0])
    )


def test_a_stone_of_another_colour_stays_though_it_convinces_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = (
        stone(0.0, RED, 2.0), stone(0.6, BLUE, 1.2), stone(1.2, RED, 1.1), stone(0.1, BLUE, 1.1),
    )  # fmt: skip

    def search(image: object, camera: object, appearance: object, disc: object) -> Findings:
        assert appearance is not None
        refused = tuple(
            Refusal(s.x, s.y, 0.4, "too little of a stone about it") for s in first[1:3]
        )
        return Findings(first[:1], refused)

    monkeypatch.setattr(module, "strangers", lambda views, disc, search: [Findings(first)])
    monkeypatch.setattr(module, "search_picture", search)
    (found,) = glance([(np.zeros((4, 4, 3), np.uint8), Camera(0, 0.0, np.eye(3), (4, 4)))])
    assert [s.x for s in found.stones] == [0.0, 0.6]
    assert [place.x for place in found.refused] == [1.2]  # what is taken is not refused too
