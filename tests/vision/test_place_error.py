from __future__ import annotations

import json

import numpy as np
import pytest

import pipeline
from vision.camera import GRID_X, GRID_Y, Camera, PlaceError
from vision.clip import open_clip
from vision.follow_house import follow_house

SAMPLE = pipeline.sample_clip()


def true_camera(index: int) -> Camera:
    facts = json.loads(SAMPLE.with_suffix(".truth.json").read_text())
    row = {
        key: column[index] for key, column in facts["camera"].items() if isinstance(column, list)
    }
    matrix = np.array([[row.get(f"h{i}{j}", 1.0) for j in (1, 2, 3)] for i in (1, 2, 3)])
    return Camera(index, 0.0, matrix, tuple(facts["size"]), row["k1"], row["k2"])


def test_stated_error_covers_the_true_one() -> None:
    ratios, sizes = [], []
    house = np.array([(x, y) for x in np.linspace(-1.8, 1.8, 7) for y in np.linspace(-1.8, 3, 9)])
    for camera in follow_house(open_clip([SAMPLE])).cameras[::20]:
        pixels = true_camera(camera.frame).project(house)
        shown = ((pixels > 0) & (pixels < camera.size)).all(-1)
        off = (camera.ice(pixels) - house)[shown]
        sd = camera.place_sd(house[shown])
        ratios.append((off / sd[:, None]).ravel())
        sizes.append(sd)
    assert np.mean(np.abs(np.concatenate(ratios)) < 2) > 0.9
    assert np.median(np.concatenate(sizes)) < 0.005


def test_interpolated_between_and_held_beyond() -> None:
    error = PlaceError(np.hypot(*np.meshgrid(GRID_X, GRID_Y)))
    assert error.at((GRID_X[2], GRID_Y[3])) == pytest.approx(np.hypot(GRID_X[2], GRID_Y[3]))
    assert error.at((0.4, -4.0)) == pytest.approx((4.0 + np.hypot(0.8, 4)) / 2)
    assert error.at((0.0, 99.0)) == pytest.approx(8.0)
    assert error.at(np.zeros((5, 2))).shape == (5,)
    assert error.grown(3.0).at((0.0, -4.0)) == pytest.approx(5.0)
