"""What least-squares fits share: the inverse of their normal equations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def inverse(normal: Floats) -> Floats:
    """Inverse of a matrix that is positive but for rounding, its rows of very different size."""
    size = 1.0 / np.sqrt(np.maximum(np.diag(normal), 1e-30))
    scaled = normal * size[:, None] * size[None, :]
    try:
        root = np.linalg.solve(np.linalg.cholesky(scaled), np.eye(len(scaled)))
        inner = root.T @ root
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(scaled)
        inner = (vectors / np.maximum(values, 1e-12)) @ vectors.T
    out: Floats = inner * size[:, None] * size[None, :]
    return out


def bounded(normal: Floats, right: Floats, low: Floats, high: Floats) -> Floats:
    """Step that solves normal equations between bounds: unknowns at one let the others follow.

    Where a step is merely cut off at a bound, the others go as if it had been taken in full, and a
    descent comes to rest where it need not.

    Parameters
    ----------
    normal, right : arrays, shapes (n, n) and (n,)
        The equations.
    low, high : (n,) arrays
        Least and most of each unknown of the step.
    """
    step, free = np.zeros(len(right)), np.ones(len(right), bool)
    while free.any():
        rest = right - normal[:, ~free] @ step[~free]
        step[free] = inverse(normal[np.ix_(free, free)]) @ rest[free]
        out = (step < low) | (step > high)
        if not out.any():
            break
        step = np.clip(step, low, high)
        free &= ~out
    return step


def inverse_of_blocks(normal: Floats, blocks: Sequence[NDArray[np.int64]]) -> Floats:
    """Inverse of a matrix made of blocks, block by block; each is given by its rows."""
    out = np.zeros_like(normal)
    for block in blocks:
        at = np.ix_(block, block)
        out[at] = inverse(normal[at])
    return out


def eliminated(normal: Floats, right: Floats, variance: Floats) -> tuple[Floats, Floats, Floats]:
    """Eliminate the last unknowns of normal equations, of which something is known beforehand.

    Parameters
    ----------
    normal, right : arrays, shapes (n + k, n + k) and (n + k,)
        Of all unknowns, without what is known of the last k.
    variance : (k,) array
        With which these are known to be 0; an unknown of variance 0 is none.

    Returns
    -------
    normal, right : arrays, shapes (n, n) and (n,)
        Of the others, by Schur's complement.
    further : (k, n + 1) array
        Gives the last unknowns as its product with the others', negative, and a 1.
    """
    count = len(normal) - len(variance)
    both = np.column_stack([normal[:, :count], right])
    inner = np.eye(len(variance)) + variance[:, None] * normal[count:, count:]
    further = np.asarray(np.linalg.solve(inner, variance[:, None] * both[count:]))
    left = both[:count] - normal[:count, count:] @ further
    return left[:, :-1], left[:, -1], further
