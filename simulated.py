"""A shot simulated: one of a person's own, or a measured one, with what is changed."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from curlshot.data.arguments import check_type
from curlshot.data.column_units import with_units
from curlshot.data.errors import InputError
from curlshot.data.limits import POSITIVE, SD_ANGLE, SD_SPEED, THROWS
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import HOUSE, House
from curlshot.outcome import Run
from curlshot.physics.prediction.restart import read_start, sampled, shot_file, throw_often
from curlshot.physics.prediction.start import Start, measured_start, written_start
from curlshot.physics.prediction.what_if import Amount, Changes, changed
from curlshot.physics.simulator import simulate as simulator
from curlshot.physics.simulator.given import check_given
from curlshot.physics.simulator.simulation import HitEvent, Rest, Shot, Simulation

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

FPS = 60.0
"""Rate at which a path is drawn, 1/s."""


@dataclass(frozen=True, repr=False)
class SimulatedShot:
    """A simulated shot: where its stones went, hit and came to rest.

    Attributes
    ----------
    start : Start
        The shot as it was thrown, the changes in it, and what it may be as well.
    changes : Changes
        What was changed.
    simulation : curlshot.physics.simulator.simulation.Simulation
        The motion of every stone.
    source : str
        Name of the file that the shot is from; empty for a shot made in Python.

    Examples
    --------
    >>> import curlshot
    >>> stones = (curlshot.StoneStart("A", 0.0, 2.0, vy=-1.5), curlshot.StoneStart("B", 0.0, 0.0))
    >>> curlshot.simulate(curlshot.Shot(stones))
    at rest:
      A  x   +0.000 m   y   +0.291 m   after   1.17 s
      B  x   -0.000 m   y  -11.965 m   after  16.12 s
    hits:
       1.173 s  A on B
    """

    start: Start
    changes: Changes
    simulation: Simulation
    source: str = ""

    @property
    def shot(self) -> Shot:
        """The shot as it was thrown."""
        return self.start.shot

    @property
    def hits(self) -> tuple[HitEvent, ...]:
        """The hits in their order."""
        return self.simulation.hits

    @property
    def rest(self) -> Mapping[str, Rest]:
        """By stone where and when it came to rest, or left the sheet."""
        return self.simulation.rest

    @property
    def warnings(self) -> tuple[str, ...]:
        """What had to be assumed of a measured shot."""
        return tuple(self.start.assumed.values())

    def sample(self, times: ArrayLike) -> pd.DataFrame:
        """Return the states of all stones at given times >= 0, s.

        Returns
        -------
        DataFrame
            ``stone, frame, t, x, y, theta, vx, vy, omega``, units in ``attrs["units"]``. A stone
            that has left the sheet has no more rows.

        Raises
        ------
        curlshot.data.errors.InputError
            Times that are not numbers, or lie before 0.
        """
        try:
            return with_units(self.simulation.sample(times))
        except (TypeError, ValueError):
            raise InputError("`times`: not all of them are numbers of seconds, 0 or more") from None

    def table(self, fps: float = FPS) -> pd.DataFrame:
        """Return all states until everything is at rest, as ``simulation.csv``.

        Raises
        ------
        curlshot.data.errors.InputError
            A rate that is not positive, or too high.
        """
        POSITIVE.check("`fps`", fps)
        return with_units(sampled(self.simulation, fps, self.shot.impact.name))

    def throw(
        self,
        samples: int = 1000,
        throw_sd: tuple[float, float] | None = None,
        progress: Progress = no_progress,
    ) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Throw the shot many times, each a little off.

        Parameters
        ----------
        samples : int
            How often.
        throw_sd : (float, float), optional
            Standard deviations of speed, m/s, and direction, rad, of the stone as it is let go;
            those of good players by default.
        progress : callable
            Called as the work goes on.

        Returns
        -------
        outcomes : DataFrame
            As ``outcomes.csv``: where each stone ends in each throw.
        odds : dict
            As ``whatif.json``: the same in sum, by stone in ``odds["stones"]``.

        Raises
        ------
        curlshot.data.errors.InputError
            Numbers that make no sense.
        """
        THROWS.check("`samples`", samples)
        if throw_sd is not None:
            pair = throw_sd if isinstance(throw_sd, Sequence | np.ndarray) else ()
            if len(pair) != 2:
                raise InputError(f"`throw_sd`: {throw_sd!r} is not a pair of speed and direction")
            for limits, value in zip((SD_SPEED, SD_ANGLE), pair, strict=True):
                limits.check("`throw_sd`", value)
        outcomes, odds = throw_often(
            self.start, self.changes, samples, throw_sd, self.source, progress
        )
        return with_units(outcomes), odds

    @property
    def house(self) -> House | None:
        """The rings; None where places do not count from a tee."""
        return HOUSE if self.start.house else None

    @property
    def play(self) -> int:
        """1 where the stone is thrown up y, -1 where down."""
        return 1 if self.shot.stones[self.start.thrown].vy > 0 else -1

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the shot from above.

        Parameters
        ----------
        ax : Axes, optional
            Where to draw; a new figure without.

        Returns
        -------
        Axes
        """
        from curlshot.report.figures import simulated_figure
        from curlshot.report.notebook import drawn

        axes: NDArray[Any] = drawn(
            lambda on: simulated_figure(
                self.table(), self.hits, gone=self.simulation.gone, house=self.house,
                radius=self.shot.radius, play=self.play, on=on,
            ),
            ax,
        )  # fmt: skip
        panel: Axes = axes[0]
        return panel

    def summary(self, written: Sequence[Path] = ()) -> str:
        """Return rest places and hits in a few lines, and the files that have them."""
        from curlshot.report.summary import simulation_text

        return simulation_text(self.simulation, written)

    def __repr__(self) -> str:
        return self.summary()


def simulate(
    shot: Shot | Run | str | Path,
    *,
    speed: float | str | Amount | None = None,
    spin: float | str | Amount | None = None,
    aim_offset: float = 0.0,
    restitution: float | None = None,
    friction: float | None = None,
) -> SimulatedShot:
    """Simulate a shot, measured or made up, as it is or with something changed.

    Parameters
    ----------
    shot : Shot, Run, str or Path
        A shot, a run, the folder of a run or its results.json, or a SHOT.toml.
    speed, spin : float or str, optional
        Of the thrown stone, m/s and rad/s, or a factor such as ``"1.1x"``.
    aim_offset : float
        Distance by which the path of the thrown stone is moved to its left, m.
    restitution, friction : float, optional
        e of the hits, and μ of the ice at 1 m/s.

    Returns
    -------
    SimulatedShot

    Raises
    ------
    curlshot.data.errors.InputError
        A shot or a change that makes no sense.

    Examples
    --------
    >>> import curlshot
    >>> stones = (curlshot.StoneStart("A", 0.0, 2.0, vy=-1.5), curlshot.StoneStart("B", 0.0, 0.0))
    >>> shot = curlshot.Shot(stones, impact=curlshot.Frictional(restitution=0.83))
    >>> for speed in (None, "0.9x", 2.0):
    ...     outcome = curlshot.simulate(shot, speed=speed)
    ...     print(f"{outcome.rest['B'].y:.2f} m, {len(outcome.hits)} hit")
    -9.81 m, 1 hit
    -7.45 m, 1 hit
    -19.81 m, 1 hit
    >>> curlshot.simulate(shot, speed="fast")
    Traceback (most recent call last):
        ...
    curlshot.data.errors.InputError: `speed`: 'fast' is not a speed above 0, at most 10 m/s, nor \
a factor such as 1.1x, at most 10x
    """
    kinds = (Shot, Run, str, os.PathLike)
    check_type("`shot`", shot, kinds, "a Shot, a Run, or the path of one")
    changes = Changes.of(
        restitution=restitution, friction=friction, speed=speed, spin=spin, aim_offset=aim_offset
    )
    start = changed(_start(shot), changes)
    source = "" if isinstance(shot, Shot | Run) else shot_file(Path(shot)).name
    return SimulatedShot(start, changes, simulator.simulate(start.shot), source)


def _start(shot: Shot | Run | str | Path) -> Start:
    """Return the shot as it begins."""
    if isinstance(shot, Shot):
        check_given(shot)
        return written_start(shot)
    if isinstance(shot, Run):
        if shot.tracks.empty:
            raise InputError(f"{shot.out}: no tracks.csv in it, so there is no shot to throw again")
        if shot.ensemble is None:
            raise InputError("this run has no shot to throw again: no stone moves in it")
        return measured_start(shot.tracks, shot.results, shot.ensemble)
    return read_start(shot_file(Path(shot)))
