"""How many threads the libraries may use that this program stands on."""

from __future__ import annotations

import os

LIMITS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")
"""Names in the environment that libraries of arrays and pictures read when they are loaded."""


def use_one_thread() -> None:
    """Keep libraries that are not loaded yet to one thread each.

    The work here is many small products: shared among threads it is done no sooner and costs a
    quarter more. What a person has set stands.
    """
    for name in LIMITS:
        os.environ.setdefault(name, "1")
