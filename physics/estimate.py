"""Restitution and friction from tracks, each with a standard error.

Twice: from the paths beside the hits (`curlshot.physics.local_fit.local`), and from one fit of the
whole shot through the simulator (`curlshot.physics.shot_fit.global_fit`), which is the sharper
where the simulator can follow the shot. The first is what the second is checked against.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
import pandas as pd

from curlshot.data.errors import InputError
from curlshot.data.results import (
    Estimate,
    Friction,
    Glide,
    Hit,
    JointEstimate,
    Method,
    NotedEstimate,
    StoneResult,
    TrackResidual,
)
from curlshot.physics.local_fit.finite_differences import by_finite_differences
from curlshot.physics.local_fit.hit_detection import HitCandidate
from curlshot.physics.local_fit.local import Local, estimate_from_traces, estimate_locally
from curlshot.physics.shot_fit.observed import observe
from curlshot.physics.shot_fit.off_centre import centred_traces
from curlshot.physics.shot_fit.priors import loose_priors
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.physics.shot_fit.shot_model import ice
from curlshot.physics.shot_fit.track_residuals import track_residuals
from curlshot.physics.shot_fit.valid_interval import fit_valid_interval, followed
from curlshot.physics.statistics.by_stone import results_by_stone
from curlshot.physics.statistics.random_effects import random_effects

POOR_FIT = 30.0
"""Mean square of residuals against errors from which a simulated shot is not the one seen."""

BLUNT = 3.0
"""Times the error beside the hits from which a value of the whole shot says nothing new."""

OTHER_ICE = 4.0
"""Times the larger error from which the friction of the whole shot is not that of the glides: in
good fits, on swept and uneven ice too, they differ by up to 2.7."""

NEAR = 2.2
"""Distance of two stones' centres, in radii, from which they may have hit each other unseen."""

INSTEAD = "local estimates of each hit and glide are used"
"""What is done where the whole shot is not used."""

LED_ASTRAY = (
    f"shot fit: something other than ice and hits moves a stone before its first hit; {INSTEAD}"
)
"""Why a shot with hits is not fitted as a whole."""

ALONE = "it keeps its weight: something else moves the stone, or its track is distorted"
TOO_FEW = "it keeps its weight: too few stones move to identify which track is distorted"
"""What is said of a bent track of a stone by itself, and of one that may be the others' fault."""

LAWS = ("restitution", "friction", "stone_friction")
"""Unknowns of a shot that are not of one stone alone."""


@dataclass(frozen=True)
class Estimates:
    """What a table of detections says about the physics of the shot.

    Attributes
    ----------
    restitution : Estimate
        Pooled over all hits.
    friction : Friction
        Pooled over all glides.
    collisions : tuple of Hit
        In order of time.
    glides : tuple of Glide
        In order of stone and time.
    warnings : tuple of str
        What could not be told and why; what does not agree.
    local : Local
        What the paths beside the hits say, with what the whole shot, where it is used, has caps
        beside their centres by taken out.
    shot_fit : ShotFit or None
        The whole shot fitted through the simulator, where its stones move as it knows it.
    by_shot_fit : Method
        What that fit says, even where it is not used, and then why.
    curl : NotedEstimate
        Turn of the paths at 1 m/s for a stone that spins counter-clockwise, rad/s.
    residuals : tuple of TrackResidual
        How far each track is from its path in a fit that follows the shot, between its hits.
    """

    restitution: Estimate = field(default_factory=Estimate)
    friction: Friction = field(default_factory=Friction)
    collisions: tuple[Hit, ...] = ()
    glides: tuple[Glide, ...] = ()
    warnings: tuple[str, ...] = ()
    local: Local = field(default_factory=Local, compare=False)
    shot_fit: ShotFit | None = field(default=None, compare=False)
    by_shot_fit: Method = field(default_factory=Method)
    curl: NotedEstimate = field(default_factory=NotedEstimate)
    residuals: tuple[TrackResidual, ...] = ()

    @property
    def methods(self) -> dict[str, Method]:
        """Restitution and friction by each method, side by side."""
        local = self.local
        alone = Method(
            local.restitution,
            Estimate(local.friction.value, local.friction.stderr),
            NotedEstimate(note="friction between the stones is estimated for each hit"),
            hits=tuple(Estimate(hit.restitution, hit.stderr) for hit in local.collisions),
            note="from the paths just before and after each hit",
        )
        plain = by_finite_differences(local.known, local.collisions, _rests(local))
        return {"local": alone, "shot_fit": self.by_shot_fit, "finite-differences": plain}

    @property
    def by_stone(self) -> dict[str, StoneResult]:
        """What each stone tells by itself."""
        return results_by_stone(self.glides, self.collisions)

    @property
    def joint_estimate(self) -> JointEstimate | None:
        """What the whole shot tells of restitution and frictions, and more, with covariance.

        Size is the distance of two stones' centres as they hit each other over two radii, loss
        that of spin times speed, m rad/s³, and inertia k in I = k m R².
        """
        return (
            None
            if self.shot_fit is None
            else self.shot_fit.joint((*LAWS, "size", "loss", "inertia"))
        )


