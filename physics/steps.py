"""The steps between the methods: masses, times of hits, assumed laws, and the results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from curlshot.data.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.data.measurement import Measurement
    from curlshot.data.results import Hit, Results
    from curlshot.physics.estimate import Estimates
    from curlshot.physics.local_fit.hit_detection import HitCandidate
    from curlshot.physics.shot_fit.priors import Priors


def times_of_hits(contacts: Sequence[HitCandidate], hits: Sequence[Hit]) -> list[HitCandidate]:
    """Return contacts at the times that are reported of their hits, so that tracks break there."""
    out = []
    for contact in contacts:
        times = [hit.t for hit in hits if set(hit.stones) == set(contact.stones)]
        nearest = min(times, key=lambda t: abs(t - contact.t), default=contact.t)
        out.append(replace(contact, t=nearest))
    return out


def laws_to_assume(radius: float, restitution: float | None, friction: float | None) -> Priors:
    """Return the laws that predictions assume: the literature's, or exactly what is given."""
    from curlshot.data.results import Estimate
    from curlshot.physics.prediction.forecast import assumed

    values = {"restitution": restitution, "friction": friction}
    given = {name: Estimate(value, 0.0) for name, value in values.items() if value is not None}
    return replace(assumed(radius), **given)


def check_masses(masses: Mapping[str, float], stones: Sequence[str]) -> Mapping[str, float]:
    """Refuse masses of some stones only: the unit of the others would be unknown."""
    names = ", ".join(sorted(stones))
    unknown = sorted(set(masses) - set(stones))
    if unknown:
        raise InputError(f"mass of {', '.join(unknown)}: no such stone; there are {names}")
    missing = sorted(set(stones) - set(masses)) if masses else []
    if missing:
        raise InputError(f"no mass of {', '.join(missing)}; give one for each of {names}, or none")
    return masses


def gather_results(
    measured: Measurement, fit: Estimates, *, posterior: pd.DataFrame | None, **more: Any
) -> Results:
    """Gather what ``results.json`` holds; `more` has the fields that no estimate gives."""
    from curlshot.data.results import Input, Results
    from curlshot.physics.posterior import summarise

    times = measured.detections["t"]
    return Results(
        input=Input(
            files=tuple(path.name for path in measured.files),
            fps=measured.fps,
            frames=measured.frames,
            duration=float(times.max() - times.min()),
        ),
        restitution=fit.restitution,
        friction=fit.friction,
        collisions=fit.collisions,
        glides=fit.glides,
        joint_estimate=fit.joint_estimate,
        methods=fit.methods,
        model_selection=() if fit.shot_fit is None else fit.shot_fit.laws,
        curl=fit.curl,
        stones=fit.by_stone,
        residuals=fit.residuals,
        posterior=None if posterior is None else summarise(posterior),
        **more,
    )
