from __future__ import annotations

import numpy as np
import pytest

from tests.synthetic.clip import render_still
from tests.vision.test_follow import sighting
from tests.vision.test_stones import CAMERA, YELLOW, camera_of, scene_of
from tests.vision.test_stones import RED as SCARLET
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


@pytest.mark.parametrize("share", [1.0, 0.4, 0.2])
def test_stones_are_found_in_dim_pictures_as_in_bright_ones(share: float) -> None:
    places = [(0.3, 0.2), (-0.8, 1.0), (0.9, -0.6), (-0.2, -1.4)]
    scene = scene_of(
        [(*place, colour) for place, colour in zip(places, [SCARLET, YELLOW] * 2, strict=True)]
    )
    picture = np.asarray(render_still(scene, CAMERA) * share, np.uint8)
    (found,) = glance([(picture, camera_of(CAMERA, scene))])
    seen = np.array([(stone.x, stone.y) for stone in found.stones])
    assert len(seen) == len(places)
    np.testing.assert_allclose(
        seen[np.lexsort(seen.T)], sorted(places, key=lambda p: p[::-1]), atol=0.004
    )
