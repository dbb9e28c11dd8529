"""What stones look like in a clip: the colours of caps and granite, learned from detections."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf, isnan

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.detection.circles import WALL
from curlshot.vision.detection.contrast import worth_of
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.relief import BARE, own_contrast
from curlshot.vision.video.colour import bgr_of, chroma, lab_of
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

CONVINCING = 1.4
"""Evidence from which a detection teaches what stones look like."""

MOST_COLOURS = 2
"""Cap colours of a clip: two teams play."""

RIM, GRANITE, MOST_OTHER = 0.12, (50.0, 28.0), 1.7
"""What differs from the most convincing stones of a clip: the rim, a share of the nominal one, and
the lightness and the hue of the granite, L*a*b* units; and the sum of their squares in these units
beyond which others are no stones. Of 74 clips, filmed and of five renderers, the teams' rims are up
to 0.08 apart and their granite up to 17 and 15, which is 0.9; 167 real stones one by one have 1.1,
and one that lay alone of its team on dark paint, which draws its rim 0.12 aside, 1.4. Dark hair on
teal paint has 2.1, on red jerseys 4.7 (0.16, 73 and 25 off)."""

UNLIKE = 30.0
"""Difference of cap colours (L*a*b* units) from which they are two."""

OTHER_STONE = 45.0
"""Difference of cap colours, L*a*b* units, that says: another stone, where no teams are known."""

MOSTLY = 0.75
"""Share of the difference of two teams' colours by which no stone's changes on its way."""

PURE = 55.0
"""How far from grey a colour without any red counts for at least, L*a*b* units."""

GREY = 10.0
"""Distance from grey within which a cap has no colour, L*a*b* units."""

LIGHT, LIGHT_OF_GREY = 0.1, 0.35
"""What a difference of lightness counts beside one of hue, both squared; and where neither cap has
a hue: 50 levels apart are two colours there."""

TOLD = 2.0
"""Standard deviations by which caps without colours differ at least from granite if a table of
colours is to tell them."""

COLOURLESS = 3.0
"""Distance from grey within which nearly all samples of a recording without colours lie."""


@dataclass(frozen=True)
class Colour:
    """A colour in CIE L*a*b* (8-bit scaling of OpenCV): mean and covariance."""

    mean: Array
    covariance: Array

    def distance(self, lab: Floats) -> Floats:
        """Mahalanobis distance of colours, shape (..., 3)."""
        root = np.linalg.cholesky(np.linalg.inv(self.covariance))
        away = (lab - self.mean.astype(np.float32)).reshape(-1, 3) @ root.astype(np.float32)
        away *= away
        return np.asarray(np.sqrt(away @ np.ones(3, np.float32)).reshape(lab.shape[:-1]))

    @property
    def name(self) -> str:
        """The mean colour as ``#rrggbb``."""
        blue, green, red = self.bgr
        return f"#{red:02x}{green:02x}{blue:02x}"

    @property
    def grey(self) -> bool:
        """Whether the mean colour has no hue to speak of."""
        return bool(chroma(self.mean) < GREY)

    @property
    def bgr(self) -> tuple[int, int, int]:
        """The mean colour as blue, green, red of 0 to 255."""
        return bgr_of(self.mean)


@dataclass(frozen=True)
class Appearance:
    """What stones look like in a clip.

    Attributes
    ----------
    membership : ndarray, shape (64, 64, 64), or None
        For a colour (blue, green, red in steps of 4): 1 cap, −1 granite, 0 neither. None where no
        colour is known: stones are two concentric circles, whatever is within them.
    caps : tuple of Colour
        The cap colours of the clip; empty where they are not known yet.
    granite : Colour or None
        The colour of the granite.
    outline : tuple of float
        Radii at which cap and granite are seen to end, as shares of the nominal ones.
    slack : float
        Standard deviation of a stone's radii about these, as a share.
    wall : tuple of float
        Height of the caps' walls and the standard deviation of that, m; below 0 where the near
        edges of caps are seen too far in.
    own : bool
        Whether these colours hardly tell caps from granite: then stones are sought by their two
        circles as well, and what is within them counts by the colours of each place.
    """

    membership: Floats | None
    caps: tuple[Colour, ...] = ()
    granite: Colour | None = None
    outline: tuple[float, float] = (1.0, 0.98)
    slack: float = 0.03
    wall: tuple[float, float] = WALL
    own: bool = False

    def nearest(self, colour: Array) -> tuple[int, float]:
        """Rank of the cap whose colour is nearest to one, shape (3,), and their difference."""
        means = np.array([cap.mean for cap in self.caps])
        differences = colour_differences(means, colour[None])[:, 0]
        rank = int(differences.argmin())
        return rank, float(differences[rank])

    @property
    def other_team(self) -> float:
        """Difference from a stone's colour, L*a*b* units, that says: of the other team.

        Infinite where but one is known.
        """
        if len(self.caps) < 2:
            return inf
        first, second = self.caps[:2]
        return MOSTLY * colour_difference(first.mean, second.mean)


