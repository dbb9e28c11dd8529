"""Views of a house that the camera must master, as short rendered clips whose truth is known.

Each varies what the camera does or what is seen; paint, lines and stones differ as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from curlshot.synthetic import (
    PAINTS,
    CameraPath,
    Cut,
    Key,
    Light,
    Paint,
    Person,
    Scene,
    Truth,
    cached_clip,
    pictures,
    plain_pictures,
    random_scene,
    sweepers,
)
from curlshot.synthetic.travelling import Travelling

OVERHEAD, TILTED, OBLIQUE = 2.0, 5.0, 10.0
"""Largest RMS error of ice points in the house, mm: from overhead, at 30°, at 50°."""

WIDTH, HEIGHT = 1280, 720

WHITE = PAINTS["navy-orange"].eight


@dataclass(frozen=True)
class Clip:
    """What is seen, by which camera, and how well it must be measured (`bar`, mm)."""

    name: str
    scene: Scene
    camera: CameraPath
    bar: float = OVERHEAD
    duration: float = 2.4
    fps: float = 25.0
    crf: int = 21
    shutter: float = 0.01
    supersample: int = 1
    draw: Callable[..., Iterator[tuple[float, NDArray[np.uint8]]]] = pictures

    def render(self, height: int) -> tuple[Path, Truth]:
        """Render the clip at this height of the picture, px: 720 or 1080."""
        return cached_clip(
            enlarged_cuts(self.scene, height / HEIGHT), enlarged(self.camera, height / HEIGHT),
            fps=self.fps, duration=self.duration, shutter=self.shutter, crf=self.crf,
            supersample=self.supersample, draw=self.draw,
        )  # fmt: skip


def enlarged(camera: CameraPath, factor: float) -> CameraPath:
    """Give the same camera so many times more pixels."""
    return replace(
        camera,
        size=(round(camera.size[0] * factor), round(camera.size[1] * factor)),
        keys=tuple(replace(k, px_per_m=k.px_per_m * factor) for k in camera.keys),
        shake=camera.shake * factor,
    )


def enlarged_cuts(scene: Scene, factor: float) -> Scene:
    """Give the other cameras that a scene is cut to as many more pixels."""
    cuts = (c if c.camera is None else replace(c, camera=enlarged(c.camera, factor))
            for c in scene.cuts)  # fmt: skip
    return replace(scene, cuts=tuple(cuts))


def painted(
    name: str,
    eight: float = 1.212,
    four: float = 0.618,
    button: float = 0.16,
    outline: float = 0.0,
    outline_at: float = -0.5,
) -> Paint:
    """One of the schemes of paint with these radii and outlines, m; 0 for none."""
    base = PAINTS[name]
    return replace(
        base, radii=(1.829, eight, four, button), logo=base.logo if button > 0.12 else "",
        outline=(base.outline or (60, 50, 50)) if outline else None, outline_width=outline,
        outline_at=outline_at,
    )  # fmt: skip


def scene(seed: int, paint: Paint, resting: int = 5, **sheet: object) -> Scene:
    """Stones drawn from `seed` on a sheet with this paint, changed in what is named."""
    drawn = random_scene(np.random.default_rng(seed), resting=resting, paint=paint)
    return replace(drawn, sheet=replace(drawn.sheet, **sheet))


def camera(
    *keys: Key, at: tuple[float, float, float] = (-0.1, -0.15, 8.6), shake: float = 0.2
) -> CameraPath:
    """Put a camera on its mount, in a picture of 1280 × 720.

    It starts and stops without a jerk: at a jerk the middle of the blur is not that of the time.
    """
    if len(keys) > 1:
        keys = (replace(keys[0], t=keys[0].t - 0.2), *keys, replace(keys[-1], t=keys[-1].t + 0.2))
    return CameraPath((WIDTH, HEIGHT), at, keys, shake)


def gliding(
    velocity: tuple[float, float, float],
    *keys: Key,
    at: tuple[float, float, float] = (-0.1, -0.15, 8.6),
) -> CameraPath:
    """Let a camera glide on from where it is at first, m/s."""
    return Travelling(**vars(camera(*keys, at=at)), velocity=velocity)


def _without_eight(name: str) -> Paint:
    paint = painted(name, four=0.62)
    return replace(paint, eight=paint.twelve)


def look(tilt: float, height: float, azimuth: float = 0.0) -> tuple[float, float, float]:
    """Place from which the tee is seen at `tilt` off plumb, from the side `azimuth` (rad)."""
    away = height * float(np.tan(tilt))
    return -away * float(np.sin(azimuth)), -away * float(np.cos(azimuth)), height


def standing(*places: tuple[float, float, float]) -> tuple[Person, ...]:
    """People who stand at (x, y, heading)."""
    shirts = ((40, 30, 190), (150, 120, 30), (60, 50, 50), (30, 160, 60))
    return tuple(
        Person(((0.0, *place),), shirt=shirts[k % len(shirts)], sweep=0.05)
        for k, place in enumerate(places)
    )


def _crowded() -> Scene:
    bare = scene(12, painted("red-blue", 1.215, 0.611, outline=0.006))
    return replace(
        bare,
        people=(*sweepers(bare, 2.4), *standing((-1.3, -1.2, 0.8), (1.5, -0.7, 2.2))),
    )


def _noisy() -> Scene:
    bare = scene(13, painted("green-blue", 1.219, 0.610))
    return replace(bare, light=replace(bare.light, noise=5.0))


def _dim() -> Scene:
    bare = scene(22, painted("grey-red", 1.218, 0.607, button=0.0), line=(190, 190, 200))
    return replace(bare, light=Light(gain=0.62, vignette=0.35, noise=3.0, softness=1.1))


def clips() -> tuple[Clip, ...]:
    """List the fixed clips."""
    teal, navy = painted("teal-red", 1.209, 0.624, outline=0.007), painted("navy-orange")
    still = Key(0.0, 0.05, 0.3, 135)
    quiet = scene(1, navy)
    wide = replace(still, px_per_m=112)
    turning = tuple(
        Key(t, 0.1, 0.4, 128, roll)
        for t, roll in ((0.0, -0.06), (0.8, 0.08), (1.6, -0.03), (2.4, 0.1))
    )
    away = (Key(0.0, 0.0, 0.6, 118), Key(0.4, 0.0, 0.6, 118), Key(1.2, 0.1, 3.05, 118),
            Key(1.6, 0.1, 3.05, 118), Key(2.4, 0.0, 0.8, 118))  # fmt: skip
    third = (Key(0.0, 0.1, 0.4, 120), Key(0.9, 0.1, 3.75, 120), Key(1.5, 0.0, 3.75, 120),
             Key(2.4, 0.0, 1.0, 120))  # fmt: skip
    beyond = (Key(0.0, 0.0, 1.0, 115), Key(0.3, 0.0, 1.0, 115), Key(1.0, 0.0, 5.4, 115),
              Key(3.0, 0.0, 5.6, 115), Key(3.8, 0.0, 1.2, 115))  # fmt: skip
    pan = (Key(0.0, 0.05, 2.0, 150, 0.012, -0.03, 0.02), Key(1.2, 0.1, 0.6, 125, 0, -0.02, 0.015),
           Key(2.4, 0.05, -0.3, 110, -0.006, -0.015, 0.01))  # fmt: skip
    elsewhere = camera(Key(0.0, 0.0, 0.0, 70), at=look(np.deg2rad(62), 4.0, 0.9))
    oblique, tilted = np.deg2rad(50), np.deg2rad(30)

    def off_centre(x: float, y: float, z: float) -> CameraPath:
        return camera(Key(0.0, 0.05, 0.3, 120, 0.1, -0.06), at=(x, y, z))

    return (
        Clip("overhead", quiet, camera(still)),
        Clip("pan-zoom", scene(2, teal), camera(*pan, at=(-0.11, -0.09, 9.9))),
        Clip("shake-roll", scene(3, painted("blue-red", 1.222, 0.612)), camera(*turning, shake=2)),
        Clip("tilt-30", scene(4, painted("green-lime", 1.216, 0.628, outline=0.01)),
             camera(Key(0.0, 0.0, 0.2, 118), at=look(tilted, 8.5)), TILTED, supersample=2),
        Clip("tilt-30-moving", scene(5, painted("black-gold", 1.207, 0.606)),
             camera(Key(0.0, 0.2, 1.0, 130), Key(2.4, -0.1, -0.2, 105, 0.02),
                    at=look(tilted, 7.5, 0.3), shake=0.6), TILTED, supersample=2),
        Clip("oblique-50", scene(6, painted("red-blue", 1.219, 0.610, outline=0.006)),
             camera(Key(0.0, 0.0, 0.1, 120), at=look(oblique, 6.0)), OBLIQUE, supersample=2),
        Clip("oblique-50-moving", scene(7, painted("navy-red", 1.213, 0.62)),
             camera(Key(0.0, 0.4, 0.5, 130), Key(2.4, -0.2, 0.0, 105), at=look(oblique, 7.0, -0.5),
                    shake=0.6), OBLIQUE, supersample=2),
        Clip("half-out", scene(8, painted("blue-blue", 1.210, 0.622)), camera(*away)),
        Clip("third-left", scene(9, painted("orange-teal", 1.22, 0.615)), camera(*third)),
        Clip("starts-half-out", scene(10, painted("purple-gold", 1.216, 0.61, outline=0.006)),
             camera(*(replace(k, t=k.t - 1.4) for k in away[2:]), at=(0.2, 0.1, 7.4)),
             duration=1.4),
        Clip("people", _crowded(), camera(still)),
        Clip("k1 +0.1", scene(14, painted("gold-purple", 1.214, 0.619)),
             camera(replace(wide, k1=0.1), at=(0.0, 0.05, 9.0))),
        Clip("k1 -0.1", scene(15, painted("teal-red", 1.219, 0.610, outline=0.005)),
             camera(replace(wide, k1=-0.1), at=(0.1, -0.1, 9.0))),
        Clip("noise-crf32", _noisy(), camera(*pan[:2]), crf=32),
        Clip("off-centre-6m", scene(16, painted("red-white", 1.209, 0.61)),
             off_centre(0.35, -0.4, 6.0)),
        Clip("off-centre-8m", scene(17, painted("blue-red", 1.219, 0.610, outline=0.008)),
             off_centre(-0.45, 0.3, 8.0)),
        Clip("off-centre-10m", scene(18, painted("navy-orange", 1.222, 0.628)),
             off_centre(0.3, 0.45, 10.0)),
        Clip("cut", replace(scene(19, teal), cuts=(Cut(0.5, 1.0, elsewhere),)),
             camera(*pan), duration=3.0),
        Clip("dissolve", replace(scene(20, painted("red-blue", 1.212, 0.62)),
                                 cuts=(Cut(0.6, 1.2, dissolve=0.2),)), camera(still), duration=3.0),
        Clip("rings-gone", scene(21, painted("green-lime", 1.216, 0.62, outline=0.007), resting=8),
             camera(*beyond, at=(-0.1, 0.0, 9.0)), duration=4.2),
        Clip("dim", _dim(), camera(Key(0.0, 0.2, -0.2, 125, 0.0, -0.03), at=(0.1, 0.2, 7.6))),
        Clip("two-stripes", scene(23, painted("grey-red", 1.21, 0.625, button=0.0), line_gap=0.03,
                                  line_width=0.008), camera(replace(still, k1=-0.02))),
        Clip("outline-astride", scene(24, painted("blue-red", outline=0.007, outline_at=0.0)),
             camera(still)),
        Clip("outline-light", scene(31, replace(painted("navy-orange", outline=0.015),
                                                outline=(170, 165, 160))), camera(*pan[:2])),
        Clip("neighbours", scene(25, painted("green-blue", 1.211, 0.612), pitch=4.8,
                                 half_width=(2.2, 2.2)),
             camera(Key(0.0, 0.1, 0.2, 96, 0.03, -0.05, 0.02))),
        Clip("gliding", scene(27, painted("red-blue", 1.214, 0.62)),
             gliding((0.12, 0.05, -0.08), Key(0.0, 0.05, 0.5, 125), Key(2.4, 0.0, 0.1, 120))),
        Clip("tilt-30-gliding", scene(28, painted("green-lime", 1.212, 0.625)),
             gliding((0.25, 0.1, 0.0), still, at=look(tilted, 8.0)), TILTED, supersample=2),
        Clip("one-ring", scene(29, replace(painted("blue-red", 1.212), four=WHITE, button=WHITE,
                                           logo="")), camera(still)),
        Clip("12-and-4", scene(30, _without_eight("navy-orange")), camera(still)),
        Clip("close-up", scene(26, painted("teal-red", 1.217, 0.613, outline=0.006)),
             camera(Key(0.0, 0.1, 0.2, 225), Key(2.4, -0.2, 0.9, 200), at=(-0.05, -0.5, 7.6))),
    )  # fmt: skip


PLAIN = ("pan-zoom", "tilt-30", "oblique-50", "people", "k1 -0.1", "off-centre-8m")


def plain_clips() -> tuple[Clip, ...]:
    """List some of the fixed clips, shorter, by the second renderer."""
    short = (replace(c, duration=0.8, supersample=1, draw=plain_pictures) for c in clips())
    return tuple(replace(c, name=f"plain {c.name}") for c in short if c.name in PLAIN)
