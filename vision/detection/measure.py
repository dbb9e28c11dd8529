"""Discs measured where they are thought to be: all of one or more pictures at once, on rays.

Around each place the picture itself is sampled on rays. The edges of cap and granite (or the
rim of a plain disc) give the centre, and what lies between them the evidence for a stone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.appearance import Appearance
from curlshot.vision.detection.circles import fit_circles
from curlshot.vision.detection.contrast import mean_colours
from curlshot.vision.detection.edges import Views, fit_edges, mixtures_matter, visible_on
from curlshot.vision.detection.evidence import ENOUGH, evidence_of
from curlshot.vision.detection.hue import sharpened
from curlshot.vision.detection.patch import EFFORT, Effort, is_plain, over_caps, unrolled
from curlshot.vision.detection.rays import Look, Rays, cameras_of
from curlshot.vision.detection.rims import Rim, falls_along
from curlshot.vision.detection.samples import samples_on

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]
Flags = NDArray[np.bool_]

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
        (`curlshot.vision.detection.patch.Effort`): enough to follow what is known to be a stone,
        not to tell it is.
    light : ndarray, shape (n, 2)
        Where the cap's centre lies by the lightness of its edge alone, less the centre, m; NaN
        where it was not found, or not sought.
    swept : ndarray of bool, shape (n,)
        Whether it was seen how far a fast stone's cap is smeared, and the centre goes by that.
    bends : ndarray, shape (n, 6)
        How the edge of cap or disc is bent (`curlshot.vision.detection.circles.Fits`), m.
    outline : ndarray, shape (n, circles)
        Radii found, as shares of the nominal ones.
    wall : ndarray, shape (n,)
        How high the wall of the cap is, m; means nothing where it is not seen.
    handle : ndarray, shape (n, rays, rings, 3)
        What is around the centre (`curlshot.vision.detection.patch.unrolled`).
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
    views = Views(1 / scale, by.slants(places), np.concatenate(still))
    over = over_caps(looks, by, rays, disc) if mixtures_matter(views, appearance) else rays
    seen = _stones(rays, over, handle, places, views, appearance, disc, effort)
    doubtful = (seen.evidence > DOUBTFUL) & (seen.evidence < ENOUGH)
    doubtful &= seen.uncovered - seen.visible > UNCOVERED  # else there is nothing to uncover
    again = np.flatnonzero(doubtful & _on_paint(rays, appearance))
    if not len(again):
        return seen
    sharp = sharpened(rays.at_places(again), scale[again])
    # As a rule it uncovers nothing; to fit circles takes four times as long as to see that.
    shown = visible_on(samples_on(sharp, appearance, disc, effort), sharp, appearance, disc)
    if not (shown - seen.visible[again] > UNCOVERED).any():
        return seen
    clearer = _stones(
        sharp, over.at_places(again), handle[again], places[again], views.at_places(again),
        appearance, disc, effort,
    )  # fmt: skip
    return _better(seen, clearer, again)


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


def _stones(
    rays: Rays,
    over: Rays,
    handle: Bytes,
    places: Array,
    views: Views,
    appearance: Appearance,
    disc: Stone,
    effort: Effort,
) -> Measures:
    samples = samples_on(rays, appearance, disc, effort)
    edges = fit_edges(samples, rays, over, views, appearance, disc, effort)
    fit = edges.fit
    evidence, excused = evidence_of(samples, fit, views, appearance, disc, effort)
    return Measures(
        ok=samples.enough & fit.ok,
        centre=places + fit.shift,
        shift=np.hypot(fit.shift[:, 0], fit.shift[:, 1]),
        sd=_errors(fit.covariance, views.pixel, edges.doubt),
        colour=samples.cap,
        visible=edges.visible,
        uncovered=(samples.capped & rays.at(disc.cap_radius * appearance.outline[0])).mean(1),
        evidence=evidence,
        excused=excused,
        light=edges.light,
        swept=edges.swept,
        bends=fit.bends,
        outline=fit.radii / np.array([disc.cap_radius, disc.radius]),
        wall=fit.wall,
        handle=handle,
        worth=samples.worth,
        rays=rays,
    )


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
