"""Discs measured where they are thought to be: all of one or more pictures at once, on rays.

Around each place the picture itself is sampled on rays. The edges of cap and granite (or the
rim of a plain disc) give the centre, and what lies between them the evidence for a stone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data.sheet import Stone
from vision.detection.appearance import GREY, Appearance, membership
from vision.detection.circles import WALL, fit_circles, medians
from vision.detection.contrast import by_hue, by_lightness, mean_colours, own_worth
from vision.detection.hue import sharpened
from vision.detection.mixture import by_light
from vision.detection.patch import (
    CAP_END,
    EFFORT,
    INNER_RING,
    OUTER_RING,
    RING_BEGIN,
    RING_END,
    Effort,
    in_granite,
    is_plain,
    over_caps,
    profile_of,
    unrolled,
)
from vision.detection.rays import Look, Rays, cameras_of, directions
from vision.detection.rims import Rim, falls_along, summed
from vision.detection.shoulder import HIDDEN, against_beyond
from vision.detection.smeared import middles, swept_share
from vision.film.lab import chroma

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]
Flags = NDArray[np.bool_]

PALER = 3.0
"""Standard deviations of the granite's lightness by which the ring around a cap is lighter at most.
Under lamps thrown stones have 2.3; ice that letters of a cap's colour enclose 4 to 5."""

CLEARLY = 0.3
"""Worth from which a sample counts as one of the cap; of the granite, less than its negative."""

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
"""Share of a stone to be seen for that, and how near to where it is looked for, m: of one half
covered, or not yet come upon, whole steps tell more."""

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

DARK = 0.5
"""Lightness, as a share of that of the rest of a stone's granite, below which something covers it:
its own dark side has 0.8 of it, dark clothes 0.05 to 0.5. What is lighter may be ice behind a low
shoulder."""

ON_ONE_SIDE = 0.2, 0.5
"""From how far around both edges of a stone are seen on one side that counts for it, and up to how
far it counts more. On clothes edges like a stone's lie here and there, on 0.1 to 0.35 of the way
around at one side; of a stone that somebody covers by half 0.35 to 0.5 shows them. Before colours
are learned, paint would profit as well."""

ENOUGH = 1.6
"""Evidence that such an arc adds nothing to: what changes with it would look like a stone that has
been pushed aside."""

DOUBTFUL = 0.2
"""Evidence below which a place is no stone, however its granite may be tinged: on red paint red
caps coded as usual show 0.3 and more."""

TINGED, AROUND = 30.0, 0.25
"""Difference of hue from granite, L*a*b* units, from which paint tinges the granite beside it, and
on what share of the way around a stone it must."""

UNCOVERED = 0.04
"""How much more of the way around sharper hue must show granite, to count: of a stone on paint as
vivid as its cap 0.1 to 0.3, of hair on a jersey 0.02 at most."""


@dataclass(frozen=True)
class Measures:
    """What was seen at n places.

    Attributes
    ----------
    ok : ndarray of bool, shape (n,)
        Where circles could be fitted at all; the rest means nothing elsewhere.
    centre : ndarray, shape (n, 2)
        Places on the ice under the centres, m.
    shift : ndarray, shape (n,)
        How far they are from where they were looked for, m.
    sd : ndarray, shape (n, 2)
        Standard errors that are anew in each picture, m.
    colour : ndarray, shape (n, 3)
        Of cap or disc, L*a*b*.
    visible : ndarray, shape (n,)
        Share of the circle that was seen.
    uncovered : ndarray, shape (n,)
        Share of the rays on which the cap was seen, whatever is around it.
    evidence : ndarray, shape (n,)
        For a stone 0 to about 3, for a plain disc 0 to 1.
    excused : ndarray, shape (n,)
        How much more of it there would be but for a hue that is coded coarsely
        (`vision.detection.patch.Effort`): enough to follow what is known to be a stone, not to tell
        it is.
    light : ndarray, shape (n, 2)
        Where the edge of the cap by its lightness alone has its middle, off the centre, m; NaN
        where it was not found, or not sought.
    swept : ndarray of bool, shape (n,)
        Whether it was seen how far a fast stone's cap is smeared, and the centre goes by that.
    bends : ndarray, shape (n, 6)
        How the edge of cap or disc is bent (`vision.detection.circles.Fits`), m.
    outline : ndarray, shape (n, circles)
        Radii found, as shares of the nominal ones.
    wall : ndarray, shape (n,)
        How high the wall of the cap is, m; means nothing where it is not seen.
    handle : ndarray, shape (n, rays, rings, 3)
        What is around the centre (`vision.detection.patch.unrolled`).
    worth : ndarray, shape (n, rays, radii)
        What the samples of `rays` may be: 1 cap, −1 granite, 0 neither.
    rays : Rays
    """

    ok: Flags
    centre: Array
    shift: Array
    sd: Array
    colour: Array
    visible: Array
    uncovered: Array
    evidence: Array
    excused: Array
    light: Array
    swept: Flags
    bends: Array
    outline: Array
    wall: Array
    handle: Bytes
    worth: Floats
    rays: Rays