def estimate(
    detections: pd.DataFrame,
    contacts: Sequence[HitCandidate],
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
) -> Estimates:
    """Estimate restitution, friction and the state of the stones at each hit.

    Parameters
    ----------
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`.
    contacts : sequence of HitCandidate
        The hits, as `curlshot.physics.local_fit.hit_detection.detect_hits` gives them.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; equal where absent.
    """

    def centred(fit: ShotFit) -> Local:
        over = centred_traces(seen.known, fit)
        if over is seen.known:
            return seen
        return estimate_from_traces(over, contacts, radius=radius, masses=masses)

    seen = estimate_locally(detections, contacts, radius=radius, masses=masses)
    fitted, local, off, doubt, end = _whole(seen, radius, masses or {}, centred)
    restitution, friction, unsure = local.restitution, local.friction, local.friction_doubt
    whole = fitted if doubt is None else None
    if fitted is not None and doubt is not None and _fits(fitted):
        restitution = _of_two(restitution, fitted["restitution"])
        wider = _of_two(Estimate(friction.value, friction.stderr), fitted["friction"])
        friction = replace(friction, stderr=wider.stderr)
    if whole is not None and restitution.value is not None and whole.identifies("restitution"):
        restitution = whole["restitution"]
    if whole is not None and friction.value is not None and whole.identifies("friction"):
        friction, unsure = _friction(whole), None
    warnings = (unsure, *local.warnings, doubt or end, *_astray(off))
    return Estimates(
        restitution,
        friction,
        local.collisions,
        local.glides,
        tuple(text for text in warnings if text is not None),
        local,
        whole,
        _global(fitted, doubt),
        _curl(whole, doubt),
        off,
    )


def _rests(local: Local) -> dict[str, float]:
    """Time at which each stone that is seen to come to rest does so, s."""
    ends = {glide.stone: glide.t1 for glide in local.glides}
    return {
        stone: end
        for stone, end in ends.items()
        if stone in local.known and end < local.known[stone].t[-1]
    }


def _global(fit: ShotFit | None, doubt: str | None) -> Method:
    """Return what the whole shot says, used or not."""
    if fit is None:
        return Method(note=doubt or "no shot fit: no stone glides")
    rub = NotedEstimate(
        note=(
            "not identifiable: any friction that stops the stones sliding on each other gives"
            " the same motion"
        )
    )
    if fit.identifies("stone_friction"):
        rub = NotedEstimate(*_pair(fit["stone_friction"]))
    elif "stone_friction" in fit.names:
        rub = NotedEstimate(note="not identifiable: the shot adds nothing to the prior")
    known = {name: fit[name] for name in ("restitution", "friction") if fit.identifies(name)}
    return Method(
        known.get("restitution", Estimate()), known.get("friction", Estimate()), rub, note=doubt
    )


