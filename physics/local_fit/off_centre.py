"""Caps that sit beside the centres of their stones: a way of places that turns with the stone.

What a stone is told by, its cap, is in the middle to a few millimetres. That it is not, is the same
in the stone's frame at all times, so that on the ice it goes round as the stone turns. Taken for
motion it makes one glide look like several, and wrong velocities.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from curlshot.physics.filter.stretch import PLACE_MEMORY
from curlshot.physics.local_fit.breaks import ALIKE
from curlshot.physics.local_fit.fit import fit_shot
from curlshot.physics.local_fit.glides import free
from curlshot.physics.local_fit.hit_detection import HitCandidate
from curlshot.physics.local_fit.segments import Piece, cut
from curlshot.physics.local_fit.solution import Meeting
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.statistics.residuals import huber_weights

if TYPE_CHECKING:
    from curlshot.data.results import Hit

Floats = NDArray[np.float64]

SHOWN = 9.0
"""Squared normalised distance of a cap from the middle, two axes, from which it is taken out."""

TURNED = 2.0
"""Least turn of a stone, rad: by less, its cap goes round too little to tell it from a motion, and
no path need be fitted."""

FEWEST = 12
"""Detections of a stretch from which it tells of its cap."""

OTHER_SLOWING = 0.01
"""Standard deviation of each of the first three Legendre terms by which the acceleration of a glide
changes along it, on either axis, m/s²: a tenth of what it is on ice, so that what speed, sweepers
and curl do to it is not taken for the cap."""

BENDS = np.array([60.0, 140.0, 252.0])
"""Such terms a1 P1, a2 P2, a3 P3 over a time T, integrated twice, bend a path by a1 T² P3 / 60,
a2 T² P4 / 140 and a3 T² P5 / 252, by what a parabola takes up, and by -a3 T² P3 / 90, which is less
than a1's and left out."""

MOST = 3.0
"""Farthest that a cap is beside its stone's centre, in `Trace.sd_off_centre`."""

ROUNDS = 2
"""How often a path is cut and its cap told anew: once it is over its stone, breaks that the cap
made are gone."""

REWEIGHTED = 3
"""Rounds of Huber's weights."""


def centred(
    known: Mapping[str, Trace], hits: Sequence[Meeting | HitCandidate | Hit], radius: float
) -> dict[str, Trace]:
    """Put the detections of each stone over its centre, where it shows that they are beside it.

    On each axis of every stretch of motion between hits a polynomial of the fifth degree, and a
    place in the stone's frame for all of them, are fitted to the detections (linear least squares;
    the place is known before to `Trace.sd_off_centre`, what is more than a parabola by
    `OTHER_SLOWING`). Other stones stay as they are: such without angles for a while, without a
    stated error that their places share, or hardly turning.

    Parameters
    ----------
    known : mapping
        Stone to its detections.
    hits : sequence of Meeting, HitCandidate or Hit
        The hits.
    radius : float
        Of the discs, m.
    """
    out = dict(known)
    for name, trace in known.items():
        theta = trace.theta[np.isfinite(trace.theta)]
        turned = theta.size and np.ptp(theta) > TURNED
        if turned and trace.usual_sd_place > 0 and trace.faced.all():
            own = [(k, hit.t) for k, hit in enumerate(hits) if name in hit.stones]
            out[name] = _centred(trace, sorted(own, key=lambda hit: hit[1]), radius)
    return out


def _centred(trace: Trace, hits: Sequence[tuple[int, float]], radius: float) -> Trace:
    pieces = _joined(cut(trace, hits, radius))
    over, sd = trace, trace.sd_off_centre(radius)
    for _ in range(1 + ROUNDS):
        beside, normal = _beside(trace, _stretches(over, pieces, radius), sd)
        size = float(np.hypot(*beside))
        if beside @ normal @ beside < SHOWN or size > MOST * sd:
            return trace
        over = moved(trace, beside)
        pieces = cut(over, hits, radius)
    return over


