"""Kinds of shots that occur, as short rendered clips whose truth is known.

Each differs in what is thrown, in who is in the way, in the camera or in the rate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from curlshot.data.sheet import STONE
from curlshot.synthetic import (
    CameraPath,
    Scene,
    Start,
    Stone,
    Truth,
    broadcast_camera,
    cached_clip,
    frame_times,
    pictures,
    plain_pictures,
    random_scene,
    sweepers,
    tilted_camera,
)
from curlshot.synthetic.stones import HEIGHT
from curlshot.vision.video.reader import Video, open_video

SECONDS = 2.6
RED, YELLOW, BLUE = (44, 26, 178), (38, 208, 226), (150, 70, 20)

Rng = np.random.Generator


@dataclass(frozen=True)
class Kind:
    """A kind of clip: its scene and camera drawn by chance, its rate, and the bar for places."""

    name: str
    scene: Callable[[Rng], Scene]
    camera: Callable[[Rng], CameraPath]
    rmse: float = 0.005
    fps: float = 25.0
    uneven: bool = False
    supersample: int = 1
    plain: bool = False


def overhead(rng: Rng, size: tuple[int, int] = (1280, 720)) -> CameraPath:
    """Broadcast camera near plumb over the tee that pans, zooms, rolls and shakes."""
    wide = size[0] / 1280
    return broadcast_camera(
        size=size,
        position=(*rng.uniform(-0.4, 0.4, 2).tolist(), float(rng.uniform(7.5, 10.5))),
        end=SECONDS,
        target=((0.05, float(rng.uniform(1.0, 1.6))), (0.1, float(rng.uniform(-0.1, 0.5)))),
        px_per_m=(wide * float(rng.uniform(115, 140)), wide * float(rng.uniform(95, 110))),
        k1=(float(rng.uniform(-0.08, 0.03)), float(rng.uniform(-0.05, 0.03))),
        shake=0.3,
        shake_phase=float(rng.uniform(0, 6)),
    )


def aslant(degrees: float) -> Callable[[Rng], CameraPath]:
    """Still camera that looks at the tee from so far off plumb."""

    def camera(rng: Rng) -> CameraPath:
        return tilted_camera(
            np.radians(degrees + rng.uniform(-2, 2)),
            height=float(rng.uniform(6.5, 9.5)) * float(np.cos(np.radians(degrees))) ** 0.5,
            px_per_m=float(rng.uniform(92, 108)),
            k1=float(rng.uniform(-0.04, 0.02)),
        )

    return camera


def shot(**more: object) -> Callable[[Rng], Scene]:
    """Give a thrown stone that hits one of several."""
    return lambda rng: random_scene(rng, **more)  # type: ignore[arg-type]


def swept(rng: Rng) -> Scene:
    scene = random_scene(rng, resting=6)
    return replace(scene, people=sweepers(scene, SECONDS))


def steep(rng: Rng) -> Scene:
    """Give handles that rise by 0.3 from their necks on, as goose-necks do; others are level."""
    scene = random_scene(rng)
    stones = tuple(replace(stone, steepness=0.3) for stone in scene.stones)
    return replace(scene, stones=stones)


def three_hits(rng: Rng) -> Scene:
    """Give three hits in a row down the sheet."""
    scene = random_scene(rng, resting=2, speed=2.2)
    x, y, fall = float(rng.uniform(-0.3, 0.3)), float(rng.uniform(1.5, 1.8)), []
    for _ in range(3):
        x, y = x + float(rng.uniform(-0.06, 0.06)), y - float(rng.uniform(0.45, 0.65))
        fall.append((x, y))
    start = Start(float(fall[0][0] + rng.uniform(-0.05, 0.05)), 2.6, 0.0, -2.2, 1.0, 1.4)
    stones = [Stone("A", start, RED)]
    for name, (px, py), cap in zip("BCD", fall, (YELLOW, RED, YELLOW), strict=True):
        stones.append(Stone(name, Start(px, py, theta=float(rng.uniform(0, 6))), cap))
    stones.append(Stone("E", Start(1.2, 0.9, theta=2.0), YELLOW))
    return replace(scene, stones=tuple(stones))


def freeze(rng: Rng) -> Scene:
    """Give a stone that comes to rest against another, and two that touch all the time."""
    scene = random_scene(rng, resting=2)
    slowing = 9.81 * scene.ice.friction(1.0)
    lasts = 0.75 * SECONDS
    speed, way = slowing * lasts, 0.5 * slowing * lasts**2
    away = 2 * STONE.radius + 0.001
    start = Start(0.2, 0.4 + away + way, 0.0, -speed, 0.5, float(rng.uniform(0.4, 1.0)))
    stones = (
        Stone("A", start, RED),
        Stone("B", Start(0.2, 0.4, theta=2.0), YELLOW),
        Stone("C", Start(-0.8, 0.1, theta=4.0), RED),
        Stone("D", Start(-0.8 + 2 * STONE.radius + 2e-4, 0.1, theta=1.0), RED),
    )
    return replace(scene, stones=stones)


KINDS: tuple[Kind, ...] = (
    Kind("overhead", shot(), overhead),
    Kind("ten stones", shot(resting=9), overhead),
    Kind("three hits", three_hits, overhead),
    Kind("equal colours", shot(caps=(BLUE, BLUE)), overhead),
    Kind("sweepers", swept, overhead),
    Kind("freeze", freeze, overhead),
    Kind("30 fps", shot(), overhead, fps=30.0),
    Kind("50 fps", shot(resting=4), overhead, fps=50.0),
    Kind("60 fps", shot(resting=4), overhead, fps=60.0),
    Kind("variable rate", shot(), overhead, fps=30.0, uneven=True),
    Kind("30 deg", shot(), aslant(30), rmse=0.010),
    Kind("50 deg", shot(), aslant(50), rmse=0.020, supersample=2),
    Kind("steep handles", steep, overhead),
    Kind("30 deg, steep handles", steep, aslant(30), rmse=0.010),
    Kind("1080p", shot(), lambda rng: overhead(rng, (1920, 1080))),
    Kind("plain", shot(), overhead, plain=True),
    Kind("plain, 30 deg", shot(), aslant(30), rmse=0.010, plain=True),
)


def as_made(scene: Scene, rng: Rng) -> Scene:
    """Draw what differs from house to house, from set to set of stones, and from film to film.

    The inner circles as houses have them: 14 that were measured have 1.207 to 1.224 and 0.606 to
    0.628 m; no outlines, or of 4 to 10 mm. Granite is at least 0.1143 m high (rule C1), caps end
    at about 0.12: a cap closes the gap to the granite as it is drawn with a side of 3 to 9 mm. Its
    radius is 0.1045 m or 1.5 mm less or more. A lens blurs light; where a computer made the picture
    smaller, codes are blurred.
    """
    _, *_, button = scene.paint.radii
    inner = float(rng.uniform(1.207, 1.224)), float(rng.uniform(0.606, 0.628))
    width = float(rng.choice([0.0, rng.uniform(0.004, 0.010)]))
    outline = scene.paint.outline or (60, 50, 50)
    paint = replace(
        scene.paint, radii=(1.829, *inner, button), outline=outline if width else None,
        outline_width=width,
    )  # fmt: skip
    wall, radius = float(rng.uniform(0.003, 0.009)), float(rng.uniform(0.103, 0.106))
    stones = tuple(
        replace(stone, wall=wall, cap_height=HEIGHT + wall, cap_radius=radius)
        for stone in scene.stones
    )
    light = replace(scene.light, power=float(rng.choice([1.0, 2.2])))
    return replace(scene, paint=paint, stones=stones, light=light)


def clip_of(kind: Kind, seed: int) -> tuple[Video, Truth]:
    """One clip of a kind, rendered once per machine."""
    rng = np.random.default_rng([seed, *kind.name.encode()])
    scene, camera = kind.scene(rng), kind.camera(rng)
    scene = as_made(scene, np.random.default_rng([seed, *kind.name.encode(), 1]))
    times = frame_times(kind.fps, SECONDS)
    if kind.uneven:
        dropped = rng.choice(np.arange(2, len(times)), len(times) // 6, replace=False)
        times = frame_times(kind.fps, SECONDS, dropped=dropped.tolist(), jitter=0.3, rng=rng)
    path, truth = cached_clip(
        scene, camera, fps=kind.fps, times=times, supersample=kind.supersample,
        draw=plain_pictures if kind.plain else pictures,
    )  # fmt: skip
    if kind.plain:  # flat discs: nothing shows how they turn
        truth = replace(truth, tracks=truth.tracks.assign(theta=np.nan, omega=np.nan))
    return open_video([path]), truth
