"""The outcome of a run: tables, estimates, figures and files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from curlshot.config import CONFIG_FILE, Config
from curlshot.data.arguments import checked_path
from curlshot.data.coach_units import UNITS, Unit
from curlshot.data.errors import InputError
from curlshot.data.estimates import Estimate, Friction, NotedEstimate
from curlshot.data.files import check_folder, staged
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import HOUSE, House, curling_size

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from curlshot.data.measurement import Measurement
    from curlshot.data.results import Results
    from curlshot.physics.prediction.ensemble import Ensemble
    from curlshot.report.figures.parts import OnAxes


@dataclass(frozen=True, repr=False, eq=False)
class Run:
    """The outcome of a run; it prints the answer in ten lines.

    Attributes
    ----------
    tracks : DataFrame
        As ``tracks.csv``, what was measured in the columns ``meas_…``; units in
        ``attrs["units"]``.
    cameras : DataFrame or None
        As ``camera.csv``; None for imported tracks.
    results : curlshot.data.results.Results
        Estimates with errors, as ``results.json``.
    simulations : DataFrame
        As ``simulation.csv``: one column ``model``, else as the tracks.
    out : Path or None
        Where the files are.
    house : House or None
        The rings; None where the scene has no house.
    posterior : DataFrame or None
        As ``posterior.csv``: draws of restitution and frictions, where they were asked for.
    ensemble : Ensemble or None
        As ``ensemble.json``: shots that may have been this one; None where nothing moves.
    measurement : Measurement or None
        What was measured before any physics; None for a run that was loaded.
    config : Config
        The settings of the run; of a loaded one from its ``config.toml``.

    Examples
    --------
    >>> import curlshot
    >>> stones = (curlshot.StoneStart("A", 0.5, 1.0), curlshot.StoneStart("B", 0.0, 0.0))
    >>> table = curlshot.simulate(curlshot.Shot(stones)).sample([0.0, 0.1, 0.2, 0.3])
    >>> table.to_csv("still.csv")
    >>> run = curlshot.run("still.csv")
    >>> run
    input       still.csv: 4 frames, 0.30 s
    stones      2 (A, B); moved: none
    restitution e = —
    friction    μ = —
    warnings    3
    >>> run.tracks.attrs["units"]["vx"]
    'm/s'
    >>> run.stones[["stone", "to_tee"]].round(3)
      stone  to_tee
    0     A   1.118
    1     B   0.000
    >>> run.plot().get_xlabel()
    '$x$ (m)'
    """

    tracks: pd.DataFrame
    cameras: pd.DataFrame | None
    results: Results
    simulations: pd.DataFrame
    out: Path | None = None
    house: House | None = None
    posterior: pd.DataFrame | None = None
    ensemble: Ensemble | None = None
    measurement: Measurement | None = None
    config: Config = field(default_factory=Config)

    # ------------------------------------------------------------------------ the answer

    @property
    def restitution(self) -> Estimate:
        """The coefficient of restitution e of the shot, or why it is unknown."""
        return self._or_why(self.results.restitution, "restitution")

    @property
    def e(self) -> Estimate:
        """The same as `restitution`."""
        return self.restitution

    @property
    def friction(self) -> Estimate | Friction:
        """The coefficient of friction μ of the ice and its law, or why it is unknown."""
        return self._or_why(self.results.friction, "friction")

    def _or_why(self, estimate: Estimate, name: str) -> Estimate:
        from curlshot.physics.statistics.season import why_unknown

        if estimate.value is not None:
            return estimate
        return NotedEstimate(note=why_unknown(self.results, [name]) or None)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a person should know before they trust the numbers."""
        return self.results.warnings

    @property
    def hits(self) -> pd.DataFrame:
        """The hits, one row each.

        ``hit, t, stderr_t, first, second, nx, ny, restitution, stderr, closing_speed,
        momentum_residual, stderr_momentum, energy_lost, stone_friction, stderr_stone_friction,
        note, note_stone_friction``; units in ``attrs["units"]``.
        """
        from curlshot.report.tables.run import hits_of_run

        return hits_of_run(self.results)

    @property
    def glides(self) -> pd.DataFrame:
        """The free glides, one row each.

        ``stone, t0, t1, friction, stderr, turn_rate, stderr_turn_rate, speed``; units in
        ``attrs["units"]``.
        """
        from curlshot.report.tables.run import glides_of_run

        return glides_of_run(self.results)

    @property
    def stones(self) -> pd.DataFrame:
        """The stones, one row each.

        ``stone, team, t0, t1, frames, seen, path, top_speed``, how it turned and curled
        (``turns, curl``), where it rests (``x, y, to_tee, in_house, lies``), and what its glides
        show (``friction, turn_rate, mean_speed, spin``), each with its ``sd_``. ``beyond`` is how
        far from the tee a stone was that still moved away from it, m; ``note`` says why a number
        is unknown. Units in ``attrs["units"]``.
        """
        from curlshot.report.tables.run import stones_of_run

        return stones_of_run(self.results, self.tracks, self.house)

    @property
    def unit(self) -> Unit:
        """The unit of lengths that coaches read."""
        return UNITS[self.config.report.units]

    @property
    def simulated(self) -> dict[str, pd.DataFrame]:
        """The simulated motion by model of the hits."""
        return {str(model): table for model, table in self.simulations.groupby("model")}

    def summary(self) -> str:
        """Return what the command prints: the answer in a dozen lines."""
        from curlshot.report.summary import summary

        marked = self.cameras is None
        return summary(self.results, self.tracks, self.out, self.house, self.unit, marked=marked)

    def __repr__(self) -> str:
        from curlshot.report.summary import brief

        return brief(self.results, self.tracks, self.out, self.unit)

    def _repr_html_(self) -> str:
        from curlshot.report.notebook import run_html

        return run_html(self)

    # ----------------------------------------------------------------------- the figures
    # Each is drawn on the axes that are given, or else on new ones that a notebook shows.

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the sheet from above: house, paths measured and simulated, hits, last places."""
        from curlshot.report import figures

        def draw(on: OnAxes) -> Figure:
            return figures.plan_figure(
                self.tracks, self.simulated, self.results.collisions, house=self.house,
                radius=self.results.radius, on=on,
            )  # fmt: skip

        return self._one(draw, ax)

    def plot_speed(self, ax: Axes | None = None) -> Axes:
        """Draw the speed of every stone that moved against time."""
        from curlshot.report import figures

        results = self.results
        return self._one(
            lambda on: figures.speed_figure(self.tracks, results.collisions, results.radius, on), ax
        )

    def plot_friction(self, ax: Axes | None = None) -> Axes:
        """Draw the friction of each glide against speed, and that of the whole shot."""
        from curlshot.report import figures

        glides, friction = self.results.glides, self.results.friction
        curling = curling_size(self.results.radius)
        return self._one(
            lambda on: figures.friction_figure(
                glides, friction, self.tracks, curling=curling, on=on
            ),
            ax,
        )

    def plot_motion(self, stone: str | None = None, ax: OnAxes = None) -> NDArray[Any]:
        """Draw x, y and speed of a stone against time, on three axes; the first that moved."""
        from curlshot.report import figures

        name, results = self._stone(stone), self.results
        return self._several(
            lambda on: figures.motion_figure(
                self.tracks, name, results.collisions, results.glides, on
            ),
            ax,
        )

    def plot_spin(self, stone: str | None = None, ax: OnAxes = None) -> NDArray[Any]:
        """Draw angle and spin of a stone against time, on two axes; the first that moved."""
        from curlshot.report import figures

        name = self._stone(stone)
        return self._several(
            lambda on: figures.spin_figure(self.tracks, name, self.results.collisions, on), ax
        )

    def plot_comparison(
        self, stone: str | None = None, model: str | None = None, ax: OnAxes = None
    ) -> NDArray[Any]:
        """Draw simulated x and y of a stone, of one model or all, against the measured ones."""
        from curlshot.report import figures

        name, simulated = self._stone(stone), self.simulated
        if model is not None:
            _check_known("model", model, simulated)
            simulated = {model: simulated[model]}
        return self._several(
            lambda on: figures.comparison_figure(
                self.tracks, simulated, name, self.results.collisions, on
            ),
            ax,
        )

    def plot_hit(self, hit: int = 1, ax: OnAxes = None) -> NDArray[Any]:
        """Draw a hit, by its rank from 1, in its own axes; on two axes, one for the numbers."""
        from curlshot.report import figures

        collisions = self.results.collisions
        _check_known("hit", hit, range(1, len(collisions) + 1))
        return self._several(
            lambda on: figures.hit_figure(collisions[hit - 1], hit, self.results.radius, on),
            ax,
            of_tracks=False,
        )

    def plot_residuals(self, ax: OnAxes = None) -> NDArray[Any]:
        """Draw measured less smoothed places and their distribution, on two by two axes."""
        from curlshot.report import figures

        self._need_tracks()
        residuals, results = self.residuals, self.results
        return self._several(
            lambda on: figures.residuals_figure(
                residuals, results.collisions, results.residuals, on
            ),
            ax,
        )

    def plot_posterior(self, ax: OnAxes = None) -> NDArray[Any]:
        """Draw what is known of restitution and frictions together, on a square of axes."""
        from curlshot.report import figures

        if self.results.joint_estimate is None and self.posterior is None:
            raise InputError("the whole shot was not fitted: no posterior to draw")
        return self._several(
            lambda on: figures.posterior_figure(self.results.joint_estimate, self.posterior, on),
            ax,
            of_tracks=False,
        )

    @property
    def residuals(self) -> pd.DataFrame:
        """Measured less smoothed places: ``stone, frame, t, dx, dy, sd_x, sd_y``, m and s."""
        from curlshot.data.tracks import measured_rows
        from curlshot.report.tables import residual_table

        results, measured = self.results, self.measurement
        seen = measured_rows(self.tracks) if measured is None else measured.detections
        return residual_table(seen, self.tracks, results.collisions, results.radius)

    def _stone(self, stone: str | None) -> str:
        """Return the name of a stone of this run; by default the first that moved."""
        from curlshot.report.tables import moving_stones

        self._need_tracks()
        names = sorted(str(name) for name in self.tracks["stone"].unique())
        moved = moving_stones(self.tracks, self.results.collisions, self.results.radius)
        if stone is None:
            return (*moved, *names)[0]
        _check_known("stone", stone, names)
        return str(stone)

    def _one(self, draw: Callable[[OnAxes], Figure], ax: Axes | None) -> Axes:
        axes: Axes = self._several(draw, ax)[0]
        return axes

    def _several(
        self, draw: Callable[[OnAxes], Figure], ax: OnAxes, of_tracks: bool = True
    ) -> NDArray[Any]:
        from curlshot.report.notebook import drawn

        if of_tracks:
            self._need_tracks()
        return drawn(draw, ax)

    def _need_tracks(self) -> None:
        """Refuse a run without tracks."""
        if self.tracks.empty:
            raise InputError(f"{self.out}: no tracks.csv in it, so there is nothing to draw")

    # ------------------------------------------------------------------------- the files

    def to_xarray(self) -> xr.Dataset:
        """Return the tracks as movement has them, dimensions time, space and individuals.

        Raises
        ------
        curlshot.data.errors.CurlshotError
            Where xarray is not installed.
        """
        from curlshot.data.movement import movement_dataset

        return movement_dataset(self.tracks, self.results.input)

    def report(self, folder: str | Path, progress: Progress = no_progress) -> Run:
        """Write all files of the run into a folder, whole or not at all.

        Returns
        -------
        Run
            The same, with `out`.

        Raises
        ------
        curlshot.data.errors.InputError
            A folder that cannot be written, or one that holds an input that would be lost.
        """
        from curlshot.report.write import WRITTEN, write_run

        path = checked_path("folder", folder)
        if self.measurement is None:
            raise InputError(f"{folder}: a loaded run is not written again; copy its folder")
        check_target(path, self.measurement.files)
        with staged(path, replaces=WRITTEN) as stage:
            write_run(stage, self, progress)
        return replace(self, out=path)


def check_target(folder: str | Path, files: Sequence[Path]) -> Path:
    """Return the folder of a run; refuse one that cannot be written or that holds an input."""
    from curlshot.report.write import WRITTEN

    path = check_folder(checked_path("out", folder))
    own = {path.resolve() / name for name in WRITTEN}
    lost = [file for file in files if file.resolve() in own]
    if lost:
        raise InputError(f"{lost[0]}: would be overwritten; name another folder")
    return path


def _check_known(what: str, given: object, known: Any) -> None:
    """Refuse what is not among some."""
    if given not in known:
        there = ", ".join(map(str, known)) or "none"
        raise InputError(f"{what}: there is no {given!r}; there are: {there}")


def load(folder: str | Path) -> Run:
    """Read a run again from its folder, also one that version 0.1 wrote.

    Parameters
    ----------
    folder : str or Path
        The folder, or its results.json. All other files may be missing.

    Returns
    -------
    Run
        Without `measurement`.

    Raises
    ------
    curlshot.data.errors.InputError
        Where there is no run, or a file in it is no such thing.

    Examples
    --------
    >>> import curlshot
    >>> stones = (curlshot.StoneStart("A", 0.5, 1.0), curlshot.StoneStart("B", 0.0, 0.0))
    >>> table = curlshot.simulate(curlshot.Shot(stones)).sample([0.0, 0.1, 0.2, 0.3])
    >>> table.to_csv("still.csv")
    >>> run = curlshot.run("still.csv", out="still")
    >>> again = curlshot.load("still")
    >>> again.tracks.shape == run.tracks.shape
    True
    """
    from curlshot.data.column_units import with_units
    from curlshot.data.results_file import read_results
    from curlshot.data.tracks import empty_tracks, load_tracks, read_numbers, simulation_table
    from curlshot.physics.prediction.ensemble import read_ensemble

    path = checked_path("folder", folder)
    out = path.parent if path.name == "results.json" else path
    if not out.is_dir():
        raise InputError(f"{out}: no such folder; name the folder of a run")
    if not (out / "results.json").exists():
        found = ", ".join(name for name in ("tracks.csv", "camera.csv") if (out / name).exists())
        raise InputError(
            f"{out}: no results.json in it{f', only {found}' if found else ''}; `run` writes one"
        )
    results = read_results(out / "results.json")
    there = {name: out / name for name in _OPTIONAL if (out / name).exists()}
    at_tee = results.origin_at_tee and curling_size(results.radius)
    return Run(
        with_units(load_tracks(there["tracks.csv"]) if "tracks.csv" in there else empty_tracks()),
        read_numbers(there["camera.csv"], _CAMERA) if "camera.csv" in there else None,
        results,
        load_tracks(there["simulation.csv"], model=True)
        if "simulation.csv" in there
        else simulation_table(None, ""),
        out=out,
        house=HOUSE if at_tee else None,
        posterior=read_numbers(there["posterior.csv"], _POSTERIOR)
        if "posterior.csv" in there
        else None,
        ensemble=read_ensemble(there["ensemble.json"]) if "ensemble.json" in there else None,
        config=Config.from_file(there[CONFIG_FILE]) if CONFIG_FILE in there else Config(),
    )


_OPTIONAL = (
    "tracks.csv", "camera.csv", "simulation.csv", "posterior.csv", "ensemble.json", CONFIG_FILE,
)  # fmt: skip

_CAMERA = ("frame", "t", *(f"h{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3)))
_POSTERIOR = ("sample", "restitution", "friction", "stone_friction")
"""Columns that a ``camera.csv`` and a ``posterior.csv`` have in every version."""
