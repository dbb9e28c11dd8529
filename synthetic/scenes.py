"""Scenes ready to use: the sample shot, random shots, and the colour schemes that occur."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.synthetic.camera import CameraPath, broadcast_camera
from curlshot.synthetic.physics import RADIUS, Ice, Impact, Start, simulate
from curlshot.synthetic.scene import (
    CRIMSON,
    RED_CAP,
    TEAL,
    YELLOW_CAP,
    Colour,
    Mark,
    Paint,
    Person,
    Scene,
    Sheet,
    Stone,
)

RED_HANDLE: Colour = (132, 128, 226)
YELLOW_HANDLE: Colour = (70, 120, 150)
NAVY: Colour = (84, 50, 22)
PURPLE: Colour = (120, 40, 96)

PAINTS: dict[str, Paint] = {
    "teal-red": Paint(),
    "blue-red": Paint(twelve=(180, 80, 20), four=(40, 30, 200)),
    "red-blue": Paint(twelve=(40, 30, 200), four=(180, 80, 20)),
    "green-lime": Paint(
        twelve=(30, 120, 20), four=(20, 235, 160), outline=(20, 40, 20), logo="LEIF"
    ),
    "navy-orange": Paint(twelve=NAVY, four=(20, 130, 240), outline=None, logo="POLAR"),
    "green-blue": Paint(twelve=(60, 140, 30), four=(170, 90, 20), logo=""),
    "purple-gold": Paint(twelve=PURPLE, four=(50, 170, 215)),
    "gold-purple": Paint(twelve=(50, 170, 215), four=PURPLE, outline=None),
    "grey-red": Paint(twelve=(150, 150, 150), four=CRIMSON, logo=""),
    "black-gold": Paint(twelve=(50, 46, 44), four=(50, 170, 215)),
    "red-white": Paint(twelve=CRIMSON, four=(200, 196, 190), button=CRIMSON, logo=""),
    "blue-blue": Paint(twelve=(190, 110, 30), four=(190, 110, 30), radii=(1.829, 1.22, 0.61, 0.15)),
    "orange-teal": Paint(twelve=(20, 130, 240), four=TEAL),
    "navy-red": Paint(
        twelve=NAVY, four=CRIMSON, button=(200, 60, 20), radii=(1.829, 1.217, 0.61, 0.28)
    ),
}  # fmt: skip
"""Ring colours seen at events, by the names of the outer and the inner ring."""


def red_stone(name: str, start: Start) -> Stone:
    """Return a stone with a red cap and a paler handle."""
    return Stone(name, start, RED_CAP, RED_HANDLE)


def yellow_stone(name: str, start: Start) -> Stone:
    """Return a stone with a yellow cap and a darker handle."""
    return Stone(name, start, YELLOW_CAP, YELLOW_HANDLE)


def sample_scene() -> Scene:
    """Return the shot of the bundled clip: A hits B, B hits C.

    At t = 1.120 s A is at (−0.320, 0.894) m and moves with (0.0457, −1.3599) m/s and
    0.6586 rad/s, B stands at (−0.189, 0.629), C at (0.466, −0.791): the values marked by hand
    for the study whose shot this is (its Table 2), unchanged. A touches B 4 ms later, where the
    centres are 2 R = 0.291 m apart. e = 0.8345 and μ = 0.0109 are the study's too. Chosen
    freely: μ_s = 0.05 between the stones, with which B leaves along (0.405, −0.914) (marked:
    (0.404, −0.915)) and meets C 24 mm off its centre line (marked: 26 mm) without any stone
    being moved; no loss of spin while gliding; and three more stones at rest, D to F.
    """
    ice, impact = Ice(b=0.0109, spin_decay=0.0), Impact(0.8345, 0.05)
    stones = (
        yellow_stone("A", _back((-0.320, 0.894), (0.0457, -1.3599), 0.5, 0.6586, 1.120, ice)),
        red_stone("B", Start(-0.189, 0.629, theta=2.1)),
        yellow_stone("C", Start(0.466, -0.791, theta=0.7)),
        red_stone("D", Start(-1.12, 1.07, theta=-0.6)),
        red_stone("E", Start(1.34, 0.58, theta=1.5)),
        yellow_stone("F", Start(-0.62, -1.22, theta=2.7)),
    )
    watcher = Person(
        ((0.0, 2.75, -1.9, 2.6), (7.0, 2.75, -1.9, 2.6)),
        shirt=(120, 60, 30),
        trousers=(50, 44, 40),
        broom=(60, 60, 200),
    )
    return Scene(stones=stones, people=(watcher,), ice=ice, impact=impact, seed=7)


def sample_camera() -> CameraPath:
    """Return the sample's camera: 9.9 m up, it pans down with the thrown stone and zooms out."""
    return broadcast_camera(
        end=5.0,
        target=((0.05, 1.25), (0.1, -0.55)),
        px_per_m=(150.0, 112.0),
        k1=(-0.03, -0.015),
        k2=(0.02, 0.01),
    )


