"""Arrowhead matrices: normal equations whose last block is diagonal, by its Schur complement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Arrow:
    """Symmetric positive definite matrix whose last block is diagonal.

    What is asked of it is worked out by the Schur complement of that block, so that it costs
    little more than if there were the other unknowns alone.

    Attributes
    ----------
    dense : ndarray, shape (m, m)
        First block.
    border : ndarray, shape (m, n)
        What lies beside it, and transposed under it.
    diagonal : ndarray, shape (n,)
        Of the last block.
    """

    dense: Array
    border: Array
    diagonal: Array

    def solve(self, right: Array, damping: float = 0.0) -> Array:
        """Solve for a right-hand side, shape (m + n,), with the diagonal enlarged by a share."""
        count = len(self.dense)
        last = (1 + damping) * self.diagonal
        share = self.border / last
        schur = self.dense - share @ self.border.T
        schur.flat[:: count + 1] += damping * self.dense.diagonal()
        first = np.linalg.solve(schur, right[:count] - share @ right[count:])
        return np.concatenate([first, right[count:] / last - first @ share])

    def last_variances(self) -> Array:
        """Give what is on the diagonal of the last block of the inverse, shape (n,)."""
        share = self.border / self.diagonal
        dense = np.linalg.inv(self.dense - share @ self.border.T)
        return np.asarray(1 / self.diagonal + ((dense @ share) * share).sum(0))

    def inverse(self) -> Array:
        """Give the inverse, shape (m + n, m + n)."""
        share = self.border / self.diagonal
        dense = np.linalg.inv(self.dense - share @ self.border.T)
        beside = -dense @ share
        last = np.diag(1 / self.diagonal) - share.T @ beside
        return np.block([[dense, beside], [beside.T, last]])
