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


def inverse_of_blocks(normal: Floats, blocks: Sequence[NDArray[np.int64]]) -> Floats:
    """Inverse of a matrix made of blocks, block by block; each is given by its rows."""
    out = np.zeros_like(normal)
    for block in blocks:
        at = np.ix_(block, block)
        out[at] = inverse(normal[at])
    return out
