"""Views of a house drawn by chance, beside those that are fixed (`curlshot.benchmarks.views`)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from curlshot.benchmarks.views import (
    OBLIQUE,
    OVERHEAD,
    TILTED,
    Clip,
    camera,
    clips,
    look,
    painted,
    plain_clips,
    scene,
)
from curlshot.synthetic import PAINTS, Key, sweepers


def random_clip(seed: int) -> Clip:
    """Draw a broadcast camera anywhere above the house, over any paint, with any lens."""
    rng = np.random.default_rng([seed, 3])

    def between(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    paint = painted(
        str(rng.choice(list(PAINTS))), between(1.207, 1.224), between(0.606, 0.628),
        float(rng.choice([0.0, between(0.13, 0.25)])),
        float(rng.choice([0.0, between(0.004, 0.01)])),
    )  # fmt: skip
    width, gap = between(0.006, 0.02), float(rng.choice([0.0, 0.0, 0.03]))
    pitch = between(4.7, 6.1)
    seen = scene(int(rng.integers(1000)), paint, line_width=width, line_gap=gap, pitch=pitch,
                 half_width=(between(2.16, 2.34), between(2.16, 2.34)))  # fmt: skip
    if rng.random() < 0.4:
        seen = replace(seen, people=sweepers(seen, 2.4))
    at = between(-0.4, 0.4), between(-0.5, 0.5), between(6, 11)
    scales, places = rng.uniform(110, 210, 2), rng.uniform([-0.3, -0.5], [0.3, 1.6], (2, 2))
    k1 = between(-0.11, 0.06)
    zoomed = k1 + 0.08 * float(np.log(scales[1] / scales[0]))
    k2, roll = between(0, 0.05), between(-0.05, 0.05)
    keys = (
        Key(0.0, *places[0], scales[0], roll, k1, k2),
        Key(2.4, *places[1], scales[1], roll + between(-0.02, 0.02), zoomed, k2),
    )
    light = replace(
        seen.light, gain=between(0.7, 1.05), noise=between(1, 4), vignette=between(0, 0.3)
    )
    return Clip(
        f"random-{seed}", replace(seen, light=light),
        camera(*keys[: int(rng.integers(1, 3))], at=at, shake=between(0, 1)),
        crf=int(rng.integers(18, 30)),
    )  # fmt: skip


def random_tilted_clip(seed: int) -> Clip:
    """Draw a slowly turning camera at 15° to 55°, from beyond the back line."""
    rng = np.random.default_rng([seed, 4])
    like = random_clip(seed + 5000)
    tilt = float(rng.uniform(15, 55))
    at = look(np.deg2rad(tilt), float(rng.uniform(4.5, 9)), float(rng.uniform(-0.7, 0.7)))
    scale = float(rng.uniform(95, 160))
    keys = tuple(
        Key(t, *rng.uniform([-0.3, -0.3], [0.3, 0.6]), scale * float(rng.uniform(0.9, 1.1)),
            float(rng.uniform(-0.03, 0.03)), float(like.camera.keys[0].k1))
        for t in (0.0, 2.4)
    )  # fmt: skip
    bar = float(np.interp(tilt, [0, 30, 50], [OVERHEAD, TILTED, OBLIQUE]))
    return replace(
        like, name=f"tilted-{seed} {tilt:.0f}°", camera=camera(*keys, at=at, shake=0.4), bar=bar,
        supersample=2,
    )  # fmt: skip


def named(kinds: Sequence[str], seeds: Sequence[int]) -> list[Clip]:
    """Pick clips by the beginnings of their names (all for none), random ones of these seeds."""
    drawing: tuple[Callable[[int], Clip], ...] = (random_clip, random_tilted_clip)
    everything = [*clips(), *plain_clips(), *(draw(seed) for draw in drawing for seed in seeds)]
    return [c for c in everything if not kinds or c.name.startswith(tuple(kinds))]
