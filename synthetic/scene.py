"""What is to be seen: sheet, stones, people, graphics and light, as frozen parameters.

Lengths in metres, angles in radians, colours as (blue, green, red) in 0..255.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from curlshot.synthetic.camera import CameraPath
from curlshot.synthetic.physics import RADIUS, Ice, Impact, Start

Colour = tuple[int, int, int]

WHITE: Colour = (222, 226, 226)
BLACK: Colour = (30, 28, 28)
TEAL: Colour = (122, 128, 14)
CRIMSON: Colour = (48, 22, 208)
RED_CAP: Colour = (44, 26, 178)
YELLOW_CAP: Colour = (38, 208, 226)


@dataclass(frozen=True)
class Paint:
    """Rings: colours from the outside in, painted radii, and the thin outline of each edge.

    The rules measure the 12-ft circle to its outer edge, 1.829 m. Where an edge is outlined, the
    outline is part of the circle and its outer side lies on the radius (`outline_at` −0.5); some
    painters lay it astride the edge (0). A button of radius 0 is none. `logo` is a word in the
    button; empty for none.
    """

    twelve: Colour = TEAL
    eight: Colour = WHITE
    four: Colour = CRIMSON
    button: Colour = WHITE
    radii: tuple[float, float, float, float] = (1.829, 1.212, 0.622, 0.19)
    outline: Colour | None = (92, 40, 150)
    outline_width: float = 0.007
    outline_at: float = -0.5
    logo: str = "FJELL"
    logo_colour: Colour = (120, 90, 60)


@dataclass(frozen=True)
class Mark:
    """A sponsor's word in the ice: centre of the word, height of its letters, colours."""

    text: str
    x: float
    y: float
    height: float = 0.22
    colour: Colour = (140, 60, 20)
    ground: Colour | None = None
    angle: float = 0.0


@dataclass(frozen=True)
class Sheet:
    """The sheet around the house; `pitch` is the distance to the neighbouring sheets.

    A line may be two stripes with a gap of `line_gap` between them, m.
    """

    ice: Colour = WHITE
    half_width: tuple[float, float] = (2.375, 2.36)
    border: Colour = (26, 22, 20)
    border_width: float = 0.10
    carpet: Colour = (66, 30, 16)
    line: Colour = (150, 130, 208)
    line_width: float = 0.015
    line_gap: float = 0.0
    hog_line: Colour = (60, 40, 190)
    pitch: float = 6.1
    marks: tuple[Mark, ...] = (
        Mark("NORDVIK", -1.15, 3.35),
        Mark("NORDVIK", 1.15, 3.35),
        Mark("Fjellbank", 0.0, 5.0, height=0.26, colour=(40, 120, 20)),
        Mark("NORDVIK", 0.0, -2.95),
    )


@dataclass(frozen=True)
class Stone:
    """One stone: its name, where it starts, and its looks.

    `theta` of the start points from the cap's centre to the handle's free end. The cap ends
    `cap_height` above the ice, and below that it has a side `wall` high, m. A handle is level, or
    rises by `steepness` along it; it is as high in the middle then.
    """

    name: str
    start: Start
    cap: Colour = RED_CAP
    handle: Colour = (132, 128, 226)
    radius: float = RADIUS
    cap_radius: float = 0.1045
    cap_height: float = 0.12
    wall: float = 0.0
    steepness: float = 0.0
    granite: Colour = (112, 120, 122)

    @property
    def side(self) -> tuple[float, ...]:
        """Heights above the ice of discs, 2 mm apart, that make the side of the cap, m."""
        count = math.ceil(self.wall / 0.002)
        return tuple(self.cap_height - self.wall * (1 - k / count) for k in range(count))


@dataclass(frozen=True)
class Person:
    """Someone on the ice with a broom, seen from above.

    `path` holds (t, x, y, heading): the place under the hips, joined linearly. `sweep` is the
    stroke of the broom's head, m, and `rate` its strokes per second.
    """

    path: tuple[tuple[float, float, float, float], ...]
    shirt: Colour = (40, 30, 190)
    trousers: Colour = (34, 30, 30)
    hair: Colour = (30, 40, 60)
    broom: Colour = (30, 190, 240)
    sweep: float = 0.0
    rate: float = 3.0
    has_broom: bool = True


@dataclass(frozen=True)
class Graphic:
    """A score box of the broadcast, in pixels of the picture: top-left corner and row height."""

    x: int = 100
    y: int = 30
    row: int = 26
    rows: tuple[tuple[str, str, Colour], ...] = (
        ("NOR", "4", RED_CAP),
        ("SCO", "3", YELLOW_CAP),
    )
    ground: Colour = (70, 52, 24)


@dataclass(frozen=True)
class Light:
    """Lamps and sensor.

    Attributes
    ----------
    gain : float
        Brightness of the picture.
    shadow : float
        Depth of the shadows, 0..1.
    lamps : tuple of float
        Directions of the lamps that glint on granite, rad.
    glare : float
        Bright spots of lamps on the ice, grey levels.
    texture : float
        Unevenness of the ice, 1 for what is usual.
    vignette : float
        Loss of light in the corners, 0..1.
    softness : float
        Standard deviation of the optics' blur, px.
    noise : float
        Standard deviation of the sensor's noise, grey levels.
    power : float
        Power of the codes that lens and shutter mix: 1 where a computer blurs codes, 2.2 where
        light is blurred before it is coded.
    """

    gain: float = 1.0
    shadow: float = 0.32
    lamps: tuple[float, ...] = (0.2, 0.45, 1.4, 1.6, 1.8, 3.0, 3.3, 4.6, 4.85)
    glare: float = 9.0
    texture: float = 1.0
    vignette: float = 0.12
    softness: float = 0.55
    noise: float = 2.2
    power: float = 1.0


@dataclass(frozen=True)
class Cut:
    """Another picture from `start` to `end`, s, with a dissolve of so many seconds each side.

    With a camera the same scene is seen by it; without, a defocused close-up is shown.
    """

    start: float
    end: float
    camera: CameraPath | None = None
    dissolve: float = 0.0


@dataclass(frozen=True)
class Scene:
    """All that a clip shows, and the laws by which its stones move."""

    stones: tuple[Stone, ...] = ()
    people: tuple[Person, ...] = ()
    graphics: tuple[Graphic, ...] = ()
    cuts: tuple[Cut, ...] = ()
    paint: Paint = field(default_factory=Paint)
    sheet: Sheet = field(default_factory=Sheet)
    light: Light = field(default_factory=Light)
    ice: Ice = field(default_factory=Ice)
    impact: Impact = field(default_factory=Impact)
    seed: int = 1