def sample_variant(rng: np.random.Generator) -> tuple[Scene, CameraPath]:
    """Return a variant of the sample: restitution, frictions, throw, spins, pan, zoom.

    Where A meets B is kept to 15 mm across its way, so that B goes for C. The picture is the
    sample's, 1280 × 720, or 1920 × 1080.
    """
    scene = sample_scene()
    ice = Ice(b=float(rng.uniform(0.008, 0.013)), spin_decay=float(rng.choice([0.0, 0.02])))
    impact = Impact(float(rng.uniform(0.75, 0.95)), float(rng.uniform(0.02, 0.12)))
    speed, heading = float(rng.uniform(1.1, 2.0)), float(-np.pi / 2 + rng.normal(0.03, 0.02))
    spin = float(rng.choice([-1, 1]) * rng.uniform(0.3, 2.2))
    ahead, left = np.array(
        [[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]]
    )
    # The sample's A passes B's middle 105 mm to the left at this point of its way.
    place = np.array([-0.189, 0.629]) - 0.28 * ahead + rng.uniform(-0.12, -0.09) * left
    thrown = _back(
        (float(place[0]), float(place[1])), (float(speed * ahead[0]), float(speed * ahead[1])),
        float(rng.uniform(0, 6)), spin, 1.12, ice,
    )  # fmt: skip
    first, *others = scene.stones
    larger = float(rng.choice([1.0, 1.5]))
    zoom = larger * rng.uniform(0.9, 1.1, 2)
    camera = broadcast_camera(
        size=(round(1280 * larger), round(720 * larger)),
        position=(float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.3, 0.3)), 9.0),
        end=float(rng.uniform(3.0, 6.0)),
        target=((0.05, 1.25), (0.1, float(rng.uniform(-0.6, 0.2)))),
        px_per_m=(float(150 * zoom[0]), float(112 * zoom[1])),
        k1=(-0.03, float(rng.uniform(-0.03, 0.02))),
        k2=(0.02, 0.01),
        shake=float(rng.uniform(0.0, 0.6)) * larger,
        shake_phase=float(rng.uniform(0, 6)),
    )
    stones = (replace(first, start=thrown), *others)
    seed = int(rng.integers(1 << 30))
    return replace(scene, stones=stones, ice=ice, impact=impact, seed=seed), camera


def random_scene(
    rng: np.random.Generator,
    *,
    resting: int = 6,
    speed: float | None = None,
    paint: Paint | None = None,
    caps: tuple[Colour, Colour] = (RED_CAP, YELLOW_CAP),
) -> Scene:
    """Return a thrown stone "A" that hits one of `resting` stones in and before the house.

    Parameters
    ----------
    rng : Generator
        Draws everything that is not given.
    resting : int
        Stones at rest, at least one, named B (the target), C ….
    speed : float, optional
        Of the thrown stone 1.5 s before it reaches its target, m/s.
    paint : Paint, optional
        Rings; one of `PAINTS` with slightly varied radii where left out.
    caps : tuple of Colour
        Cap colours of the two teams; the thrown stone has the first.
    """
    if paint is None:
        base = PAINTS[str(rng.choice(list(PAINTS)))]
        r12, r8, r4, button = base.radii
        paint = replace(
            base, radii=(r12, r8 + rng.uniform(-6e-3, 6e-3), r4 + rng.uniform(-6e-3, 6e-3), button)
        )
    ice = Ice(b=float(rng.uniform(0.008, 0.014)))
    impact = Impact(float(rng.uniform(0.7, 0.95)), float(rng.uniform(0.02, 0.15)))
    fast = float(rng.uniform(1.0, 2.0)) if speed is None else speed
    heading = np.array([rng.uniform(-0.12, 0.12), -1.0])
    lane = heading / np.linalg.norm(heading)
    target = rng.uniform([-1.2, -1.0], [1.2, 1.1])
    aim = target + np.array([rng.uniform(-0.15, 0.15), 0.2])
    start, velocity = aim - 1.5 * fast * lane, fast * lane
    places = [target]
    while len(places) < resting:
        place = rng.uniform([-1.4, -1.3], [1.4, 2.6])
        aside = abs((place - start) @ np.array([-lane[1], lane[0]]))
        in_the_way = place[1] > target[1] and aside < 2 * RADIUS + 0.05
        if not in_the_way and all(np.hypot(*(place - p)) > 2 * RADIUS + 0.06 for p in places):
            places.append(place)
    spin = float(rng.choice([-1, 1]) * rng.uniform(0.5, 2.2))
    (x, y), (vx, vy) = start.tolist(), velocity.tolist()
    thrown = Start(x, y, vx, vy, float(rng.uniform(0, 6)), spin)
    stones = [Stone("A", thrown, caps[0], _handle_of(caps[0]))]
    for name, place in zip("BCDEFGHIJKLMNOP", places, strict=False):
        cap = caps[int(rng.integers(2))]
        rest = Start(float(place[0]), float(place[1]), theta=float(rng.uniform(0, 6)))
        stones.append(Stone(name, rest, cap, _handle_of(cap)))
    return Scene(
        stones=tuple(stones), paint=paint, sheet=_random_sheet(rng), ice=ice, impact=impact,
        seed=int(rng.integers(1 << 30)),
    )  # fmt: skip


