"""A shot again, as it was measured or as a person writes it, and with what is changed."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from curlshot.data.errors import InputError
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import curling_size
from curlshot.data.tracks import simulation_table

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.physics.prediction.start import Start
    from curlshot.physics.prediction.what_if import Changes
    from curlshot.physics.simulator.simulation import Simulation

MOST_SAMPLES = 1_000_000
"""Of one simulated stone; more is a mistake in the rate."""


def shot_file(path: Path) -> Path:
    """Return the file of a shot; of the folder of a run its results.

    Raises
    ------
    InputError
        Where there is none.
    """
    file = path / "results.json" if path.is_dir() else path
    if not file.exists():
        raise InputError(f"{file}: no such file; name a SHOT.toml or the folder of a run")
    return file


def measured_shot(path: Path) -> bool:
    """Tell whether a shot was measured, not written by a person."""
    return path.suffix.lower() == ".json"


def read_start(path: Path) -> Start:
    """Read the shot to simulate: written by hand, or measured.

    Parameters
    ----------
    path : Path
        SHOT.toml or results.json.

    Raises
    ------
    InputError
        Where there is no shot in the files.
    """
    from curlshot.data.results_file import read_results
    from curlshot.data.tracks import read_tracks
    from curlshot.physics.prediction.ensemble import read_ensemble
    from curlshot.physics.prediction.start import measured_start, written_start
    from curlshot.physics.simulator.shot import read_shot

    if not measured_shot(path):
        return written_start(read_shot(path))
    results = read_results(path)
    tracks = read_tracks(_beside(path, "tracks.csv"))
    return measured_start(tracks, results, read_ensemble(_beside(path, "ensemble.json")))


def _beside(path: Path, name: str) -> Path:
    file = path.with_name(name)
    if not file.exists():
        raise InputError(
            f"{file}: no such file; it belongs into the folder of {path.name}: run again"
        )
    return file


def sampled(simulation: Simulation, fps: float, model: str) -> pd.DataFrame:
    """Table as ``simulation.csv`` of a simulation until all is at rest, at `fps` and its end."""
    import numpy as np

    end = max((rest.t for rest in simulation.rest.values()), default=0.0)
    if end * fps > MOST_SAMPLES:
        raise InputError(
            f"`fps` {fps:g}: {end:.0f} s would need {end * fps:.1g} samples a stone; at most"
            f" {MOST_SAMPLES:g}"
        )
    times = np.append(np.arange(0.0, end, 1 / fps), end)
    return simulation_table(simulation.sample(times), model)


def throw_often(
    start: Start,
    changes: Changes,
    count: int,
    throw_sd: tuple[float, float] | None,
    source: str,
    progress: Progress = no_progress,
) -> tuple[pd.DataFrame, dict[str, Any]]:
    """Throw a shot many times.

    Parameters
    ----------
    start : Start
        The shot, with the changes in it.
    changes : Changes
        What was changed.
    count : int
        How often it is thrown.
    throw_sd : (float, float), optional
        Scatter of speed, m/s, and direction, rad; `curlshot.physics.prediction.what_if.THROW_SD` by
        default.
    source : str
        Name of the file that the shot is from.
    progress : callable
        Called as the work goes on.

    Returns
    -------
    outcomes : DataFrame
        See `curlshot.physics.prediction.what_if.sample`.
    content : dict
        Of ``whatif.json``.
    """
    from curlshot.physics.prediction.what_if import THROW_SD, Changes, odds, sample

    speed, direction = throw_sd or THROW_SD
    outcomes = sample(start, count, (speed, direction), progress)
    return outcomes, {
        "schema": 1,
        "input": source,
        "thrown": start.shot.stones[start.thrown].name,
        "changes": {
            key: value for key, value in asdict(changes).items() if value != getattr(Changes, key)
        },
        "samples": count,
        "throw_sd": {"speed": speed, "direction": direction},
        "stones": {name: asdict(item) for name, item in odds(outcomes, start).items()},
        "warnings": [*start.assumed.values(), *_not_told(start, count)],
    }


def _not_told(start: Start, count: int) -> list[str]:
    """Say why some of what samples tell is null."""
    notes = []
    radius = start.shot.radius
    if not curling_size(radius):
        notes.append(
            f"discs of radius {radius:g} m are not curling stones: no house and no shot stone"
        )
    elif not start.house:
        notes.append("the origin is not a tee: no house and no shot stone")
    if count == 1:
        notes.append("thrown once: no spread")
    return notes