def measure_discs(
    looks: Sequence[Look],
    appearance: Appearance | None,
    disc: Stone,
    effort: Effort = EFFORT,
) -> Measures:
    """Measure the discs at places of pictures.

    Parameters
    ----------
    looks : sequence of Look
        Pictures of one size and n places in all; the measures are in their order.
    appearance : Appearance or None
        What stones look like here; not used for a plain disc.
    disc : Stone
        Size of the discs.
    effort : Effort
        How each place is measured.
    """
    by = cameras_of(looks)
    rays, handle = unrolled(looks, by, disc, effort)
    places = np.concatenate([look.places for look in looks])
    scale = by.scale_at(places)
    if is_plain(disc):
        return _plain(rays, handle, places, scale, disc, effort)
    assert appearance is not None
    still = [
        np.zeros((len(look.places), 2)) if look.drift is None else look.drift for look in looks
    ]
    slant, drift = by.slants(places), np.concatenate(still)
    beyond = ASLANT[0] if _without_hue(appearance) else HIDDEN[0]
    steep = np.hypot(*slant.T).max(initial=0.0) > beyond
    over = over_caps(looks, by, rays, disc) if steep else rays

    def stones(rays: Rays, over: Rays, rows: slice | NDArray[np.intp]) -> Measures:
        return _stones(
            rays, over, handle[rows], places[rows], scale[rows], slant[rows], drift[rows],
            appearance, disc, effort,
        )  # fmt: skip

    seen = stones(rays, over, slice(None))
    doubtful = (seen.evidence > DOUBTFUL) & (seen.evidence < ENOUGH)
    doubtful &= seen.uncovered - seen.visible > UNCOVERED  # else there is nothing to uncover
    again = np.flatnonzero(doubtful & _on_paint(rays, appearance))
    if not len(again):
        return seen
    sharp = stones(sharpened(rays.at_places(again), scale[again]), over.at_places(again), again)
    return _better(seen, sharp, again)


def _on_paint(rays: Rays, appearance: Appearance) -> Flags:
    """Whether what is around a stone is so vivid that it tinges the granite, shape (n,)."""
    if appearance.granite is None:
        return np.zeros(len(rays.lab), bool)
    hue = rays.lab[:, :, -1, 1:].astype(float) - appearance.granite.mean[1:]
    return np.asarray((np.hypot(hue[..., 0], hue[..., 1]) > TINGED).mean(1) > AROUND)


def _better(first: Measures, second: Measures, places: NDArray[np.intp]) -> Measures:
    """Take the second measures of some places where they show more of a stone than the first."""
    more = second.visible - first.visible[places] > UNCOVERED
    more &= second.evidence > first.evidence[places]
    rows = places[more]
    best: dict[str, Any] = {}
    for item in fields(Measures):
        old, new = getattr(first, item.name), getattr(second, item.name)
        if isinstance(old, Rays):
            best[item.name] = old.replaced(rows, new.at_places(np.flatnonzero(more)))
        else:
            best[item.name] = old.copy()
            best[item.name][rows] = new[more]
    return Measures(**best)


def well_within(radius: Array, disc: Stone) -> tuple[slice, slice]:
    """Tell which of the radii lie on a stone's cap, and which on its granite, not near an edge."""
    ends = [
        0.88 * disc.cap_radius,
        *(in_granite(disc, share) for share in (INNER_RING, OUTER_RING)),
    ]
    cap, first, last = np.searchsorted(radius, ends).tolist()
    return slice(0, cap), slice(first, last)