BY_SHAPE = Appearance(None, own=True)
"""Stones of which no colour is known."""


def other_stone(appearance: Appearance | None) -> float:
    """Difference of cap colours, L*a*b* units, that says: another stone. None for plain discs."""
    return OTHER_STONE if appearance is None else min(OTHER_STONE, appearance.other_team)


@lru_cache(maxsize=1)
def _lab_of_table() -> Floats:
    steps = (np.arange(64) * 4 + 2).astype(np.uint8)
    bgr = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), -1).reshape(64, -1, 3)
    return lab_of(bgr).reshape(64, 64, 64, 3).astype(np.float32)


@lru_cache(maxsize=1)
def _without_red() -> Floats:
    """How far the colours of the table are from having any red in them, 0 to 1."""
    steps = np.arange(64, dtype=np.float32) * 4 + 2
    blue, green, red = np.ix_(steps, steps, steps)
    return np.asarray(np.maximum(1 - red / np.maximum(blue, green), 0), np.float32)


@lru_cache(maxsize=32)
def any_stone(white: int = 210) -> Appearance:
    """Appearance of stones before any is known: saturated caps, grey granite darker than ice.

    Parameters
    ----------
    white : int
        Lightness L* of the white ice in the picture, 0 to 255.
    """
    lab = _lab_of_table()
    light = lab[..., 0] / white
    # No teal and no dark green is far from grey, be it as pure as can be; black is not told.
    pure = PURE * _without_red() * np.clip((light - 0.1) / 0.1, 0, 1)
    away = np.maximum(chroma(lab), pure)
    # Blue caps are the darkest, and dark colours are never as far from grey as light ones.
    blue = np.clip((118 - lab[..., 2]) / 10, 0, 1)
    vivid = away / (1 - blue * (1 - np.clip(light / 0.4, 0.6, 1)))
    # Light blue ones are the palest; paint tinges granite red rather than blue.
    cap = np.clip((vivid - 28 + 8 * blue) / 14, 0, 1)
    granite = (
        np.clip((36 - vivid) / 16, 0, 1)
        * np.clip((light - 0.08) / 0.1, 0, 1)
        * np.clip((0.78 - light) / 0.1, 0, 1)
    )
    return Appearance((cap - granite).astype(np.float32))


def convincing(detections: Iterable[Detection]) -> list[Detection]:
    """Those from which may be learned what stones look like."""
    return [detection for detection in detections if detection.score > CONVINCING]


def by_colour(detections: Iterable[Detection]) -> list[list[Detection]]:
    """Group detections by the colour of their caps, the largest group first.

    All stones of a clip are of one size and one granite: what is not like the most convincing
    ones is left out. A detection without a handle, as of paint, counts less.
    """
    groups: list[list[Detection]] = []
    for detection in sorted(detections, key=lambda item: -item.score):
        for group in groups:
            if colour_difference(group[0].colour, detection.colour) < UNLIKE:
                group.append(detection)
                break
        else:
            groups.append([detection])
    return _of_one_set(sorted(groups, key=lambda group: sum(map(_handled, group)), reverse=True))


def _handled(detection: Detection) -> float:
    """How much of a handle a detection shows, 0 to 1; 1 where it is not told."""
    shown = own_contrast(detection)
    return 1.0 if isnan(shown) else min(shown / BARE, 1.0)


