"""A fit of whole shots as a value: their unknowns, covariance, laws and residuals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.results import Estimate, JointEstimate, Law
from curlshot.physics.shot_fit.shot_model import ObservedShot
from curlshot.physics.simulator.simulation import Simulation

Floats = NDArray[np.float64]

ASTRAY = 10.0
"""Errors of its places by which a stone is off its simulated path, most of the time, if the fit has
come to rest in a wrong place: those of good fits are off by up to 4."""


@dataclass(frozen=True)
class ShotFit:
    """Outcome of `curlshot.physics.shot_fit.global_fit.fit_shots`.

    Attributes
    ----------
    names : tuple of str
        Of the unknowns that were fitted; with several shots those that are not shared begin
        with the rank of their shot, as in ``1:A.vx``.
    values : (n,) array
        Their values.
    cov : (n, n) array
        Their covariance, enlarged for residuals that are too big or alike from frame to frame
        and for what places share.
    prior_mean, prior_sd : (n,) array
        What was known of each beforehand; 0 and infinite where nothing.
    fixed : mapping
        Unknowns that were held, and at what.
    shots : tuple of ObservedShot
        As given.
    deviance : float
        Huber's sum of squared residuals of the detections.
    elsewhere : float
        The like of the spins and of what was known beforehand.
    detections : int
        Number of detections.
    inflation : float
        Factor that the variances of the detections were enlarged by.
    settled : bool
        Whether the fit came to its end.
    laws : tuple of Law
        Choices of laws that were compared, the best first, if any.
    choices : tuple of (float, ShotFit)
        The fits with these laws, each with its own covariance, and their probabilities.
    """

    names: tuple[str, ...]
    values: Floats
    cov: Floats
    prior_mean: Floats
    prior_sd: Floats
    fixed: Mapping[str, float]
    shots: tuple[ObservedShot, ...]
    deviance: float
    elsewhere: float
    detections: int
    inflation: float
    settled: bool
    laws: tuple[Law, ...] = ()
    choices: tuple[tuple[float, ShotFit], ...] = ()

    def __getitem__(self, name: str) -> Estimate:
        """Value and standard error of an unknown; 0 as error where it was held."""
        if name in self.names:
            k = self.names.index(name)
            return Estimate(float(self.values[k]), float(np.sqrt(self.cov[k, k])))
        return Estimate(self.fixed[name], 0.0)

    def identifies(self, name: str) -> bool:
        """Whether the detections tell more of an unknown than was known beforehand."""
        if name not in self.names:
            return False
        k = self.names.index(name)
        return bool(self.cov[k, k] < 0.5 * self.prior_sd[k] ** 2)

    def joint(self, names: Sequence[str]) -> JointEstimate | None:
        """Return those of some unknowns that the detections tell of, None where it is none."""
        told = [name for name in names if self.identifies(name)]
        at = [self.names.index(name) for name in told]
        cov = self.cov[np.ix_(at, at)].tolist()
        if not told:
            return None
        return JointEstimate(tuple(told), tuple(self.values[at].tolist()), tuple(map(tuple, cov)))

    def state(self, rank: int = 0, values: Floats | None = None) -> dict[str, float]:
        """Every unknown of shot `rank` by its own name, fitted or held."""
        numbers = self.values if values is None else values
        return own_values(rank, len(self.shots), self.names, numbers, self.fixed, self.shots[rank])

    def simulation(self, rank: int = 0) -> Simulation:
        """Return the fitted shot, up to its last detection."""
        return self.shots[rank].replay(self.state(rank))

    @property
    def hits_as_seen(self) -> bool:
        """Whether the stones hit each other in the fitted shots as they did."""
        return all(
            shot.first_other_hit(self.simulation(rank)) is None
            for rank, shot in enumerate(self.shots)
        )

    @property
    def misfit(self) -> float:
        """Mean square of the residuals in terms of all errors of the places, shared ones too.

        The inflation compares them with what is anew in each frame alone: on a good clip the
        map of the ice is off by several times that, alike for all detections near each other.
        """
        traces = [trace for shot in self.shots for trace in shot.traces.values()]
        shared = np.concatenate([(trace.sd_place / trace.sd) ** 2 for trace in traces])
        return self.inflation / (1 + float(shared.mean()))

    @property
    def diverged(self) -> bool:
        """Whether a stone is far from its simulated path for at least half of its detections.

        `misfit` does not tell: there, all that is far off counts as little as an outlier does.
        """
        shots = ((shot, self.simulation(rank)) for rank, shot in enumerate(self.shots))
        return any(
            float(np.median(np.sum((run / np.hypot(1, trace.sd_place / trace.sd)) ** 2, axis=1)))
            > 2 * ASTRAY**2
            for shot, simulation in shots
            for trace, run in zip(shot.traces.values(), shot.residuals(simulation), strict=True)
        )

    def residuals(self) -> pd.DataFrame:
        """Sighted less fitted places: ``shot, stone, t, dx, dy`` (m) ``sd_x, sd_y`` (m)."""
        tables = []
        for rank, shot in enumerate(self.shots):
            runs = shot.residuals(self.simulation(rank))
            for (stone, trace), run in zip(shot.traces.items(), runs, strict=True):
                off = run * trace.sd
                table = {"shot": rank, "stone": stone, "t": trace.t, "dx": off[:, 0]}
                table |= {"dy": off[:, 1], "sd_x": trace.sd[:, 0], "sd_y": trace.sd[:, 1]}
                tables.append(pd.DataFrame(table))
        return pd.concat(tables, ignore_index=True)


def draw_values(fit: ShotFit, count: int, rng: np.random.Generator) -> Floats:
    """Draw values of a fit's unknowns, shape (count, n), held within their bounds."""
    bounds = {unknown.name: (unknown.low, unknown.high) for unknown in fit.shots[0].unknowns}
    low, high = np.array([bounds[name] for name in fit.names]).T
    rows = rng.multivariate_normal(fit.values, fit.cov, count, method="eigh")
    return np.asarray(np.clip(rows, low, high))


def draw_choices(
    fit: ShotFit, count: int, rng: np.random.Generator
) -> Iterator[tuple[ShotFit, Floats]]:
    """Draw choices of laws by their probabilities, each with values of its own unknowns."""
    weights, fits = zip(*(fit.choices or ((1.0, fit),)), strict=True)
    picked = rng.choice(len(fits), count, p=weights)
    rows = [iter(draw_values(own, int(np.sum(picked == k)), rng)) for k, own in enumerate(fits)]
    for k in picked.tolist():
        yield fits[k], next(rows[k])


def own_values(
    rank: int,
    count: int,
    names: Sequence[str],
    values: Floats,
    fixed: Mapping[str, float],
    shot: ObservedShot,
) -> dict[str, float]:
    """Every unknown of the shot of that rank, of so many, by its own name, fitted or held."""
    own = {unknown.name for unknown in shot.unknowns}
    prefix = f"{rank}:"
    out = {name: value for name, value in fixed.items() if ":" not in name}
    out |= {n.removeprefix(prefix): v for n, v in fixed.items() if n.startswith(prefix)}
    for name, value in zip(names, values.tolist(), strict=True):
        plain = name.removeprefix(prefix) if count > 1 else name
        if plain in own:
            out[plain] = value
    return out