def _curl(fit: ShotFit | None, doubt: str | None) -> NotedEstimate:
    """Turn of the paths at 1 m/s, rad/s, where it shows."""
    if fit is None:
        return NotedEstimate(note=doubt or "no shot fit")
    if "turn" in fit.fixed:
        return NotedEstimate(note="not identifiable: the shot is explained as well without curl")
    return NotedEstimate(*_pair(fit["turn"]))


def _pair(estimate: Estimate) -> tuple[float | None, float | None]:
    return estimate.value, estimate.stderr


def _friction(whole: ShotFit) -> Friction:
    """Friction of the ice at 1 m/s with the law that the whole shot was fitted with."""
    mu = whole["friction"]
    if "slope" in whole.fixed:
        return Friction(mu.value, mu.stderr)
    law = ice(whole.state())
    return Friction(mu.value, mu.stderr, "fit", law.a, law.v_c, law.b)


class _Whole(NamedTuple):
    """The whole shot fitted through the simulator, and what comes of it.

    Attributes
    ----------
    fit : ShotFit or None
    local : Local
        What the paths beside the hits say: as sighted, or, where that goes with the fit, with what
        the fit has caps beside the centres by taken out of the detections.
    off : tuple of TrackResidual
        How far each track is from the fit, where that follows the shot.
    doubt, end : str or None
        Why what the fit gives is not to be used; how far it goes.
    """

    fit: ShotFit | None
    local: Local
    off: tuple[TrackResidual, ...] = ()
    doubt: str | None = None
    end: str | None = None


def _whole(
    seen: Local,
    radius: float,
    masses: Mapping[str, float],
    centred: Callable[[ShotFit], Local],
) -> _Whole:
    """Fit the whole shot through the simulator, and hold it against the paths beside the hits."""
    hits = seen.fit is not None and bool(seen.fit.meetings)
    if seen.fit is None or not (hits or seen.friction.value):
        return _Whole(None, seen)
    observed = observe(
        seen.known, seen.fit, radius,
        priors=loose_priors(radius), masses=masses,
        bystanders=() if hits else _beside(seen, radius),
    )  # fmt: skip
    if observed is None or (hits and not observed.hits):
        return _Whole(None, seen, doubt=LED_ASTRAY if hits else None)
    try:
        fit, part = fit_valid_interval(observed)
    except InputError:
        return _Whole(None, seen, doubt=f"shot fit: no sliding stones move like this; {INSTEAD}")
    off = track_residuals(observed, fit) if followed(fit) else ()
    # Caps beside the centres turn with the stones; paths beside a hit take that for velocity.
    over = centred(fit) if _fits(fit) else seen
    agrees = _doubt(fit, over.restitution) is None
    doubt = None if agrees else _doubt(fit, seen.restitution)
    doubt = doubt or _other_ice(seen.friction, fit["friction"])
    so_far = part if hits else "until something else moves a stone"
    if doubt is None and so_far is not None and _blunt(fit["friction"], seen.friction):
        doubt = (
            f"shot fit: the simulator reproduces the shot {so_far}, which is too short; {INSTEAD}"
        )
    end = None if part is None else f"shot fit: the simulator reproduces the shot {part}"
    agrees = agrees and _other_ice(over.friction, fit["friction"]) is None
    return _Whole(fit, over if agrees and doubt is None else seen, off, doubt, end)


def _astray(off: Sequence[TrackResidual]) -> Iterator[str]:
    """Name the tracks that are not as in the simulated shot."""
    for one in off:
        if one.significant:
            alone = all(other.stone == one.stone for other in off)
            so = "it has little weight there" if one.downweighted else ALONE if alone else TOO_FEW
            yield (
                f"shot fit: from {one.t0:.2f} to {one.t1:.2f} s the track of {one.stone} deviates"
                f" from a path on this ice by {_times(one.rms_ratio)} times its errors; {so}"
            )