def moved(trace: Trace, beside: Floats) -> Trace:
    """Put detections over the centre of a stone whose cap is so far beside it, m, in its frame.

    Where it is not known how it is turned they stay, and err by that.
    """
    told, faced = np.isfinite(trace.theta), trace.faced[:, None]
    sd_theta = np.interp(trace.t, trace.t[told], trace.sd_theta[told])  # as `Trace.rotations`
    sd_turn = np.where(faced, sd_theta[:, None], 1.0)
    sd = np.hypot(trace.sd, sd_turn * np.hypot(*beside))
    return replace(trace, xy=trace.xy - faced * (trace.rotations @ beside), sd=sd)


def _joined(pieces: Sequence[Piece]) -> list[Piece]:
    """Join the pieces of a motion that goes on from one to the next: their breaks may be none."""
    out: list[Piece] = []
    for piece in pieces:
        if out and not out[-1].rest and not piece.rest and piece.opens is None:
            samples = np.concatenate([out[-1].samples, piece.samples])
            out[-1] = replace(
                out[-1], end=piece.end, samples=samples, stops=piece.stops, closes=piece.closes
            )
        else:
            out.append(piece)
    return out


def _stretches(trace: Trace, pieces: Sequence[Piece], radius: float) -> list[NDArray[np.int64]]:
    """Return detections of each stretch in which a stone moves."""
    alone = [replace(piece, opens=None, closes=None) for piece in pieces]
    fit = fit_shot({trace.stone: trace}, alone, (), radius, deceleration=free(radius))
    moving = (p.samples[trace.t[p.samples] < fit.stop(i)] for i, p in enumerate(fit.pieces))
    return [
        samples
        for samples, piece in zip(moving, fit.pieces, strict=True)
        if not piece.rest and len(samples) >= FEWEST
    ]


def _beside(
    trace: Trace, stretches: Sequence[NDArray[np.int64]], sd: float
) -> tuple[Floats, Floats]:
    """By how much the cap is beside the centre, in the stone's frame, m; its normal matrix."""
    normal = np.eye(2) / sd**2
    right = np.zeros(2)
    # As often as detections err alike they say the same once more.
    alike = max(ALIKE, trace.lasting * 2 * PLACE_MEMORY / trace.step)
    for samples in stretches:
        noise = np.sqrt(np.mean(trace.sd[samples] ** 2, axis=1))
        t = trace.t[samples]
        tau = (2 * t - t[0] - t[-1]) / (t[-1] - t[0])
        curve = legendre.legvander(tau, 5)
        bends = BENDS / ((t[-1] - t[0]) ** 2 * OTHER_SLOWING) * np.sqrt(1 + alike)
        held = np.concatenate([np.zeros((3, 3)), np.diag(bends)], axis=1)
        before = normal * (1 + alike), right * (1 + alike)
        weight = np.ones(len(tau))
        for _ in range(REWEIGHTED):
            size = (np.sqrt(weight) / noise)[:, None]
            basis = np.linalg.qr(np.concatenate([curve * size, held]))[0][: len(t)]
            cap = trace.rotations[samples] * size[:, :, None]
            own = _without(basis, trace.xy[samples] * size)
            rows = _without(basis, cap)
            here = np.einsum("nai,naj->ij", cap, rows)
            there = np.einsum("nai,na->i", cap, own)
            left = own - rows @ np.linalg.solve(before[0] + here, before[1] + there)
            weight = huber_weights(left / np.sqrt(weight)[:, None])[:, 0]
        normal, right = normal + here / (1 + alike), right + there / (1 + alike)
    return np.asarray(np.linalg.solve(normal, right)), normal


def _without(basis: Floats, rows: Floats) -> Floats:
    """Take out of columns of rows, (n, …), what a basis (n, k) of curves follows."""
    return np.asarray(rows - np.tensordot(basis, np.tensordot(basis.T, rows, 1), 1))
