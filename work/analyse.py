"""Tracks, estimates and simulations from sightings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.data.errors import InputError, SceneError
from curlshot.data.progress import Progress, no_progress
from curlshot.data.sheet import House
from curlshot.work.cautions import cautions
from curlshot.work.measure import Measured
from curlshot.work.settings import Settings

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.data.results import Collision, Input, Results
    from curlshot.physics.local_fit.contacts import Contact
    from curlshot.physics.prediction.ensemble import Ensemble
    from curlshot.physics.whole_shot.priors import Priors


NO_SAMPLES = "no samples: the shot tells neither restitution nor friction"


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

    from curlshot.data.results import Results
    from curlshot.data.tracks import teams
    from curlshot.physics.estimate import estimate
    from curlshot.physics.kalman import smooth
    from curlshot.physics.local_fit.contacts import find_contacts
    from curlshot.physics.posterior import sample_posterior, summarise
    from curlshot.physics.prediction.forecast import predict
    from curlshot.physics.prediction.hindcast import simulate_measured
    from curlshot.physics.prediction.throws import along_sheet, first_hit
    from curlshot.vision.optics.camera import camera_table

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
    laws = _assumed_laws(settings)
    predictions = predict(sightings, tracks, estimates, radius=radius, masses=masses, laws=laws)
    of_team = teams(tracks)
    drawn = sample_posterior(estimates, settings.samples, np.random.default_rng(0))
    # Of a clip the house is seen; marked by hand, stones lie wherever the origin was put.
    placed = measured.clip is None and measured.house is not None
    sheet = not placed or along_sheet(tracks, first_hit(estimates.collisions), radius)
    house = measured.house if sheet else None
    warnings = (
        *measured.warnings,
        *estimates.warnings,
        *again.warnings,
        *((NO_SAMPLES,) if settings.samples and drawn is None else ()),
        *cautions(measured, tracks, estimates.friction, sheet),
    )
    results = Results(
        input=_input(measured),
        restitution=estimates.restitution,
        friction=estimates.friction,
        collisions=estimates.collisions,
        glides=estimates.glides,
        simulations=again.scores,
        warnings=tuple(dict.fromkeys(warnings)),
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
    from curlshot.data.results import Input

    times = measured.sightings["t"]
    return Input(
        files=tuple(path.name for path in measured.files),
        fps=measured.fps,
        frames=measured.frames,
        duration=float(times.max() - times.min()),
    )


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
    from curlshot.data.results import Estimate
    from curlshot.physics.prediction.forecast import assumed

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
    from curlshot.data.tracks import TRACK_COLUMNS, empty_tracks

    table = empty_tracks() if simulated is None else simulated.reindex(columns=list(TRACK_COLUMNS))
    table["seen"] = 0
    table["team"] = [(of_team or {}).get(str(name), "") for name in table["stone"]]
    table.insert(0, "model", model)
    return table