@lru_cache(maxsize=8)
def _template(disc: Stone, effort: Effort) -> Array:
    """Weights of the radii in the mean over the cap less the mean over the granite."""
    radius = profile_of(disc, effort).radius[: effort.radii]
    cap = radius * (radius < CAP_END * disc.cap_radius)
    first, last = (in_granite(disc, share) for share in (RING_BEGIN, RING_END))
    ring = radius * ((radius > first) & (radius < last))
    return np.asarray(cap / cap.sum() - ring / ring.sum())


def _worth(rays: Rays, appearance: Appearance, cap: slice, ring: slice, template: Array) -> Floats:
    """Say what samples may be by the colours that are known, their own, or what tells more."""
    table = appearance.membership
    if table is not None and not appearance.own:
        return membership(rays.bgr, table)
    granite = None if appearance.granite is None else appearance.granite.mean
    own = own_worth(rays.lab, cap, ring, granite)
    if table is None:
        return own
    known = membership(rays.bgr, table)
    more = (own - known).mean(1) @ template > 0
    return np.where(more[:, None, None], own, known)


def _stones(
    rays: Rays,
    over: Rays,
    handle: Bytes,
    places: Array,
    scale: Array,
    slant: Array,
    drift: Array,
    appearance: Appearance,
    disc: Stone,
    effort: Effort,
) -> Measures:
    lab = rays.lab.astype(np.float32)
    falls = falls_along(lab)
    in_cap, in_ring = well_within(rays.radius, disc)
    worth = _worth(rays, appearance, in_cap, in_ring, _template(disc, effort))
    if not rays.inside.all():
        worth *= rays.inside
    of_cap, of_ring = worth[..., in_cap] > CLEARLY, worth[..., in_ring] < -CLEARLY
    cap = mean_colours(lab[..., in_cap, :], of_cap.astype(np.float32))
    granite = mean_colours(lab[..., in_ring, :], of_ring.astype(np.float32))
    apart = by_hue(cap, granite)
    along = apart.astype(np.float32)[:, None, :, None]
    half = ((granite * apart).sum(1) + 0.5).astype(np.float32)[:, None, None]
    signal = (lab @ along)[..., 0] - half
    seen_cap, seen_ring = rays.inside[..., in_cap], rays.inside[..., in_ring]
    capped = summed((signal[..., in_cap] > 0) & seen_cap) > 0.4 * np.maximum(summed(seen_cap), 1)
    stone_like = (worth[..., in_ring] < 0.1) & (signal[..., in_ring] < 0.05) & seen_ring
    in_view = np.maximum(summed(seen_ring), 1)
    light = summed(lab[..., in_ring, 0] * seen_ring) / in_view
    greyed = summed(stone_like) > 0.4 * in_view
    level = medians(light, capped & greyed)[:, None]
    greyed &= light > DARK * level
    cap_radius, rim_radius = np.array([disc.cap_radius, disc.radius]) * appearance.outline
    stony = capped & greyed
    at_cap, at_rim = rays.at(cap_radius), rays.at(rim_radius)
    whole = np.ones(len(places))
    behind = slant @ directions(effort.rays)[1].T
    cap_rim = Rim(
        (falls @ along)[..., 0], stony, at_cap, cap_radius, 0.12 * cap_radius, 0.3, whole,
        lean=np.maximum(-behind, 0),
    )  # fmt: skip
    edges = np.sqrt((falls * falls) @ np.ones(3, np.float32))
    # Seen aslant, the granite's outline is not a circle of one height.
    falling_off = 2 * (1 - disc.rim_height / disc.cap_height)
    trust = 1 / (1 + falling_off**2 * (slant**2).sum(1) / effort.most_tilt**2)
    granite_rim = Rim(edges, greyed, at_rim, rim_radius, 0.05 * rim_radius, 12.0, trust, GRANITE)
    pixel = 1 / scale
    visible = (stony & at_cap).mean(1)
    # Whether there is a stone is asked of whole steps of colour; where it is, of their middle. Both
    # fits are made together: for the few places of most pictures that is as quick as one.
    leaning = np.clip((np.hypot(*slant.T) - ASLANT[0]) / (ASLANT[1] - ASLANT[0]), 0.0, 1.0)
    dark = (granite[:, 0] - cap[:, 0] > DARKER) & (leaning > 0) & _without_hue(appearance)
    dark &= chroma(cap) < GREY
    leaning[dark] = 1.0
    clear = np.flatnonzero((visible > OPEN) & (leaning > 0) & bool(appearance.caps))
    mixed = clear[dark[clear]]
    twice = np.concatenate([np.arange(len(places)), clear])
    steep = clear[(behind[clear] > HIDDEN[0]).any(1) & ~dark[clear]]
    if len(steep):
        signal[steep] = against_beyond(
            signal[steep], over.at_places(steep), behind[steep], of_cap[steep], disc, pixel[steep]
        )
    if len(mixed):
        signal[mixed] = by_light(
            rays.at_places(mixed), over.at_places(mixed), behind[mixed], of_cap[mixed],
            (in_ring, of_ring[mixed]), disc, cap_radius, pixel[mixed],
        )  # fmt: skip
    flank = np.where(behind[clear] > HIDDEN[0], FAR_FLANK, FLANK).astype(np.float32)[..., None]
    steps = np.clip(signal[clear], -flank, flank) / (2 * flank)
    middle = falls_along(steps[..., None])[..., 0]
    falling = np.concatenate([cap_rim.fall, middle])
    walls = np.where(np.arange(len(twice)) < len(places), appearance.wall[1], WALL[1])
    both = fit_circles(
        rays.at_places(twice),
        (replace(cap_rim.at_places(twice), fall=falling), granite_rim.at_places(twice)),
        appearance.slack, effort.edge_reach, 0.25 * pixel[twice], effort.rounds,
        (appearance.wall[0], walls),
    )  # fmt: skip
    fit, exact = (both.at_places(part) for part in (slice(len(places)), slice(len(places), None)))
    # All around, a stone's granite is of one lightness, and its cap is as large as any other's;
    # caps and shoulders of people are neither. Behind a shoulder that falls off ice may shine.
    odd = light - level
    odd = np.where(falling_off * behind > effort.most_tilt, np.minimum(odd, 0), odd)
    uneven = np.sqrt((odd**2 * stony).sum(1) / np.maximum(stony.sum(1), 1)) / 40
    of_hue = 1 - ((cap - granite) * apart)[:, 0]
    usual = 0.06 + appearance.slack
    coarser = usual + effort.coarse * of_hue * pixel / cap_radius
    enough = (of_cap.mean((1, 2)) > 0.03) & (of_ring.mean((1, 2)) > 0.03)
    response = worth.mean(1) @ _template(disc, effort)
    shown = fit.shares.sum(1) - uneven + 0.5 * response
    whole = 2 * (np.clip(fit.unbroken, *ON_ONE_SIDE) - ON_ONE_SIDE[0])

    def told(spread: Array | float) -> Array:
        misfit = ((fit.radii[:, 0] / cap_radius - 1) / spread) ** 2
        evidence, more = shown - 0.5 * misfit, whole - 0.25 * misfit
        enlarged = np.where(evidence < ENOUGH, np.minimum(evidence + more, ENOUGH), evidence)
        return np.asarray(enlarged if appearance.caps else evidence)

    evidence, pale = told(usual), _paler(level[:, 0], appearance)
    near = exact.ok & (np.hypot(fit.shift[clear, 0], fit.shift[clear, 1]) < NEAR)
    rows, share = clear[near], leaning[clear[near], None]
    shift, covariance, bends = fit.shift.copy(), fit.covariance.copy(), fit.bends.copy()
    shift[rows] += share * (exact.shift[near] - shift[rows])
    covariance[rows] += share[..., None] * (exact.covariance[near] - covariance[rows])
    bends[rows] += share * (exact.bends[near] - bends[rows])
    lightness = np.full((len(places), 2), np.nan)
    if effort.light:
        steps = by_lightness(cap, granite).astype(np.float32)[:, None, None]
        light_rim = replace(cap_rim, fall=falls[..., 0] * steps)
        lit = fit_circles(
            rays, (light_rim,), appearance.slack, effort.edge_reach, 0.25 * pixel, 1,
            appearance.wall,
        )  # fmt: skip
        lightness = np.where(lit.ok[:, None], lit.shift - shift, np.nan)
    # What displaces the edges of one side is made good by the other side, if that is seen.
    hidden = np.tile(0.04 * disc.radius * (1 - visible)[:, None], 2)
    swept = np.zeros(len(places), bool)
    told_by_light = np.zeros(len(places), bool)
    told_by_light[rows] = dark[rows]
    moves = (swept_share(drift) > 0) & fit.ok & (visible > OPEN)
    swept |= moves & told_by_light
    hidden[swept] = np.hypot(hidden[swept], DRAWN_OUT * np.abs(drift[swept]))
    lightness[swept] = np.nan
    fast = np.flatnonzero(moves & ~told_by_light)
    if len(fast):
        part, by_edges = rays.at_places(fast), shift[fast]
        swept[fast], shift[fast], off = middles(signal[fast], part, disc, by_edges, drift[fast])
        hidden[fast] = np.hypot(hidden[fast], off)
        lightness[fast[off.any(1)]] = np.nan
    return Measures(
        ok=enough & fit.ok,
        centre=places + shift,
        shift=np.hypot(shift[:, 0], shift[:, 1]),
        sd=_errors(covariance, pixel, hidden),
        colour=cap,
        visible=visible,
        uncovered=(capped & at_cap).mean(1),
        evidence=evidence - pale,
        excused=told(coarser) - evidence,
        light=lightness,
        swept=swept,
        bends=bends,
        outline=fit.radii / np.array([disc.cap_radius, disc.radius]),
        wall=fit.wall,
        handle=handle,
        worth=worth,
        rays=rays,
    )


