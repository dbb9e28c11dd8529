"""Where the edges of stones lie: circles fitted to cap and granite, and what sets them aside.

Whether there is a stone is asked of whole steps of colour. Where it is, is told by their middles
where the view slants, by what pixels mix where caps are grey or hide their granite, and by what a
cap covered where it moves fast.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.appearance import GREY, Appearance
from curlshot.vision.detection.circles import WALL, Fits, fit_circles
from curlshot.vision.detection.contrast import by_lightness
from curlshot.vision.detection.mixture import CapRays, by_light
from curlshot.vision.detection.patch import Effort
from curlshot.vision.detection.rays import Rays, directions
from curlshot.vision.detection.rims import Rim, falls_along
from curlshot.vision.detection.samples import Samples
from curlshot.vision.detection.shoulder import HIDDEN, against_beyond
from curlshot.vision.detection.smeared import middles, swept_share
from curlshot.vision.video.colour import chroma

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Flags = NDArray[np.bool_]
Places = NDArray[np.intp]

GRANITE = 0.15
"""What an edge of the granite says of the centre beside one of the cap: the granite is rounded,
and paint that ends near it draws its outline aside, by up to 8 mm. Where the cap is covered it
still tells the centre."""

FLANK = 0.37
"""How far from half-way between granite and cap, as a share of what they differ by, colours tell
where the edge of the cap lies: a mark beside the rim, a wall below it and lamps mirrored in the
granite are colours beyond that, and draw the middle of the whole step aside by up to 5 mm. Of a
narrower middle the level half-way says more, which is aside where granite is lit from one side."""

FAR_FLANK = 0.25
"""The same at the far edge of a cap that hides its granite. Pixels of colour are up to 4 cm long
there, and where so wide a step falls most is chance: by up to 16 mm inside the level half-way."""

OPEN, NEAR = 0.75, 0.02
"""The middle of a step tells the centre of a stone of which so much is seen (what granite hides
behind its own cap counts as seen), and which whole steps have so near to where it is looked for, m:
of one half covered, or not yet come upon, whole steps tell more."""

ASLANT = 0.35, 0.6
"""Slants of the view from which on and up to which the middle of the step takes the place of the
whole of it: there the wall below a cap is seen. From above there is none, and whole steps are as
good, or better where granite is lit from one side."""

DARKER = 20.0
"""By how much a cap without hue is darker than its granite, levels of 255, for what pixels mix of
both to tell where it ends: white caps end in what is as light as they."""

DRAWN_OUT = 0.02
"""How far the middle of such a cap is off along its way, as a share of how far it moves from one
picture to the next: five drawn ones were up to 2 mm off of 0.1 m. The granite before a cap is not
as light as that beside it, so that the share of the exposure for which it covered a place tells
less: by up to 9 mm."""


@dataclass(frozen=True)
class Views:
    """How n places are seen.

    Attributes
    ----------
    pixel : ndarray, shape (n,)
        How long a pixel is there, m.
    slant : ndarray, shape (n, 2)
        Tangent of the view's angle to the vertical, along x and y.
    drift : ndarray, shape (n, 2)
        How far a stone there moves across the picture, from one to the next, m of the ice.
    """

    pixel: Array
    slant: Array
    drift: Array

    def at_places(self, index: Places) -> Views:
        """Take some of the places."""
        return Views(self.pixel[index], self.slant[index], self.drift[index])

    def behind(self, rays: int) -> Array:
        """Slant of the view along each ray, shape (n, rays), above 0 on the far side."""
        return np.asarray(self.slant @ directions(rays)[1].T)


@dataclass(frozen=True)
class Edges:
    """The edges of stones about n places.

    Attributes
    ----------
    fit : Fits
        Circles of cap and granite. Of stones that are seen well, the centre is that of the middle
        of the steps.
    visible : ndarray, shape (n,)
        Share of the way around on which both are seen.
    light : ndarray, shape (n, 2)
        Where the cap's centre lies by the lightness of its edge alone, less the centre, m; NaN
        where it was not found, or not sought.
    swept : ndarray of bool, shape (n,)
        Whether it was seen how far a fast stone's cap is smeared, and the centre goes by that.
    doubt : ndarray, shape (n, 2)
        How far the centre may be off for what is hidden of the edges, or smeared, m.
    """

    fit: Fits
    visible: Array
    light: Array
    swept: Flags
    doubt: Array


def fit_edges(
    samples: Samples,
    rays: Rays,
    over: Rays,
    views: Views,
    appearance: Appearance,
    disc: Stone,
    effort: Effort,
) -> Edges:
    """Fit circles to the edges of cap and granite of stones.

    Parameters
    ----------
    samples : Samples
        What is seen on the rays.
    rays, over : Rays
        About n places; and such as stay at the height of the cap, where a view slants.
    views : Views
        How the places are seen.
    appearance : Appearance
        What stones look like here.
    disc : Stone
        Size of the stones.
    effort : Effort
        How each place is measured.
    """
    cap, granite = _rims(samples, rays, views, appearance, disc, effort)
    visible = visible_on(samples, rays, appearance, disc)
    behind = views.behind(effort.rays)
    dark, middle_counts = _aslant(samples, views, appearance)
    # Of granite that hides behind its cap nothing can be seen.
    shown = np.where(behind > HIDDEN[0], samples.capped, samples.stony) & cap.inside
    clear = np.flatnonzero((shown.mean(1) > OPEN) & (middle_counts > 0) & bool(appearance.caps))
    seen = CapRays(
        rays, over, behind, samples.of_cap, samples.in_ring, samples.of_ring, cap.radius,
        views.pixel,
    )  # fmt: skip
    signal = _against_mixtures(samples.signal, seen, clear, dark, disc)
    fit, exact = _fits(signal, rays, (cap, granite), views, clear, appearance, effort)
    near = exact.ok & (np.hypot(fit.shift[clear, 0], fit.shift[clear, 1]) < NEAR)
    rows = clear[near]
    fit = _moved(fit, exact.at_places(near), rows, middle_counts[rows])
    light = np.full((len(visible), 2), np.nan)
    if effort.light:
        light = _by_light_alone(samples, rays, cap, views, appearance, effort) - fit.shift
    by_mixture = np.zeros(len(visible), bool)
    by_mixture[rows] = dark[rows]
    # What displaces the edges of one side is made good by the other side, if that is seen.
    doubt = np.repeat(0.04 * disc.radius * (1 - visible)[:, None], 2, axis=1)
    edges = Edges(fit, visible, light, np.zeros(len(visible), bool), doubt)
    return _unsmeared(edges, signal, rays, views, by_mixture, disc)


def _aslant(samples: Samples, views: Views, appearance: Appearance) -> tuple[Flags, Array]:
    """Say which caps are seen aslant and told by what their pixels mix, for they are dark.

    Second how much the middle of the step counts beside the whole of it, 0 to 1; shape (n,) each.
    """
    counts = np.clip((np.hypot(*views.slant.T) - ASLANT[0]) / (ASLANT[1] - ASLANT[0]), 0.0, 1.0)
    dark = _without_hue(appearance) & (counts > 0) & _dark(samples)
    counts[dark] = 1.0
    return dark, counts


def _unsmeared(
    edges: Edges, signal: Floats, rays: Rays, views: Views, by_mixture: Flags, disc: Stone
) -> Edges:
    """Place stones that move fast by what their caps covered in the exposure, as far as is seen.

    Of those in `by_mixture` the middle of the edge stays, and is in doubt.
    """
    moves = (swept_share(views.drift) > 0) & edges.fit.ok & (edges.visible > OPEN)
    swept, doubt, light = moves & by_mixture, edges.doubt.copy(), edges.light.copy()
    doubt[swept] = np.hypot(doubt[swept], DRAWN_OUT * np.abs(views.drift[swept]))
    light[swept] = np.nan
    shift, fast = edges.fit.shift.copy(), np.flatnonzero(moves & ~by_mixture)
    if len(fast):
        swept[fast], shift[fast], off = middles(
            signal[fast], rays.at_places(fast), disc, shift[fast], views.drift[fast]
        )
        doubt[fast] = np.hypot(doubt[fast], off)
        light[fast[off.any(1)]] = np.nan
    fit = replace(edges.fit, shift=shift)
    return replace(edges, fit=fit, light=light, swept=swept, doubt=doubt)


def visible_on(samples: Samples, rays: Rays, appearance: Appearance, disc: Stone) -> Array:
    """Share of the way around stones on which both cap and granite are seen, shape (n,)."""
    at_cap = rays.at(disc.cap_radius * appearance.outline[0])
    return np.asarray((samples.stony & at_cap).mean(1))


def mixtures_matter(views: Views, appearance: Appearance) -> bool:
    """Whether pixels at the edges of some caps may mix more than cap and granite."""
    slant = float(np.hypot(*views.slant.T).max(initial=0.0))
    return slant > (ASLANT[0] if _without_hue(appearance) else HIDDEN[0])


def falling_off(disc: Stone) -> float:
    """By how much more than its cap the rim of a stone is drawn aside by a slanting view."""
    return 2 * (1 - disc.rim_height / disc.cap_height)


def _rims(
    samples: Samples,
    rays: Rays,
    views: Views,
    appearance: Appearance,
    disc: Stone,
    effort: Effort,
) -> tuple[Rim, Rim]:
    """Say where the edges of cap and granite are expected, and on which rays."""
    cap_radius, rim_radius = np.array([disc.cap_radius, disc.radius]) * appearance.outline
    cap = Rim(
        (samples.falls @ samples.along)[..., 0], samples.stony, rays.at(cap_radius), cap_radius,
        0.12 * cap_radius, 0.3, np.ones(len(views.pixel)),
        lean=np.maximum(-views.behind(effort.rays), 0),
    )  # fmt: skip
    edges = np.sqrt((samples.falls * samples.falls) @ np.ones(3, np.float32))
    # Seen aslant, the granite's outline is not a circle of one height.
    tilt = falling_off(disc) ** 2 * (views.slant**2).sum(1) / effort.most_tilt**2
    granite = Rim(
        edges, samples.greyed, rays.at(rim_radius), rim_radius, 0.05 * rim_radius, 12.0,
        1 / (1 + tilt), GRANITE,
    )  # fmt: skip
    return cap, granite


def _without_hue(appearance: Appearance) -> bool:
    """Whether some caps of the clip are black, grey or white."""
    return any(cap.grey for cap in appearance.caps)


def _dark(samples: Samples) -> Flags:
    """Whether caps have no hue and are darker than their granite, shape (n,)."""
    return np.asarray(
        (samples.granite[:, 0] - samples.cap[:, 0] > DARKER) & (chroma(samples.cap) < GREY)
    )


def _against_mixtures(
    signal: Floats, seen: CapRays, clear: Places, dark: Flags, disc: Stone
) -> Floats:
    """Say what steps between cap and what is beside it, where that is not granite alone.

    Of caps that hide their granite, and of dark ones, it is what their pixels mix.

    Parameters
    ----------
    signal : ndarray, shape (n, rays, radii)
        0.5 on the cap, −0.5 on its granite.
    seen : CapRays
    clear : ndarray of int
        Places of stones that are seen well.
    dark : ndarray of bool, shape (n,)
        Whether caps have no hue and are darker than their granite.
    disc : Stone
    """
    out = signal.copy()
    steep = clear[(seen.behind[clear] > HIDDEN[0]).any(1) & ~dark[clear]]
    if len(steep):
        out[steep] = against_beyond(signal[steep], seen.at_places(steep), disc)
    mixed = clear[dark[clear]]
    if len(mixed):
        out[mixed] = by_light(seen.at_places(mixed), disc)
    return out


def _fits(
    signal: Floats,
    rays: Rays,
    rims: tuple[Rim, Rim],
    views: Views,
    clear: Places,
    appearance: Appearance,
    effort: Effort,
) -> tuple[Fits, Fits]:
    """Fit circles to whole steps at all places, and to their middles at those seen clearly.

    Both are made together: for the few places of most pictures that is as quick as one.
    """
    cap, granite = rims
    n = len(signal)
    behind = views.behind(rays.inside.shape[1])[clear]
    flank = np.where(behind > HIDDEN[0], FAR_FLANK, FLANK).astype(np.float32)[..., None]
    steps = np.clip(signal[clear], -flank, flank) / (2 * flank)
    falling = np.concatenate([cap.fall, falls_along(steps[..., None])[..., 0]])
    twice = np.concatenate([np.arange(n), clear])
    walls = np.where(np.arange(len(twice)) < n, appearance.wall[1], WALL[1])
    both = fit_circles(
        rays.at_places(twice),
        (replace(cap.at_places(twice), fall=falling), granite.at_places(twice)),
        appearance.slack, effort.edge_reach, 0.25 * views.pixel[twice], effort.rounds,
        (appearance.wall[0], walls),
    )  # fmt: skip
    return both.at_places(slice(n)), both.at_places(slice(n, None))


def _moved(fit: Fits, exact: Fits, rows: Places, share: Array) -> Fits:
    """Move the circles of some places, by a share of the way each, to where they are exactly."""
    shift, covariance, bends = fit.shift.copy(), fit.covariance.copy(), fit.bends.copy()
    shift[rows] += share[:, None] * (exact.shift - shift[rows])
    covariance[rows] += share[:, None, None] * (exact.covariance - covariance[rows])
    bends[rows] += share[:, None] * (exact.bends - bends[rows])
    return replace(fit, shift=shift, covariance=covariance, bends=bends)


def _by_light_alone(
    samples: Samples, rays: Rays, cap: Rim, views: Views, appearance: Appearance, effort: Effort
) -> Array:
    """Where caps' centres lie by the lightness of their edges, (n, 2), m; NaN if not found."""
    steps = by_lightness(samples.cap, samples.granite).astype(np.float32)[:, None, None]
    lit = fit_circles(
        rays, (replace(cap, fall=samples.falls[..., 0] * steps),), appearance.slack,
        effort.edge_reach, 0.25 * views.pixel, 1, appearance.wall,
    )  # fmt: skip
    return np.where(lit.ok[:, None], lit.shift, np.nan)
