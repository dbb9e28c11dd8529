"""How a stone is turned: its cap's picture against the clip's own picture of that cap.

A cap is described by its angular harmonics on rings about the centre. Turning the stone by
δ multiplies the harmonic k by exp(−i k δ), so the angle that brings two pictures together
is the maximum of their circular cross-correlation, found to a fraction of a sample. Every
frame is measured against the mean of all frames, so errors do not add up along the clip.
The mean over the angle (k = 0) says nothing; k = 1 is left out because a centre that is
slightly off and light from one side look like it.

The handle stands above the cap, and seen aslant its picture is shifted: what turns about the
stone's axis in a picture unrolled at one height does not at another. What is seen best may be the
grip, or its foot and the shade about it on the cap. So the cap is unrolled at both heights, and
that is believed at which a stone's pictures are most alike or, where that hardly tells, at which
more of them turns. `curlshot.vision.spin.align` finds what shift is left with the last bit of the
angle, `curlshot.vision.spin.inclined` how steeply a handle rises, and `curlshot.vision.spin.pitch`
what one looks turned by that is a little higher at one end.

Rings that something lies before are left out (`curlshot.vision.spin.cover`).
Light that stays as the cap turns is taken out; where lamps mirrored on the cap are brighter than
the handle, what turns is told by its spin first (`curlshot.vision.spin.glints`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.spin.align import (
    LASTING,
    ORDERS,
    Array,
    Complex,
    align,
    ring_weights,
    rings_seen,
)
from curlshot.vision.spin.bearing import bearing
from curlshot.vision.spin.cover import uncovered
from curlshot.vision.spin.facing import angle_between, angles_between
from curlshot.vision.spin.glints import course, unlit
from curlshot.vision.spin.half_turns import unfolded
from curlshot.vision.spin.inclined import TOLD, inclined, rise_of_handle
from curlshot.vision.spin.pitch import STEEP, levelled, of_axes
from curlshot.vision.spin.shade import parts, unturned, upright_mean

ODD, ODDEST = 0.2, 3.0
"""Share of a stone's pictures that their mean does not explain from which on its angles err more,
in proportion, and how much more at most: of 210 stones of three renderers and of films those with
0.3 and more had spins twice as far off, for their errors, as the others."""

ODDER, DIM = 1.25, 3.0
"""From which larger errors on they count again where less than `TURNS` of what no light explains
turns, and how often at most: of seven stones there with spins more than two errors off that was
less than half of that for five. Less odd ones are but covered by something for some time."""

MANY = 0.1
"""Share of pictures unlike those before from which on another one to begin with is tried."""

BEFORE, ALIKE = 2.0, 0.001
"""How much less like its mean than usual a picture is where something else lies before the cap (a
hand or a broom turns what is seen by a few tenths of a radian), and what is unlike by rounding."""

FULLY, SHORT, GAPS = 0.95, 1.0, 0.1
"""Share of pictures that their mean explains from which on nothing is amiss, time over which light
can hardly be told from what turns, s, and share of pictures without an angle that are many."""

LITTLE, HARDLY, RIM = 0.3, 0.6, 2
"""Share of pictures that their mean explains below which less than `LEAST` that turns is none, and
below which what turns is sought without the rim of the cap, and how many rings that is. A rim is
blurred into granite and light lies on it: handles in a cap's own colour are fainter. Where no more
than a tenth turned within the rim spins of drawn caps were told to half a radian a second at best;
two stones without anything that turned were told at rest, 2 rad/s off."""

LEAST, TURNS, CLEARLY = 0.05, 0.2, 3.0
"""Share of what no light explains that turns: where angles that follow spins may be the better
ones, if it is no less than where angles follow the light; where what turns is told by them, before
they are told for each picture and after; and how much more that must be than where angles follow
the light. Of 64 caps drawn with lamps, blurred, covered or aslant all that stood still with the
light had 0.1 at most, those that turned 0.2 and more, and noise taken for turning caps 0.17; where
angles followed spins rightly that was 3.9 times as much and more, else 1.5, and 2.5 with a sweeper
over the cap. A broom that goes over a cap at rest has 0.19 at most before angles may give way to
it, and up to 0.36 after. Faint handles whose angles were lost in noise have 0.06 and more."""

REACHES = (0.5, 0.5, 0.2, 0.2)
"""How far from angles that follow spins they are sought, rad, one time after another: hits change
spins within a stretch over which one is told."""

DOUBT = 1.25
"""How much more of the pictures at the grip's height than of those at the cap's is unlike their
mean where the cap's are believed for that alone: beyond it no stone of three renderers and of films
was told better at the grip, below it two in three where the two differ."""

MOST_APART = 0.3
"""How much of an error angles at two heights of which neither is clearly better tell of at most,
rad: farther apart one of them has lost the stone."""

UNTOLD = 0.1
"""Share of a cap's picture that no light explains below which it tells no angle."""

