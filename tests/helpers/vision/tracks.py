"""Detections along given paths, without pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from curlshot.vision.detection.detection import Detection

R = 0.1455
RED, YELLOW = np.array([90.0, 180.0, 150.0]), np.array([190.0, 120.0, 195.0])
Place = tuple[float, float]


def detection(place: Place, colour: np.ndarray = RED, score: float = 3.0) -> Detection:
    return Detection(
        *place, 0.002, 0.002, (0.001, 0.001), colour, 1.0, score, (1.0, 1.0), 0.0, (0.0,) * 6,
        (0.0, 0.0), 0.0,
    )  # fmt: skip


def clip(
    paths: Sequence[Callable[[float], Place | None]],
    seconds: float = 4.0,
    fps: float = 25.0,
    noise: float = 0.002,
    colours: Sequence[np.ndarray] | None = None,
) -> list[tuple[int, float, list[Detection]]]:
    rng = np.random.default_rng(3)
    frames = []
    for index in range(int(seconds * fps)):
        t = index / fps
        seen = []
        for number, path in enumerate(paths):
            place = path(t)
            if place is not None:
                x, y = np.array(place) + rng.normal(0, noise, 2)
                seen.append(detection((x, y), RED if colours is None else colours[number]))
        rng.shuffle(seen)
        frames.append((index, t, seen))
    return frames
