"""Many variants of one shot at once: what `physics.simulator.simulate` does for one, on arrays.

All variants go forward together, each at its own pace: a step over which bounds on the paths
prove every pair of stones apart is taken whole and the next is longer; one that they do not
is shortened, until all that is left in it are contacts, whose times are then found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.errors import InputError
from curlshot.data.progress import Progress, no_progress
from curlshot.physics.curl import Curl
from curlshot.physics.ice import IceLaw
from curlshot.physics.simulator.batch import Batch
from curlshot.physics.simulator.simulation import Shot, States, check_shot

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BATCH = 4096
"""Variants that go forward together: enough to be fast, few enough for the cache."""


@dataclass(frozen=True)
class Outcomes:
    """Where the stones of each variant came to rest.

    Attributes
    ----------
    x, y : ndarray, shape (variants, stones)
        Places of rest, m, in the order of the shot's stones.
    hits : ndarray of int, shape (variants, stones)
        Hits that each stone took part in.
    in_play : ndarray of bool, shape (variants, stones)
        Where a stone has left the shot's bounds: False, and its place is where it left them.
    """

    x: Array
    y: Array
    hits: NDArray[np.int64]
    in_play: Mask


def simulate_many(
    shot: Shot,
    states: States,
    *,
    ice: Sequence[IceLaw] = (),
    curl: Sequence[Curl] = (),
    radius: ArrayLike | None = None,
    vary: Mapping[str, ArrayLike] | None = None,
    progress: Progress = no_progress,
) -> Outcomes:
    """Simulate many variants of a shot; each ends as `simulate` ends it, to 1e-6 m.

    Parameters
    ----------
    shot : Shot
        Names and masses of the stones, and the laws where they are not varied.
    states : States
        Where the stones begin in each variant.
    ice, curl : sequence of IceLaw and of Curl, optional
        One for each variant; equal pairs share their work.
    radius : array_like, shape (variants,), optional
        Half the distance of two stones' centres as they hit each other, m.
    vary : mapping, optional
        Parameter of the model of impact to its value in each variant.
    progress : callable
        Called how many are done.

    Returns
    -------
    Outcomes
        In the order of the variants.

    Raises
    ------
    InputError
        As `simulate`; and where a number of a variant makes no sense.
    ValueError
        Where shapes do not agree.
    """
    check_shot(shot)
    variants, stones = np.shape(states.x)
    columns = {key: np.asarray(value, float) for key, value in vars(states).items()}
    parameters = {key: np.asarray(value, float) for key, value in (vary or {}).items()}
    if any(value.shape != (variants, len(shot.stones)) for value in columns.values()):
        raise ValueError(f"states must have the shape (variants, {len(shot.stones)})")
    radii = np.full(variants, shot.radius) if radius is None else np.asarray(radius, float)
    if any(value.shape != (variants,) for value in (radii, *parameters.values())):
        raise ValueError(f"parameters must have the shape ({variants},)")
    for name, given in (("ice", ice), ("curl", curl)):
        if given and len(given) != variants:
            raise ValueError(f"{len(given)} laws of {name} for {variants} variants")
    if not all(np.isfinite(v).all() for v in (radii, *columns.values(), *parameters.values())):
        raise InputError("shot: a variant has a number that is not finite")
    pairs = list(zip(ice or [shot.ice] * variants, curl or [shot.curl] * variants, strict=True))
    laws = list(dict.fromkeys(pairs))
    rank = {law: k for k, law in enumerate(laws)}
    law = np.array([rank[pair] for pair in pairs], np.intp)
    size = variants, stones
    out = Outcomes(
        np.zeros(size), np.zeros(size), np.zeros(size, np.int64), np.zeros(size, np.bool_)
    )
    progress("throws", 0, variants)
    for first in range(0, variants, BATCH):
        part = slice(first, first + BATCH)
        batch = Batch(
            shot,
            States(**{key: value[part] for key, value in columns.items()}),
            laws,
            law[part],
            radii[part],
            {key: value[part] for key, value in parameters.items()},
        )
        batch.run()
        out.x[part], out.y[part] = batch.now[..., 0], batch.now[..., 1]
        out.hits[part], out.in_play[part] = batch.hits, batch.in_play
        progress("throws", min(part.stop, variants), variants)
    return out
