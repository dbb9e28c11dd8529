"""Rendered clips of every kind that `curlshot.synthetic` draws, none longer than 2.5 s."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from curlshot.synthetic import (
    CameraPath,
    Graphic,
    Key,
    Scene,
    Start,
    broadcast_camera,
    cached_clip,
    frame_times,
    pictures,
    plain_pictures,
    random_scene,
    red_stone,
    still_camera,
    sweepers,
    tilted_camera,
    yellow_stone,
)
from curlshot.synthetic.conversion import held_at_end, interlaced, letterboxed, pulled_down
from curlshot.synthetic.physics import RADIUS

SECONDS = 2.4


@dataclass(frozen=True)
class Clip:
    """A scene, the camera that sees it, and how its frames are drawn and timed."""

    scene: Scene
    camera: CameraPath
    fps: float = 25.0
    times: tuple[float, ...] | None = None
    duration: float = SECONDS
    supersample: int = 1
    draw: Callable[..., Iterator[tuple[float, NDArray[np.uint8]]]] = pictures
    fields: bool = False

    def render(self) -> Path:
        """Render the clip, once per machine."""
        return cached_clip(
            self.scene, self.camera, fps=self.fps, duration=self.duration, times=self.times,
            supersample=self.supersample, draw=self.draw, fields=self.fields,
        )[0]  # fmt: skip


def thrown(seed: int, resting: int = 4, speed: float = 1.5) -> Scene:
    """Return a thrown stone that hits one of several."""
    return random_scene(np.random.default_rng(seed), resting=resting, speed=speed)


def panning(size: tuple[int, int] = (1280, 720)) -> CameraPath:
    """Return a broadcast camera that pans, zooms, rolls and shakes."""
    wide = size[0] / 1280
    return broadcast_camera(
        size=size, end=SECONDS, target=((0.05, 1.3), (0.1, 0.2)),
        px_per_m=(wide * 132, wide * 105), k1=(-0.03, -0.015), shake=0.3 * wide,
    )  # fmt: skip


def standing(size: tuple[int, int] = (1280, 720)) -> CameraPath:
    """Return a camera above the house that does not move."""
    return still_camera(
        size=size, position=(0.1, -0.2, 9.0), target=(0.0, 0.5), px_per_m=0.156 * size[1],
        k1=-0.02,
    )  # fmt: skip


def _tilted_moving() -> CameraPath:
    fixed = tilted_camera(np.radians(30), height=8.0)
    keys = (Key(-0.2, 0.2, 0.9, 125.0), Key(SECONDS + 0.2, -0.1, 0.1, 108.0, 0.02))
    return replace(fixed, keys=keys, shake=0.3)


def _swept() -> Scene:
    scene = thrown(5)
    return replace(scene, people=sweepers(scene, SECONDS), graphics=(Graphic(),))


def _no_hit() -> Scene:
    """Return a stone that glides past two others."""
    scene = thrown(8, resting=2)
    stones = (
        red_stone("A", Start(-0.5, 2.6, 0.05, -1.1, 0.5, 0.9)),
        yellow_stone("B", Start(0.7, 0.4, theta=2.0)),
        red_stone("C", Start(-1.3, -0.4, theta=4.0)),
    )
    return replace(scene, stones=stones)


def _frozen() -> Scene:
    """Return a stone that comes to rest against another."""
    scene = thrown(9, resting=2)
    slowing = 9.81 * scene.ice.friction(1.0)
    lasts = 0.75 * SECONDS
    away = 2 * RADIUS + 0.001 + 0.5 * slowing * lasts**2
    stones = (
        red_stone("A", Start(0.2, 0.4 + away, 0.0, -slowing * lasts, 0.5, 0.7)),
        yellow_stone("B", Start(0.2, 0.4, theta=2.0)),
        red_stone("C", Start(-0.9, 0.1, theta=4.0)),
    )
    return replace(scene, stones=stones)


def _touching() -> Scene:
    """Return a stone that hits one of a pair, whose stones touch."""
    scene = thrown(10, resting=2)
    apart = 2 * RADIUS + 2e-4
    stones = (
        red_stone("A", Start(-0.32, 2.0, 0.0, -1.6, 0.5, 0.8)),
        yellow_stone("B", Start(-0.25, 0.4, theta=2.0)),
        yellow_stone("C", Start(-0.25 + apart, 0.4, theta=1.0)),
        red_stone("D", Start(1.1, 0.9, theta=3.0)),
    )
    return replace(scene, stones=stones)


def _uneven() -> tuple[float, ...]:
    rng = np.random.default_rng(11)
    count = round(SECONDS * 30)
    dropped = rng.choice(np.arange(2, count), count // 6, replace=False).tolist()
    times = frame_times(30.0, SECONDS, dropped=dropped, jitter=0.3, rng=rng)
    return tuple(times.tolist())


def _plain() -> CameraPath:
    """Return a small frame, for that renderer is slow."""
    return replace(panning((640, 360)), shake=0.0)


CLIPS: dict[str, Callable[[], Clip]] = {
    "fixed": lambda: Clip(thrown(1), standing()),
    "moving": lambda: Clip(thrown(2, resting=6), panning()),
    "tilted": lambda: Clip(thrown(3), _tilted_moving(), supersample=2),
    "oblique": lambda: Clip(
        thrown(4), tilted_camera(np.radians(50), height=6.0, px_per_m=105.0), supersample=2
    ),
    "lines_360": lambda: Clip(thrown(6), standing((640, 360)), fps=50.0),
    "lines_1080": lambda: Clip(thrown(7, resting=3), panning((1920, 1080))),
    "occluded": lambda: Clip(_swept(), panning()),
    "sixteen_stones": lambda: Clip(thrown(16, resting=15), standing()),
    "no_hit_held_end": lambda: Clip(_no_hit(), panning(), draw=held_at_end),
    "frozen": lambda: Clip(_frozen(), standing()),
    "touching": lambda: Clip(_touching(), panning()),
    "plain_discs": lambda: Clip(thrown(12), _plain(), draw=plain_pictures),
    "variable_rate": lambda: Clip(thrown(13), panning(), fps=30.0, times=_uneven()),
    # The last of 74 frames repeats the one before it.
    "telecine": lambda: Clip(
        thrown(14), panning(), fps=30.0, duration=74 / 30, draw=pulled_down
    ),
    "lines_480_letterboxed": lambda: Clip(
        thrown(15), still_camera(
            size=(854, 480), position=(0.1, -0.2, 9.0), target=(0.0, 0.5), px_per_m=62.0
        ), draw=letterboxed,
    ),
    "interlaced": lambda: Clip(thrown(17), standing(), draw=interlaced, fields=True),
}  # fmt: skip
"""What gives a clip, by the name of its case."""