WORST = 4.0
"""By how much errors of covered pictures are larger at most than they say: the most unlike ones of
60 clips err two to three times as much, and some of them for a second on end."""

UNSURE = 0.5
"""Standard error of a stone's angles in the median, rad, from which on none is told: that far off
pictures are about as much like another part of a handle, and an error is none of a peak any more.
Of fifteen drawn stones with such angles two had spins 2.4 and 1.6 rad/s off, six and three of their
errors; the spins of most were stated to .2 to .7 rad/s."""


@dataclass(frozen=True)
class HandleAngles:
    """How a stone is turned, and at which height what turns on it is seen.

    Attributes
    ----------
    theta, sd : ndarray, shape (n,)
        Angle and its standard error, rad; NaN where it cannot be told.
    rise : ndarray, shape (n, 2)
        What angles are off by together, if the handle rises by one standard error more along either
        axis of the cap, rad (`curlshot.vision.spin.pitch`); it is no part of `sd`.
    unlike : ndarray, shape (heights,)
        How many pictures' worth of what was seen their mean does not explain, by the height at
        which caps were unrolled; 0 where nothing was seen.
    heights : frozenset of int
        Which of them were believed: one, several by parts of a long track, none where nothing was
        seen.
    """

    theta: Array
    sd: Array
    rise: Array
    unlike: Array
    heights: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Turning:
    """How angles are followed.

    Attributes
    ----------
    reach : float
        How far from the expected angle a stone is looked for, rad.
    most_spin : float
        How much that reach grows per second without a detection, rad/s.
    lost : float
        Time without an angle after which a stone may be turned anyhow, s.
    least_likeness : float
        Correlation (0 to 1) with the stone's own picture below which nothing is said.
    leading : float
        Correlation from which on a picture has a say in how the next ones are expected to be
        turned and to look: sweepers over a cap led angles round step by step, half a turn off.
    rounds : int
        How often the mean picture is built anew.
    shift : float
        How far from where it is expected the handle's picture lies by its height, a standard
        deviation, m.
    """

    reach: float = 0.30
    most_spin: float = 3.0
    lost: float = 1.0
    least_likeness: float = 0.45
    leading: float = 0.6
    rounds: int = 3
    shift: float = 0.001


TURNING = Turning()


def cap_spectrum(patch: NDArray[np.uint8], radii: Array) -> Complex:
    """Angular harmonics of a cap.

    Parameters
    ----------
    patch : ndarray, shape (..., rays, rings, channels)
        Colours on rays counter-clockwise from the x axis.
    radii : ndarray
        Radii of the rings, m; they begin anew where the cap was unrolled at several heights.

    Returns
    -------
    ndarray, shape (..., orders, rings, channels)
        Of the orders `curlshot.vision.spin.align.ORDERS`, each ring with its weight.
    """
    spectrum = np.fft.rfft(patch.astype(np.float32), axis=-3)[..., ORDERS, :, :] / patch.shape[-3]
    weight = np.resize(ring_weights(radii), patch.shape[-2])
    return np.asarray(spectrum * weight[:, None], np.complex64)