def _of_one_set(groups: list[list[Detection]]) -> list[list[Detection]]:
    """Leave out groups whose rim or granite is not that of the group with the most evidence."""
    if len(groups) < 2:
        return groups
    rims = np.array([np.median([s.outline[1] for s in group]) for group in groups])
    shown = [np.concatenate([s.granite_samples for s in group]) for group in groups]
    granite = np.array([np.median(some, axis=0) if len(some) else [np.nan] * 3 for some in shown])
    best = np.argmax([sum(s.score - CONVINCING for s in group) for group in groups])
    light, *hue = (granite - granite[best]).T
    apart = np.array([(rims - rims[best]) / RIM, light / GRANITE[0], np.hypot(*hue) / GRANITE[1]])
    other = np.nansum(apart**2, axis=0) > MOST_OTHER  # where no granite is seen, the rim tells
    return [group for group, out in zip(groups, other, strict=True) if not out]


def learn(detections: Sequence[Detection]) -> Appearance | None:
    """Learn the cap colours and the granite of a clip from detections in many frames.

    Caps are grouped by their colour; groups that are rare beside the others are left out.

    Returns
    -------
    Appearance or None
        None where there are no detections.
    """
    groups = by_colour(detections)
    groups = [group for group in groups[:MOST_COLOURS] if len(group) >= 0.08 * len(groups[0])]
    if not groups:
        return None
    caps = tuple(
        _colour(np.concatenate([s.cap_samples for s in group]), (18.0, 6.0, 6.0))
        for group in groups
    )
    shown = np.concatenate([s.granite_samples for group in groups for s in group])
    granite = _colour(shown, (15.0, 9.0, 9.0))
    lab = _lab_of_table()
    to_cap = np.asarray(np.min([cap.distance(lab) for cap in caps], axis=0), np.float32)
    to_granite = granite.distance(lab)
    worth = worth_of(to_cap, to_granite)
    chosen = [(*s.outline, s.wall) for group in groups for s in group if s.visible > 0.8]
    own = _colourless([shown, *(s.cap_samples for group in groups for s in group)])
    own &= min(_told(cap, granite) for cap in caps) < TOLD
    if len(chosen) < 3:
        return Appearance(worth, caps, granite, own=own)
    cap_share, rim_share, wall = np.median(np.array(chosen), axis=0).tolist()
    return Appearance(worth, caps, granite, (cap_share, rim_share), 0.01, (wall, 0.001), own)


def _colourless(samples: Sequence[Array]) -> bool:
    """Whether samples of colours, shapes (n, 3), are of a recording without any."""
    return bool(np.percentile(chroma(np.concatenate(samples)), 98) < COLOURLESS)


def _told(cap: Colour, granite: Colour) -> float:
    """By how many standard deviations, of both together, a cap differs from the granite."""
    both = Colour(granite.mean, cap.covariance + granite.covariance)
    return float(both.distance(cap.mean.astype(np.float32)))


def colour_difference(first: Array, second: Array) -> float:
    """Difference of two cap colours, mostly of hue: lightness changes with the lamps."""
    return float(colour_differences(np.asarray(first)[None], np.asarray(second)[None])[0, 0])


def colour_differences(first: Array, second: Array) -> Array:
    """Differences of cap colours, shapes (m, 3) and (n, 3): shape (m, n).

    Between caps without hue, lightness counts for more.
    """
    first, second = np.asarray(first, float)[:, None], np.asarray(second, float)
    grey = np.maximum(chroma(first), chroma(second)) < GREY
    square = (first - second) ** 2
    light = np.where(grey, LIGHT_OF_GREY, LIGHT) * square[..., 0]
    return np.asarray(np.sqrt(light + (square[..., 1] + square[..., 2])))


def _colour(samples: Array, floor: tuple[float, float, float]) -> Colour:
    centre = np.median(samples, axis=0)
    near = samples[(np.abs(samples - centre) < 4 * np.array(floor)).all(1)]
    spread = np.cov(near.T) if len(near) > 10 else np.zeros((3, 3))
    return Colour(centre, spread + np.diag(np.square(floor)))


def membership(image: Image, table: Floats) -> Floats:
    """Say what each pixel may be by a table of colours: 1 cap, −1 granite, 0 neither; (h, w)."""
    steps = image >> 2
    index = steps[..., 0].astype(np.int32)
    for channel in (1, 2):
        index <<= 6
        index |= steps[..., channel]
    return np.asarray(table.ravel().take(index), np.float32)
