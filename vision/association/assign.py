"""Global assignment: pairs of rows and columns that together cost least."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def assign(cost: Array) -> list[tuple[int, int]]:
    """Pair each row with a column of its own, or each column with a row, for the least sum.

    By shortest augmenting paths (Jonker and Volgenant, 1987, Computing 38, 325). As
    `scipy.optimize.linear_sum_assignment`, whose import takes longer than all of a clip's
    assignments.

    Parameters
    ----------
    cost : ndarray, shape (rows, columns)
        Finite.

    Returns
    -------
    list of (row, column)
    """
    rows, columns = cost.shape
    if rows > columns:
        return [(row, column) for column, row in assign(cost.T)]
    price = np.zeros(columns)
    owner = np.full(columns, -1)
    for row in range(rows):
        length, before = np.full(columns, np.inf), np.full(columns, -1)
        done = np.zeros(columns, bool)
        # The shortest way from this row to a free column, on which each owner but this one
        # gives up a column for another.
        here, column, reached = row, -1, 0.0
        while True:
            through = cost[here] - price + reached
            if column >= 0:
                through -= cost[here, column] - price[column]
            shorter = ~done & (through < length)
            length[shorter], before[shorter] = through[shorter], column
            column = int(np.where(done, np.inf, length).argmin())
            reached, here, done[column] = float(length[column]), int(owner[column]), True
            if here < 0:
                break
        price[done] += length[done] - reached
        while column >= 0:
            previous = int(before[column])
            owner[column] = owner[previous] if previous >= 0 else row
            column = previous
    return [(int(row), column) for column, row in enumerate(owner) if row >= 0]
