"""Restitution and friction from the paths on either side of the hits, never across them.

Nothing is differentiated twice. See `curlshot.physics.local_fit.fit` for the model.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.results import Estimate, Friction, Glide, Hit
from curlshot.data.sheet import GRAVITY
from curlshot.physics.local_fit.fit import fit_shot
from curlshot.physics.local_fit.glides import WORST, Glides, free, measure_glides
from curlshot.physics.local_fit.hit_detection import HitCandidate, cut_all
from curlshot.physics.local_fit.hits import measure_hits, pooled
from curlshot.physics.local_fit.off_centre import centred
from curlshot.physics.local_fit.segments import Piece
from curlshot.physics.local_fit.solution import ContactState, Deceleration, LocalFit, Meeting
from curlshot.physics.local_fit.traces import Trace, traces
from curlshot.physics.local_fit.untold import untold_hits
from curlshot.physics.statistics.residuals import huber_weights

Floats = NDArray[np.float64]

UNEVEN = 0.025
"""Difference of decelerations from glide to glide that is worth a word, m/s²: a quarter of them."""

VAGUE = 0.3
"""Share of a friction that its error may be, where it is larger than that of any ice."""


@dataclass(frozen=True)
class Local:
    """What the paths beside the hits say.

    Attributes
    ----------
    restitution : Estimate
        Pooled over all hits that tell it.
    friction : Friction
        Pooled over all glides.
    collisions : tuple of Hit
        In order of time.
    glides : tuple of Glide
        In order of stone and time.
    friction_doubt : str or None
        Why the friction could not be told, or what is odd about it.
    warnings : tuple of str
        What else could not be told and why; what does not agree.
    fit : LocalFit or None
        Of the paths; None where no stone moves.
    known : mapping
        Stone to its detections.
    """

    restitution: Estimate = field(default_factory=Estimate)
    friction: Friction = field(default_factory=Friction)
    collisions: tuple[Hit, ...] = ()
    glides: tuple[Glide, ...] = ()
    friction_doubt: str | None = None
    warnings: tuple[str, ...] = ()
    fit: LocalFit | None = None
    known: Mapping[str, Trace] = field(default_factory=dict)


def estimate_locally(
    detections: pd.DataFrame,
    contacts: Sequence[HitCandidate],
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
) -> Local:
    """Estimate restitution and friction from the paths beside the hits.

    Parameters are those of `curlshot.physics.estimate.estimate`.
    """
    known = centred(traces(detections), contacts, radius)
    return estimate_from_traces(known, contacts, radius=radius, masses=masses)


def estimate_from_traces(
    known: Mapping[str, Trace],
    contacts: Sequence[HitCandidate],
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
) -> Local:
    """As `estimate_locally`, of the detections by stone, which are taken to be over the centres."""
    meetings = [
        Meeting(c.t, c.stones, max(known[stone].gap(c.t) for stone in c.stones)) for c in contacts
    ]
    pieces, _ = cut_all(known, meetings, radius)
    idle = [piece for piece in pieces if piece.rest and _alone(piece)]
    still = [_scatter(known[piece.stone], piece) for piece in idle]
    pieces = [piece for piece in pieces if not (piece.rest and _alone(piece))]
    untold = untold_hits(known, meetings, radius)
    if not pieces:
        return Local(
            warnings=("no stone moves: restitution and friction are not identifiable", *untold.said)
        )

    def fit(pieces: list[Piece], slowing: Deceleration, momentum: bool = True) -> LocalFit:
        return fit_shot(
            known, pieces, meetings, radius,
            masses=masses, still=still, deceleration=slowing, momentum=momentum,
        )  # fmt: skip

    told = measure_glides(fit(pieces, free(radius)), known, radius, untold.changes)
    friction, doubt = _checked(told)
    glides, prior = told.free, told.prior
    if not meetings:
        unseen = ("restitution: no hit detected", *untold.said, *_pushes(told))
        return Local(Estimate(), friction, (), glides, doubt, unseen, fit(pieces, prior), known)
    joint = fit(pieces, prior)
    apart = fit(pieces, prior, momentum=False)
    collisions, restitution = measure_hits(joint, apart, known, radius, masses or {})
    warnings = [text for hit in collisions for text in _doubts(hit)]
    warnings += [*untold.said, *_pushes(told), *_distances(joint, radius)]
    return Local(restitution, friction, collisions, glides, doubt, tuple(warnings), joint, known)


def _checked(told: Glides) -> tuple[Friction, str | None]:
    """Return the friction of the glides if it can be one, and what is odd about it."""
    friction, prior = told.friction, told.prior
    value, stderr = friction.value, friction.stderr
    if value is None or stderr is None:
        return friction, "friction: not identifiable, no stone glides freely for long enough"
    if value + 2 * stderr < 0:
        return Friction(), (
            f"friction: the stones gain speed (μ = {value:.3f} ± {stderr:.3f}), so they do not"
            " glide freely on level ice; not reported"
        )
    each = [glide.friction for glide in told.free if glide.friction is not None]
    if stderr > max(WORST, VAGUE * value):
        of = f" (of glides from {min(each):.3f} to {max(each):.3f})" if len(each) > 1 else ""
        return (
            Friction(),
            f"friction: {value:.3f} ± {stderr:.3f}{of} is too uncertain; not reported",
        )
    if value < 0:
        return friction, (f"friction: {value:.4f} ± {stderr:.4f}: not distinguishable from zero")
    uneven = max(UNEVEN, 0.3 * prior.mean)
    if prior.along > uneven and GRAVITY * (max(each) - min(each)) > uneven:
        return friction, (
            f"friction differs from glide to glide ({min(each):.4f} to {max(each):.4f}): it"
            " depends on speed or place; the value is a mean"
        )
    return friction, None


def _pushes(told: Glides) -> Iterator[str]:
    """Say which stones are pushed, and when."""
    for stone in dict.fromkeys(glide.stone for glide in told.pushed):
        own = [glide for glide in told.pushed if glide.stone == stone]
        yield (
            f"{stone} is apparently pushed or carried between {own[0].t0:.2f} and"
            f" {own[-1].t1:.2f} s; this interval is not used for friction"
        )


def _doubts(hit: Hit) -> list[str]:
    """Say what is missing or odd about a hit."""
    name = f"hit of {hit.stones[0]} and {hit.stones[1]} at {hit.t:.2f} s"
    out = [f"{name}: {hit.note}"] if hit.note else []
    residual, stderr = hit.momentum_residual, hit.stderr_momentum
    if hit.note is None and residual and stderr and residual > max(0.05, 3 * stderr):
        out.append(
            f"{name}: momentum changes by {100 * residual:.0f} % ± {100 * stderr:.0f} %: scale,"
            " masses or tracks are wrong"
        )
    return out


def _alone(piece: Piece) -> bool:
    return piece.opens is None and piece.closes is None


def _scatter(trace: Trace, piece: Piece) -> Floats:
    """Normalised residuals of a stone at rest."""
    xy = trace.xy[piece.samples]
    out: Floats = (xy - np.median(xy, axis=0)) / trace.sd[piece.samples]
    return out * huber_weights(out)


def _distances(fit: LocalFit, radius: float) -> list[str]:
    """Say so where hits happen at another distance than two radii."""

    def ratios(states: Sequence[ContactState]) -> Floats:
        return np.array([np.hypot(*(s.places[1] - s.places[0])) / (2 * radius) for s in states])

    values, cov = fit.propagate(range(len(fit.meetings)), ratios)
    mean = pooled(values, cov)
    if mean.value is None or mean.stderr is None:
        return []
    if abs(mean.value - 1) < max(0.02, 2 * mean.stderr):
        return []
    return [
        f"discs touch at a distance of {mean.value * 2 * radius:.4g} m, but two radii are"
        f" {2 * radius:.4g} m: the scale or the radius is wrong"
    ]
