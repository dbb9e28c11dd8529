"""Tracks, estimates and simulations from sightings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from data.errors import InputError, SceneError
from data.progress import Progress, no_progress
from data.sheet import House
from work.measure import Measured
from work.settings import Settings

if TYPE_CHECKING:
    import pandas as pd

    from data.results import Collision, Estimate, Input, Results
    from physics.local_fit.contacts import Contact
    from physics.prediction.ensemble import Ensemble
    from physics.whole_shot.priors import Priors


FEWEST = 4
"""Frames in which stones must be seen to tell how they move: in three one that is hit looks like
an outlier."""

ICE = (0.004, 0.03)
"""Frictions that stones have on curling ice, from the keenest to wet or frosted one."""

SLIPPERIEST = 2e-4
"""Friction below that of anything that glides: a twentieth of that of the keenest ice."""


NO_SHEET = (
    "the shot does not come along y within the sides of a sheet whose tee is the origin: no house"
    " and no lines; put the origin on the tee and y along the sheet if there is one"
)

LISTED = 4
"""Marks left out that are named one by one, the worst."""


@dataclass(frozen=True)
class Run:
    """The outcome of a run.

    Attributes
    ----------
    tracks : DataFrame
        As ``tracks.csv``.
    cameras : DataFrame or None
        As ``camera.csv``; None for imported tracks.
    results : data.results.Results
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
    """

    tracks: pd.DataFrame
    cameras: pd.DataFrame | None
    results: Results
    simulations: pd.DataFrame
    out: Path | None = None
    house: House | None = None
    posterior: pd.DataFrame | None = None
    ensemble: Ensemble | None = None


def analyse(
    measured: Measured, settings: Settings = Settings(), progress: Progress = no_progress
) -> Run:
    """Tracks, estimates and simulations from sightings; writes nothing."""
    import numpy as np
    import pandas as pd

    from data.results import Results
    from data.tracks import teams
    from physics.estimate import estimate
    from physics.kalman import smooth
    from physics.local_fit.contacts import find_contacts
    from physics.posterior import sample_posterior, summarise
    from physics.prediction.forecast import predict
    from physics.prediction.hindcast import simulate_measured
    from physics.prediction.throws import along_sheet, first_hit, later_throws
    from vision.optics.camera import camera_table

    sightings, radius = measured.sightings, settings.radius
    if sightings.empty:
        raise SceneError(f"{measured.files[0]}: no stone was found; {_way_out(settings)}")
    progress("physics", 0, 1)
    masses = (
        _check_masses(settings.masses, list(sightings["stone"].unique())) or measured.masses or None
    )
    contacts = find_contacts(sightings, radius)
    estimates = estimate(sightings, contacts, radius=radius, masses=masses)
    timed = _timed(contacts, estimates.collisions)
    tracks = smooth(sightings, timed, radius=radius, masses=masses, unseen=measured.repeats)
    again = simulate_measured(tracks, estimates, radius=radius, masses=masses)
    notes = again.warnings
    laws = _assumed_laws(settings)
    predictions = predict(sightings, tracks, estimates, radius=radius, masses=masses, laws=laws)
    of_team = teams(tracks)
    drawn = sample_posterior(estimates, settings.samples, np.random.default_rng(0))
    if settings.samples and drawn is None:
        notes = (*notes, "no samples: the shot tells neither restitution nor friction")
    house = measured.house
    placed = measured.clip is None and house is not None  # by hand, wherever the origin was put
    if placed and not along_sheet(tracks, first_hit(estimates.collisions), radius):
        house, notes = None, (*notes, NO_SHEET)
    pace = _pace if measured.house is not None else _pace_anywhere
    notes = (*notes, *pace(estimates.friction))
    notes = (*notes, *_throws(later_throws(tracks)), *_few(sightings["frame"].nunique()))
    if measured.clip is None:  # in a clip people cover stones in passing
        notes = (*notes, *_left_out(sightings, tracks))
    results = Results(
        input=_input(measured),
        restitution=estimates.restitution,
        friction=estimates.friction,
        collisions=estimates.collisions,
        glides=estimates.glides,
        simulations=again.scores,
        warnings=tuple(dict.fromkeys((*measured.warnings, *estimates.warnings, *notes))),
        radius=radius,
        predictions=predictions,
        laws=estimates.laws,
        methods=estimates.methods,
        law_choice=() if estimates.whole is None else estimates.whole.laws,
        curl=estimates.curl,
        stones=estimates.by_stone,
        misfits=estimates.misfits,
        posterior=None if drawn is None else summarise(drawn),
        teams={stone: team for stone, team in of_team.items() if team},
        masses=masses or {},
        sheet=house is not None,
    )
    cameras = camera_table(measured.cameras) if measured.cameras else None
    simulations = [as_tracks(table, model, of_team) for model, table in again.samples.items()]
    progress("physics", 1, 1)
    return Run(
        tracks,
        cameras,
        results,
        pd.concat(simulations, ignore_index=True) if simulations else as_tracks(None, ""),
        house=house,
        posterior=drawn,
        ensemble=again.ensemble,
    )


def _input(measured: Measured) -> Input:
    """Say what was measured."""
    from data.results import Input

    times = measured.sightings["t"]
    return Input(
        files=tuple(path.name for path in measured.files),
        fps=measured.fps,
        frames=measured.frames,
        duration=float(times.max() - times.min()),
    )


def _few(frames: int) -> tuple[str, ...]:
    """Say so where too little is seen to tell a stone that moves from one that does not."""
    if not 1 < frames < FEWEST:
        return ()
    return (
        f"stones are seen in {frames} frames: too few to tell which of them move, what hits them"
        f" and where they stop; it takes {FEWEST}",
    )


def _pace(friction: Estimate) -> tuple[str, ...]:
    """Say so where stones slow as on no ice.

    A clip that runs k times too slowly shows μ / k², tracks k times too long k μ.
    """
    from physics.whole_shot.priors import FRICTION

    value, stderr = friction.value, friction.stderr
    if value is None or stderr is None or value <= 0:
        return ()
    if ICE[0] < value + 2 * stderr and value - 2 * stderr < ICE[1]:
        return ()
    times, pace = (FRICTION / value) ** 0.5, "slow"
    if times < 1:
        times, pace = 1 / times, "fast"
    return (
        f"friction: {value:.2g} is not that of curling ice; a clip in {pace} motion"
        f" (about {times:.2g} times) or tracks in another length unit would look so: then speeds"
        " are not real ones, e is",
    )


def _pace_anywhere(friction: Estimate) -> tuple[str, ...]:
    """Say so where discs slow as on no surface at all, of whatever they are made."""
    value, stderr = friction.value, friction.stderr
    if value is None or stderr is None or value <= 0 or value + 2 * stderr > SLIPPERIEST:
        return ()
    return (
        f"friction: {value:.2g} is below that of any surface; a wrong number of"
        " frames a second (--fps), slow motion or another length unit would look so: then speeds"
        " are not real ones, e is",
    )


def _throws(later: Mapping[str, float]) -> tuple[str, ...]:
    """Say so where more than one stone is thrown."""
    if not later:
        return ()
    each = ", ".join(f"{name} at {when:.2f} s" for name, when in later.items())
    return (
        f"more than one throw: {each}, when all others have stopped; e and μ are of all,"
        " predictions of the first hit; to measure one alone cut the table, or name its frames"
        " (--frames)",
    )


def _left_out(sightings: pd.DataFrame, tracks: pd.DataFrame) -> tuple[str, ...]:
    """Name the marks that are far off the ways of their stones, so that no track heeds them."""
    import numpy as np

    refused = tracks.loc[tracks["seen"] == 0, ["stone", "frame", "t", "x", "y"]]
    both = refused.merge(sightings, on=["stone", "frame"], suffixes=("", "_marked"))
    both["off"] = np.hypot(both["x"] - both["x_marked"], both["y"] - both["y_marked"])
    both = both.dropna(subset="off")
    if both.empty:
        return ()
    worst = both.nlargest(LISTED, "off").sort_values("t")
    columns = (worst[name].tolist() for name in ("stone", "t", "off"))
    each = ", ".join(
        f"{stone} at {t:.2f} s ({_little(off)} off)" for stone, t, off in zip(*columns, strict=True)
    )
    more = f" and {len(both) - len(worst)} more" if len(both) > len(worst) else ""
    return (f"marks that are off the ways of their stones are left out: {each}{more}",)


def _little(length: float) -> str:
    """Write a length of centimetres, m, or of less."""
    return f"{100 * length:.0f} cm" if length > 0.0095 else f"{1000 * length:.1f} mm"


def _way_out(settings: Settings) -> str:
    """Say what to do where no stone was found, by how the camera was known."""
    if settings.stick is not None or settings.camera is not None:
        given = "--camera" if settings.stick is None else "--stick"
        return f"curlshot check shows what was looked at; check --radius and {given}"
    return "curlshot check shows where the house was taken to be, and --house points at another"


def _timed(contacts: Sequence[Contact], hits: Sequence[Collision]) -> list[Contact]:
    """Contacts at the times that are reported of their hits: tracks are to break where they do."""
    out = []
    for contact in contacts:
        times = [hit.t for hit in hits if set(hit.stones) == set(contact.stones)]
        nearest = min(times, key=lambda t: abs(t - contact.t), default=contact.t)
        out.append(replace(contact, t=nearest))
    return out


def _assumed_laws(settings: Settings) -> Priors:
    """Laws that predictions assume: the literature's, or without doubt what is given."""
    from data.results import Estimate
    from physics.prediction.forecast import assumed

    said = {"restitution": settings.restitution, "friction": settings.friction}
    given = {name: Estimate(value, 0.0) for name, value in said.items() if value is not None}
    return replace(assumed(settings.radius), **given)


def _check_masses(masses: Mapping[str, float], stones: Sequence[str]) -> Mapping[str, float]:
    """Refuse masses of some stones only, for the unit of the others would be open."""
    names = ", ".join(sorted(stones))
    unknown = sorted(set(masses) - set(stones))
    if unknown:
        raise InputError(f"mass of {', '.join(unknown)}: no such stone; there are {names}")
    missing = sorted(set(stones) - set(masses)) if masses else []
    if missing:
        raise InputError(f"no mass of {', '.join(missing)}; give one for each of {names}, or none")
    return masses


def as_tracks(
    simulated: pd.DataFrame | None, model: str, of_team: Mapping[str, str] | None = None
) -> pd.DataFrame:
    """Table of ``simulation.csv`` from a sampled simulation: nothing of it was seen."""
    from data.tracks import TRACK_COLUMNS, empty_tracks

    table = empty_tracks() if simulated is None else simulated.reindex(columns=list(TRACK_COLUMNS))
    table["seen"] = 0
    table["team"] = [(of_team or {}).get(str(name), "") for name in table["stone"]]
    table.insert(0, "model", model)
    return table