def handle_angles(
    times: Array,
    spectra: Sequence[Complex | None],
    radii: Array,
    sd_centre: Array,
    slants: Array | None = None,
) -> HandleAngles:
    """Angle of one stone in every frame, continuous.

    It is the direction of the handle, on the ice, or half a turn off; where no handle stands out of
    the cap (`curlshot.vision.spin.bearing`) its zero is the first frame seen.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    spectra : sequence of ndarray or None
        From `cap_spectrum`, the heights at which the cap was unrolled side by side along the
        rings; None where the cap is not seen well.
    radii : ndarray, shape (rings,)
        Of the rings at one height, m.
    sd_centre : ndarray, shape (n,)
        Standard error per axis of the centres about which the cap was unrolled, m.
    slants : ndarray, shape (n, 2), optional
        Of the view of each place; from above if not given.

    Returns
    -------
    HandleAngles
    """
    theta, sd = np.full(len(times), np.nan), np.full(len(times), np.nan)
    rise = np.zeros((len(times), 2))
    seen = np.array([index for index, item in enumerate(spectra) if item is not None], np.intp)
    if not len(seen):
        return HandleAngles(theta, sd, rise, np.zeros(1))
    pictures = uncovered(np.array([spectra[index] for index in seen]))
    nothing = HandleAngles(theta, sd, rise, np.zeros(pictures.shape[2] // len(radii)))
    clear = rings_seen(pictures).any(1)
    seen, pictures = seen[clear], pictures[clear]
    if len(seen) < 2:  # an angle is against another picture of the same stone
        return nothing
    by = _without_rim_if_better(times[seen], pictures, len(radii))
    del pictures
    best, radii = by.best, radii[: by.rings]
    if not _tells_angles(best):
        return nothing
    good = best.likeness > TURNING.least_likeness
    rows, own = seen[good], best.pictures[good]
    aside = np.hypot(TURNING.shift, sd_centre[rows])
    fit = align(own, best.angles[good], radii, aside)
    angle, risen, steep = fit.angle, rise[rows], STEEP
    if slants is not None:
        uphill = rise_of_handle(times[rows], own, fit.angle, radii, slants[rows], aside)
        if uphill is not None:
            own = inclined(own, fit.angle, radii, slants[rows], uphill)
            fit, steep = align(own, fit.angle, radii, aside), TOLD
        angle, risen = levelled(own, fit.angle, radii, slants[rows], steep)
    error = np.hypot(LASTING * _oddness(best) * _covered(best)[good] * fit.sd, by.apart[good])
    if np.median(np.hypot(error, np.sqrt((risen**2).sum(1).mean()))) > UNSURE:
        return nothing
    begin, angle = float(angle[0]), angle - angle[0]
    upright = upright_mean(own, angle, rings_seen(own)[:, None, :, None])
    zero = bearing(upright) or 0.0
    theta[rows], sd[rows], rise[rows] = angle + zero, error, of_axes(risen, zero - begin)
    return HandleAngles(theta, sd, rise, by.unlike, frozenset({by.height}))


@dataclass(frozen=True)
class _ByHeight:
    """Pictures of the height that is believed, which one it is, and how they differ by height.

    `rings` is how many of the rings, from the innermost, they were matched by, `apart` (n,) how far
    apart their angles are, rad, and `unlike` (heights,) how many pictures' worth of each height
    their mean does not explain.
    """

    best: _Matched
    height: int
    rings: int
    apart: Array
    unlike: Array


def _without_rim_if_better(times: Array, pictures: Complex, rings: int) -> _ByHeight:
    """Turn pictures onto their mean; by the rings within the rim if hardly anything tells else."""
    by = _of_heights(times, pictures, rings)
    if not _hardly_told(by.best):
        return by
    within = rings - RIM
    inner = np.resize(np.arange(rings) < within, pictures.shape[2])
    other = _of_heights(times, pictures[:, :, inner], within)
    better = max(by.best.share, 2 * LEAST) < other.best.share and _mostly_told(other.best)
    return other if better else by


def _of_heights(times: Array, pictures: Complex, rings: int) -> _ByHeight:
    """Turn pictures onto their mean at the height that tells more."""
    heights = np.split(pictures, pictures.shape[2] // rings, axis=2)
    tried = [_matched(times, part) for part in heights]
    unlike = np.array([len(times) - _alike(each) for each in tried])
    which = int(unlike.argmin())
    if which and _doubtful(*unlike):
        # Light and shade on the cap make pictures alike that do not turn.
        both = [_by_what_turns(times, *each) for each in zip(heights, tried, strict=True)]
        which = int(np.argmax([each.share for each in both]))
        best = both[which]
    else:
        best = _despite_light(times, heights[which], tried[which])
    return _ByHeight(best, which, rings, _apart(tried, unlike), unlike)


@dataclass(frozen=True)
class _Matched:
    """Pictures of one height, their angles against their mean, and how like it they are.

    And the share of what no light explains that turns, 1 where that is not told.
    """

    pictures: Complex
    angles: Array
    likeness: Array
    share: float = 1.0


def _tells_angles(best: _Matched) -> bool:
    """Whether there is something on the cap that tells how it is turned."""
    count = len(best.angles)
    if (best.likeness > TURNING.least_likeness).sum() < max(0.5 * count, 2):
        return False  # most pictures do not look like their mean
    # What hardly any picture has in common, and what does not turn: light, not the cap.
    return best.share >= LEAST or _alike(best) >= LITTLE * count


def _oddness(best: _Matched) -> float:
    """How many times more angles err, for what their mean does not explain of the pictures."""
    odd = float(np.clip((1 - _alike(best) / len(best.angles)) / ODD, 1.0, ODDEST))
    dim = float(np.clip(TURNS / max(best.share, 1e-6) - 1, 0.0, DIM))
    return odd + dim * max(odd - ODDER, 0.0)


def _covered(best: _Matched) -> Array:
    """How many times more the angle of each picture errs, for what lies before the cap, (n,).

    Against the pictures that tell an angle.
    """
    unlike = np.maximum(1 - best.likeness**2, ALIKE)
    usual = np.median(unlike[best.likeness > TURNING.least_likeness])
    return np.asarray(np.clip((unlike / (BEFORE * usual)) ** 2, 1.0, WORST))


def _hardly_told(matched: _Matched) -> bool:
    """Whether pictures are little alike, and few tell an angle or hardly anything turns."""
    little = _alike(matched) < HARDLY * len(matched.angles)
    return little and (matched.share < LEAST or not _mostly_told(matched))


def _alike(matched: _Matched) -> float:
    """Sum over the pictures of what share of them the mean picture explains."""
    return float((matched.likeness**2).sum())


def _doubtful(unlike: float, other: float) -> bool:
    """Whether pictures are hardly less alike at one height than at the other."""
    return unlike < DOUBT * other


def _apart(tried: Sequence[_Matched], unlike: Array) -> Array:
    """How far apart the angles of both heights are where neither is clearly better, (n,), rad."""
    count = len(tried[0].angles)
    if len(tried) < 2 or not (_doubtful(*unlike) and _doubtful(*unlike[::-1])):
        return np.zeros(count)
    off = tried[1].angles - tried[0].angles
    told = np.flatnonzero(np.isfinite(off))
    if not len(told):
        return np.zeros(count)
    each = np.interp(np.arange(count), told, off[told])
    return np.asarray(np.minimum(np.abs(each - np.median(off[told])), MOST_APART))


def _by_what_turns(times: Array, pictures: Complex, matched: _Matched) -> _Matched:
    """Turn pictures of one height onto their mean, and tell what share of them turns."""
    best = _despite_light(times, pictures, matched)
    told = np.isfinite(best.angles)
    angles = np.interp(times, times[told], best.angles[told]) if told.any() else 0 * times
    return replace(best, share=unlit(times, pictures, angles).share)


def _matched(times: Array, pictures: Complex) -> _Matched:
    """Turn pictures of one height onto their mean, from one to the next."""
    angles = unfolded(times, pictures, _followed(times, pictures))
    return _onto_mean(times, pictures, angles)


def _despite_light(times: Array, pictures: Complex, matched: _Matched) -> _Matched:
    """Turn pictures onto the part of them that turns, where gaps or light led their angles."""
    known = np.isfinite(matched.angles)
    if times[-1] - times[0] < SHORT or _alike(matched) > FULLY * len(times) or not known.any():
        return matched
    angles = np.interp(times, times[known], matched.angles[known])
    share = unlit(times, pictures, angles).share
    matched = replace(matched, share=share)
    if share > TURNS and known.mean() > 1 - GAPS:
        return matched
    other, share_of_course = course(times, pictures)
    if share > share_of_course and not _mostly_told(matched):
        other, share_of_course = angles, share  # where gaps would leave no angle at all
    if share_of_course < max(LEAST, share):
        return matched
    if share_of_course > TURNS:  # what goes over a cap turns once angles may give way to it
        dark = _onto_what_turns(times, pictures, other)
        if dark.share > max(TURNS, CLEARLY * share) and _mostly_told(dark):
            return dark
    onto = replace(_onto_mean(times, pictures, other), share=share_of_course)
    return max(matched, onto, key=_alike)


def _onto_what_turns(times: Array, pictures: Complex, angles: Array) -> _Matched:
    """Turn pictures onto the part of them that turns, angles known to some tenths of a radian."""
    shown = rings_seen(pictures)[:, None, :, None]
    dark, likeness = unlit(times, pictures, angles), np.zeros(len(times))
    for reach in REACHES:
        told, likeness = angles_between(dark.cap, dark.pictures * shown, angles, reach)
        angles = np.where(np.isfinite(told), told, angles)  # of a blank picture as expected
        dark = unlit(times, pictures, angles)
    likeness = np.where(dark.told > UNTOLD, likeness, 0.0)
    return _Matched(dark.pictures * shown, angles, likeness, dark.share)


def _mostly_told(matched: _Matched) -> bool:
    """Whether most pictures tell an angle."""
    return bool(np.mean(matched.likeness > TURNING.least_likeness) >= 0.5)


def _onto_mean(times: Array, pictures: Complex, angles: Array) -> _Matched:
    """Turn pictures onto their mean, angles being about known."""
    likeness, known = np.zeros(len(angles)), np.isfinite(angles)
    shown = rings_seen(pictures)[:, None, :, None]
    own = pictures
    for _ in range(TURNING.rounds):
        reference = upright_mean(own, angles, shown)
        for part in parts(np.flatnonzero(known)):
            angles[part], likeness[part] = angles_between(reference, own[part], angles[part], 0.2)
        known = np.isfinite(angles)  # some show nothing but light
        own = pictures - unturned(pictures[known], angles[known], shown[known])
        own *= shown
    return _Matched(own, angles, likeness)


def _followed(times: Array, pictures: Complex) -> Array:
    """Angles from picture to picture; NaN where unlike those before.

    From the first of the pictures that show most; where that leaves many unlike it, as where a
    slanting view has the handle before the cap at first, from amidst those, and the better is kept.
    """
    angles = _followed_from(int(rings_seen(pictures).sum(1).argmax()), times, pictures)
    lost = np.flatnonzero(np.isnan(angles))
    if len(lost) > MANY * len(times):
        amidst = int(lost[len(lost) // 2])
        again = _followed_from(amidst, times, pictures)
        if np.isnan(again).sum() < len(lost):
            return again
    return angles


def _followed_from(begin: int, times: Array, pictures: Complex) -> Array:
    """Angles from one picture onwards and then back, each against the running mean."""
    angles = np.full(len(times), np.nan)
    angles[begin] = 0.0
    mean, weight = pictures[begin].copy(), 1.0
    shown = rings_seen(pictures[:, 1:-1])
    for way in (range(begin + 1, len(times)), range(begin - 1, -1, -1)):
        before, told, spin = begin, begin, 0.0
        for index in way:
            wait = times[index] - times[before]
            reach = min(TURNING.reach + TURNING.most_spin * abs(wait), 1.5)
            if abs(times[index] - times[told]) > TURNING.lost:
                reach = np.pi
            expected = float(angles[before] + spin * wait)
            angle, likeness = angle_between(mean, pictures[index], expected, reach, shown[index])
            if not likeness > TURNING.least_likeness:
                continue
            angles[index], told = angle, index
            if likeness < TURNING.leading:
                continue
            spin += 0.3 * ((angle - angles[before]) / wait - spin)
            before = index
            weight = min(weight + 1.0, 30.0)
            phase = np.exp(1j * angle * ORDERS).astype(np.complex64)
            mean += (pictures[index] * phase[:, None, None] - mean) / weight
    return angles