def _without_hue(appearance: Appearance) -> bool:
    """Whether some caps of the clip are black, grey or white."""
    return any(cap.grey for cap in appearance.caps)


def _paler(level: Array, appearance: Appearance) -> Array:
    """Say what it counts against a stone that the ring around its cap is too light for granite.

    Parameters
    ----------
    level : ndarray, shape (n,)
        Lightness of the rings, L*.
    appearance : Appearance

    Returns
    -------
    ndarray, shape (n,)
        To be taken off the evidence; 0 where no granite is known.
    """
    if appearance.granite is None:
        return np.zeros(len(level))
    away = level - appearance.granite.mean[0]
    sd = np.sqrt(appearance.granite.covariance[0, 0])
    return np.asarray(np.maximum(away / sd - PALER, 0.0))


def _plain(
    rays: Rays, handle: Bytes, places: Array, scale: Array, disc: Stone, effort: Effort
) -> Measures:
    n, pixel = len(places), 1 / scale
    # Colours mix in a blurred edge as they are coded: in L*a*b* its middle would lie elsewhere, by
    # what is beyond it, and a ring of paint under the rim would draw the disc aside.
    falls = falls_along(rays.bgr.astype(np.float32))
    steps = np.sqrt((falls * falls) @ np.ones(3, np.float32))
    at_rim = rays.at(disc.radius)
    rim = Rim(steps, at_rim, at_rim, disc.radius, 0.06 * disc.radius, 20.0, np.ones(n))
    fit = fit_circles(rays, (rim,), 0.03, effort.edge_reach, 0.25 * pixel, effort.rounds)
    within = rays.inside & (rays.radius < 0.8 * disc.radius)
    visible = fit.shares[:, 0] * at_rim.mean(1)
    return Measures(
        ok=fit.ok,
        centre=places + fit.shift,
        shift=np.hypot(fit.shift[:, 0], fit.shift[:, 1]),
        sd=_errors(fit.covariance, pixel, np.zeros((n, 2))),
        colour=mean_colours(rays.lab.astype(np.float32), within.astype(np.float32)),
        visible=visible,
        uncovered=visible,
        evidence=fit.shares[:, 0],
        excused=np.zeros(n),
        light=np.full((n, 2), np.nan),
        swept=np.zeros(n, bool),
        bends=fit.bends,
        outline=fit.radii / disc.radius,
        wall=fit.wall,
        handle=handle,
        worth=np.zeros(within.shape, np.float32),
        rays=rays,
    )


def _errors(covariance: Array, pixel: Array, hidden: Array) -> Array:
    # Half of the edges' misfit is the stone's own shape, which stays from picture to picture.
    own = 0.5 * np.maximum(np.diagonal(covariance, axis1=1, axis2=2), 0)
    return np.asarray(np.sqrt(own + (0.07 * pixel[:, None]) ** 2 + hidden**2))
