"""Ambiguity by half a turn: a handle looks nearly the same half a turn on.

Lit from one side it does so more than as it was turned before; so where it was hidden, or hardly
seen, it may be found again the wrong way round. Of all ways to turn that is taken which explains
most of a stone's pictures for how little its spin changes, by harmonics that are the same half a
turn on: which end is which is told by how stones turn (the algorithm of Viterbi, 1967, IEEE Trans.
Inf. Theory 13, 260, over angles and spins).
"""

from __future__ import annotations

from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.spin.align import HARMONICS, Array, Complex, rings_seen
from curlshot.vision.spin.facing import crossed
from curlshot.vision.spin.shade import parts, upright_mean

SPAN = 0.2
"""Time over which a spin is taken to be constant, s."""

TURNS, FASTEST = 40, 6.0
"""Angles of half a turn that are tried, and the fastest spin, rad/s: stones turn at 1 to 3, and
hits change that by 3 or so."""

CHANGE = 0.25
"""What a change of the spin costs per rad/s in what a stretch explains of its pictures (0 to 1): at
twice as much a stone at rest is taken to turn all the time, at half as much no other of 165 clips
of seven renderers and of cut-out stones is."""

AS_MUCH = 0.8
"""Share of what angles explain below which another way to turn is none: a disc spins faster."""

_STEP = np.pi / TURNS
_EVEN = HARMONICS[HARMONICS % 2 == 0]
_PHASES = np.exp(1j * _EVEN[:, None] * _STEP * np.arange(TURNS)).astype(np.complex64)


def unfolded(times: Array, pictures: Complex, angles: Array) -> Array:
    """Take out half turns that no stone makes.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    pictures : ndarray, shape (n, orders, rings, channels)
        From `curlshot.vision.spin.handle.cap_spectrum`; a ring that is not seen is 0.
    angles : ndarray, shape (n,)
        rad, most of them right but for half turns; NaN where they are not told.

    Returns
    -------
    ndarray, shape (n,)
        rad; the first that is told stays.
    """
    known = np.flatnonzero(np.isfinite(angles))
    t, told = times[known], angles[known]
    step, out = np.diff(told), angles.copy()
    if not (np.abs(step) + FASTEST * np.diff(t) > np.pi / 2).any():
        return out  # no spin that is tried makes any of them another half turn
    cross = _crossed_with_mean(pictures, angles)[:, HARMONICS % 2 == 0]
    count = max(round(float(t[-1] - t[0]) / SPAN), 1) + 1
    wait = (t[-1] - t[0]) / (count - 1)
    at = np.rint((t - t[0]) / wait).astype(np.intp)
    tau = t - t[0] - wait * at
    most = round(FASTEST * wait / _STEP)
    spins = np.arange(-most, most + 1) * (_STEP / wait)
    spin, turn = _path(_explained(cross, at, tau, spins), CHANGE * spins)
    way = _STEP * turn[at] + spins[spin[at]] * tau
    phases = [np.exp(1j * _EVEN * by[:, None]) for by in (told, way)]
    before, after = (float(np.sum(cross * phase).real) for phase in phases)
    if after > AS_MUCH * before:
        out[known[1:]] += np.pi * np.cumsum(np.rint((np.diff(way) - step) / np.pi))
    return out


def _crossed_with_mean(pictures: Complex, angles: Array) -> Complex:
    """Products of pictures whose angles are told, (told, harmonics), and their mean.

    Each in the share of its picture that the mean explains, and with as much weight.
    """
    known = np.flatnonzero(np.isfinite(angles))
    mean = upright_mean(pictures, angles, rings_seen(pictures)[:, None, :, None])
    each = [crossed(mean, pictures[part]) for part in parts(known)]
    cross, energy = (np.concatenate(column) for column in zip(*each, strict=True))
    cross = cross / np.where(energy > 0, energy, np.inf)[:, None]
    like = np.sum(cross * np.exp(1j * HARMONICS * angles[known, None]), axis=1).real
    return np.asarray(cross * np.maximum(like, 0.0)[:, None])


def _explained(cross: Complex, at: NDArray[np.intp], tau: Array, spins: Array) -> Array:
    """Tell what spins and angles explain of the pictures of stretches: (count, spins, turns)."""
    cross = cross / np.bincount(at)[at][:, None]
    begin = np.flatnonzero(np.diff(at, prepend=-1))
    by_two = np.exp(1j * _EVEN[0] * spins[:, None] * tau)
    phase = np.stack([*accumulate([by_two] * len(_EVEN), np.multiply)], axis=-1)
    sums = np.zeros((at[-1] + 1, len(spins), len(_EVEN)), np.complex64)
    sums[at[begin]] = np.add.reduceat(phase * cross, begin, axis=1).swapaxes(0, 1)
    return np.asarray((sums @ _PHASES).real)


def _path(gain: Array, cost: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Tell which spins and angles from stretch to stretch gain most, (count,) each."""
    rows = np.arange(len(cost))
    moves = rows - len(cost) // 2
    back = rows[:, None] * TURNS + (np.arange(TURNS) - moves[:, None]) % TURNS
    # To faster spins and, from the other end, to slower ones: side by side, for one pass.
    back = np.concatenate([back, back[::-1]], axis=1)
    high = np.repeat(np.stack([cost, -cost[::-1]], axis=1), TURNS, axis=1).astype(np.float32)
    best = [gain[0]]
    for more in gain[1:]:
        come = best[-1].take(back) + high
        come = np.maximum.accumulate(come, axis=0) - high
        best.append(more + np.maximum(come[:, :TURNS], come[::-1, TURNS:]))
    s, p = (int(i) for i in np.unravel_index(best[-1].argmax(), best[-1].shape))
    path = [(s, p)]
    for earlier in best[-2::-1]:
        whence = p - moves
        s = int(np.argmax(earlier[rows, whence % TURNS] - np.abs(cost - cost[s])))
        p = int(whence[s])
        path.append((s, p))
    which, where = np.array(path[::-1], np.intp).T
    return which, where