def _times(size: float) -> str:
    """Write how many times: to a tenth below ten, else to two digits."""
    return f"{size:.1f}" if size < 9.95 else f"{float(f'{size:.2g}'):.0f}"


def _beside(local: Local, radius: float) -> list[str]:
    """Stones at rest that others come near: a hit that nobody saw would be with one of them."""
    moving = {piece.stone for piece in local.fit.pieces if not piece.rest} if local.fit else set()
    ways = np.concatenate([local.known[name].xy for name in moving])
    return sorted(
        name
        for name in {*local.known} - moving
        if np.hypot(*(ways - np.median(local.known[name].xy, axis=0)).T).min() < NEAR * radius
    )


def _doubt(fit: ShotFit, local: Estimate) -> str | None:
    """Say why what a fit of the whole shot gives is not to be used, None where it is."""
    if not followed(fit):
        return f"shot fit: the simulator does not reproduce the shot; {INSTEAD}"
    if fit.misfit > POOR_FIT:
        return (
            "shot fit: simulated paths and tracks differ by more than their errors (variance ×"
            f" {fit.misfit:.0f}); {INSTEAD}"
        )
    if fit.diverged:
        return f"shot fit: stones are far from their simulated paths; {INSTEAD}"
    return _disagreement(local, fit["restitution"])


def _fits(fit: ShotFit) -> bool:
    """Whether a fit of the whole shot is as it was seen."""
    return followed(fit) and fit.misfit <= POOR_FIT and not fit.diverged


def _of_two(local: Estimate, whole: Estimate) -> Estimate:
    """Return the first of two values that may disagree, with what they differ by in its error.

    One of them errs by more than it says, and which is not known.
    """
    if local.value is None or local.stderr is None or whole.value is None or whole.stderr is None:
        return local
    values, errors = np.array([[local.value, whole.value], [local.stderr, whole.stderr]])
    spread = random_effects(values, np.diag(errors**2)).spread
    return Estimate(local.value, float(np.hypot(local.stderr, spread)))


def _blunt(whole: Estimate, local: Estimate | Friction) -> bool:
    """Whether a value of the whole shot is so much less sure that it says nothing new."""
    return bool(whole.stderr and local.stderr and whole.stderr > BLUNT * local.stderr)


def _other_ice(local: Friction, whole: Estimate) -> str | None:
    """Say so where the friction of the whole shot is not that of the glides."""
    if local.value is None or not local.stderr or whole.value is None or whole.stderr is None:
        return None
    if abs(whole.value - local.value) <= OTHER_ICE * max(local.stderr, whole.stderr):
        return None
    return (
        f"friction: {local.value:.4f} ± {local.stderr:.4f} from the glides and {whole.value:.4f}"
        f" ± {whole.stderr:.4f} from the shot fit disagree; the first is used, with its error"
        " enlarged by the difference"
    )


def _disagreement(local: Estimate, whole: Estimate) -> str | None:
    """Say so where the second estimate of the restitution is blunt, or differs by more than it may.

    The second uses all that the first does, and more: with errors that are anew in each frame
    the variance of their difference would be the difference of their variances (Hausman, 1978,
    Econometrica 46, 1251). What a map of the ice shares moves them apart by more, up to about
    the larger of their errors.
    """
    if local.value is None or local.stderr is None or whole.value is None or whole.stderr is None:
        return None
    if _blunt(whole, local):
        return (
            f"shot fit: its error of the restitution is ± {whole.stderr:.2g}; {INSTEAD} (±"
            f" {local.stderr:.2g})"
        )
    if abs(whole.value - local.value) <= 3 * max(local.stderr, whole.stderr):
        return None
    return (
        f"restitution: {local.value:.3f} ± {local.stderr:.3f} from the local estimates and"
        f" {whole.value:.3f} ± {whole.stderr:.3f} from the shot fit disagree; the first is used,"
        " with its error enlarged by the difference"
    )
