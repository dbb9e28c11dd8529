"""The laws that a measured shot is simulated with: what it tells of them, else what is assumed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isclose

import numpy as np

from curlshot.data.results import Estimate, Friction, Hit, JointEstimate, Results
from curlshot.data.sheet import GRAVITY, STONE, curling_size
from curlshot.physics.curl import Curl, FCV1Curl, NoCurl
from curlshot.physics.estimate import Estimates
from curlshot.physics.ice import Constant, Fit, IceLaw
from curlshot.physics.impact import Frictional
from curlshot.physics.shot_fit.priors import LITERATURE, STONE_FRICTION, literature
from curlshot.physics.simulator.simulation import Shot

UNSCALED = Estimate(1.0, 0.0)
"""Stones that meet at two radii."""

LOSS = float(LITERATURE.loss.value or 0.0)
"""Loss of spin times speed where the shot does not tell it, m rad/s³."""

LEAST_FRICTION = 1e-6
"""Friction of ice that slows no stone: a law needs some."""


@dataclass(frozen=True)
class Laws:
    """Laws of a shot, each with its standard error.

    Attributes
    ----------
    restitution, stone_friction : Estimate
        Of the hits; always with a value.
    ice : IceLaw
        The ice.
    sd_friction : float
        Standard error of its friction, as a part of it.
    curl : FCV1Curl or NoCurl
        Turn of the paths; none for discs that are no curling stones.
    sd_turn : float
        Standard error of the turn at 1 m/s, rad/s; 0 where no curl shows.
    size : Estimate
        Distance of two stones' centres as they hit each other over two radii: what the scale of
        the tracks and their radius make of it.
    inertia : float
        k in the moment of inertia k m R².
    assumed : mapping of str to str
        ``restitution``, ``stone_friction`` or ``friction`` to what was assumed of it, where the
        shot does not tell.
    """

    restitution: Estimate
    stone_friction: Estimate
    ice: IceLaw
    sd_friction: float
    curl: Curl
    sd_turn: float = 0.0
    size: Estimate = UNSCALED
    inertia: float = STONE.inertia
    assumed: Mapping[str, str] = field(default_factory=dict)

    @property
    def frictional(self) -> Frictional:
        """What a hit does by these laws, with Coulomb's friction."""
        rubbing = self.stone_friction.value or 0.0
        return Frictional(self.restitution.value or 0.0, rubbing, self.inertia)


def measured_laws(shot: Estimates | Results, radius: float) -> Laws:
    """Return the laws of a measured shot of discs with that radius, m."""
    assumed: dict[str, str] = {}
    restitution = shot.restitution
    if restitution.value is None:
        restitution = literature(radius).restitution
        assumed["restitution"] = f"restitution not measured, {restitution.value} assumed"
    e = min(max(restitution.value or 0.0, 0.0), 1.0)
    rubbing = between_stones(shot.joint_estimate, shot.collisions)
    if rubbing.value is None:
        least = max([STONE_FRICTION, *map(_rub, shot.collisions)])
        how = "at least about" if least > STONE_FRICTION else "assumed to be"
        assumed["stone_friction"] = f"friction between the stones {how} {least:.2g}"
        # Hits that do not tell it hardly depend on it.
        uncertainty = 0.0 if shot.collisions else LITERATURE.stone_friction.stderr
        rubbing = Estimate(least, uncertainty)
    ice, sd_friction = _ice(shot.friction, literature(radius).friction, assumed)
    curling = curling_size(radius)
    return Laws(
        Estimate(e, restitution.stderr),
        Estimate(max(rubbing.value or 0.0, 0.0), rubbing.stderr),
        ice,
        sd_friction,
        FCV1Curl(shot.curl.value or 0.0, _value(shot.joint_estimate, "loss", LOSS))
        if curling
        else NoCurl(),
        (shot.curl.stderr or 0.0) if curling else 0.0,
        _of(shot.joint_estimate, "size") or UNSCALED,
        _value(shot.joint_estimate, "inertia", STONE.inertia),
        assumed,
    )


def assumed_of(laws: Laws, shot: Shot) -> dict[str, str]:
    """Say what was assumed of the laws of a shot: where the fit of the whole of it tells, that."""
    usual = {"restitution": laws.frictional.restitution, "friction": friction_at_1(laws.ice)}
    own = {
        "restitution": getattr(shot.impact, "restitution", usual["restitution"]),
        "friction": friction_at_1(shot.ice),
    }
    said = dict(laws.assumed)
    for name in own.keys() & said.keys():
        if not isclose(own[name], usual[name], rel_tol=1e-6):
            said[name] = f"{name} not measured: {own[name]:.2g}, as in the shot fit"
    return said


def friction_at_1(ice: IceLaw) -> float:
    """Friction of a law of the ice at 1 m/s."""
    return float(ice.deceleration(1.0)) / GRAVITY


def between_stones(laws: JointEstimate | None, collisions: Sequence[Hit]) -> Estimate:
    """Friction between the stones: of the whole shot if it tells it, else of its hits."""
    whole = _of(laws, "stone_friction")
    if whole is not None:
        return whole
    told = [
        (hit.stone_friction, hit.stderr_stone_friction)
        for hit in collisions
        if hit.stone_friction is not None and hit.stderr_stone_friction
    ]
    if not told:
        return Estimate()
    values, errors = np.array(told, float).T
    weights = errors**-2
    return Estimate(float(weights @ values / weights.sum()), float(weights.sum() ** -0.5))


def _value(laws: JointEstimate | None, name: str, usual: float) -> float:
    """Value of one of the laws of a whole shot, the usual one where it does not tell it."""
    told = _of(laws, name)
    return usual if told is None or told.value is None else told.value


def _of(laws: JointEstimate | None, name: str) -> Estimate | None:
    """One of the laws of a whole shot, None where it does not tell it."""
    if laws is None or name not in laws.names:
        return None
    k = laws.names.index(name)
    return Estimate(laws.values[k], float(np.sqrt(laws.cov[k][k])))


def _ice(friction: Friction, usual: Estimate, assumed: dict[str, str]) -> tuple[IceLaw, float]:
    """Return the law of the ice and the relative error of its friction, the usual one if untold."""
    if friction.value is None:
        friction = Friction(usual.value, usual.stderr)
        assumed["friction"] = f"friction not measured, {usual.value} assumed"
    value = friction.value or 0.0
    if value <= 0:
        assumed["friction"] = f"friction measured as {value:.4f}, 0 used"
        return Constant(LEAST_FRICTION), 0.0
    sd = (friction.stderr or 0.0) / value
    return law_of(friction), sd


def law_of(friction: Friction) -> IceLaw:
    """Return the law of the ice that a friction, which is told, belongs to."""
    a, v_c, b = friction.a, friction.v_c, friction.b
    if friction.law == "fit" and a is not None and v_c is not None and b is not None:
        return Fit(a, v_c, b)
    return Constant(friction.value or 0.0)


def _rub(hit: Hit) -> float:
    """Tangential over normal impulse of a hit: the friction between the stones is no less.

    Where they stop sliding on each other before they part, any greater friction does the same.
    """
    first, second = hit.stones
    (a, b), (c, d) = ((s[first], s[second]) for s in (hit.before, hit.after))
    jump = (d.vx - b.vx - c.vx + a.vx, d.vy - b.vy - c.vy + a.vy)
    push = jump[0] * hit.normal[0] + jump[1] * hit.normal[1]
    rub = jump[1] * hit.normal[0] - jump[0] * hit.normal[1]
    return abs(rub / push) if hit.note is None and push > 0 else 0.0