def sweepers(scene: Scene, duration: float, *, stone: str = "A") -> tuple[Person, ...]:
    """Two people who sweep before a stone as it moves, one on each side of its path.

    Parameters
    ----------
    scene : Scene
        Tells how the stone moves.
    duration : float
        Length of their walk, s; where the stone stops or turns, they stay.
    stone : str
        Name of the stone.
    """
    index = [s.name for s in scene.stones].index(stone)
    starts = [s.start for s in scene.stones]
    motion = simulate(starts, duration, ice=scene.ice, impact=scene.impact)
    times = np.arange(0, duration, 0.2)
    states = motion.at(times)[:, index]
    heading = np.arctan2(states[0, 4], states[0, 3])
    ahead = np.array([np.cos(heading), np.sin(heading)])
    way = np.maximum.accumulate((states[:, :2] - states[0, :2]) @ ahead)
    people = []
    for side, lead, shirt in ((1, 0.42, (40, 30, 190)), (-1, 0.62, (150, 120, 30))):
        aside = -1.05 * side * np.array([-ahead[1], ahead[0]])
        hips = states[0, :2] + (way + lead)[:, None] * ahead + aside
        facing = float(heading) + side * np.pi / 2
        path = tuple(
            (float(t), float(x), float(y), facing) for t, (x, y) in zip(times, hips, strict=True)
        )
        people.append(Person(path, shirt=shirt, sweep=0.12, rate=3.5))
    return tuple(people)


def _random_sheet(rng: np.random.Generator) -> Sheet:
    carpet = ((66, 30, 16), (140, 30, 20), (50, 50, 52), (30, 60, 20))[int(rng.integers(4))]
    names = ("NORDVIK", "Fjellbank", "ARKTIS", "Sno & Is")
    marks = tuple(
        Mark(str(rng.choice(names)), x, y, colour=_dark(rng))
        for x, y in ((-1.15, 3.3), (1.15, 3.3), (0.0, 5.0), (0.0, -2.9))
    )
    left, right = (float(v) for v in rng.uniform(2.2, 2.38, 2))
    return Sheet(half_width=(left, right), carpet=carpet, marks=marks)


def _dark(rng: np.random.Generator) -> Colour:
    b, g, r = (int(v) for v in rng.integers(10, 160, 3))
    return b, g, r


def _handle_of(cap: Colour) -> Colour:
    """Paler than a dark cap, darker than a light one."""
    light = 0.11 * cap[0] + 0.59 * cap[1] + 0.3 * cap[2]
    b, g, r = cap
    if light < 110:
        return (b + (255 - b) * 45 // 100, g + (255 - g) * 45 // 100, r + (255 - r) * 45 // 100)
    return (b // 2 + 50, g // 2 + 15, r // 2 + 35)


def _back(
    place: tuple[float, float],
    velocity: tuple[float, float],
    theta: float,
    omega: float,
    before: float,
    ice: Ice,
) -> Start:
    """Where a stone was `before` seconds ago under constant friction and no loss of spin."""
    speed = float(np.hypot(*velocity))
    slowing = ice.b * 9.81
    way = speed * before + 0.5 * slowing * before**2
    faster = (speed + slowing * before) / speed
    return Start(
        place[0] - way * velocity[0] / speed,
        place[1] - way * velocity[1] / speed,
        velocity[0] * faster,
        velocity[1] * faster,
        theta,
        omega,
    )


__all__ = [
    "PAINTS",
    "random_scene",
    "red_stone",
    "sample_camera",
    "sample_scene",
    "sample_variant",
    "sweepers",
    "yellow_stone",
]
