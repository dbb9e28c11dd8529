from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from physics.impact import After, Frictional, Impact, PointMass, RigidBody, resolve, tangent

R = 0.1455

velocities = st.tuples(st.floats(-5, 5), st.floats(-5, 5)).map(np.array)
spins = st.floats(-6, 6)
normals = st.floats(-math.pi, math.pi).map(lambda a: np.array([math.cos(a), math.sin(a)]))
unit = st.floats(0, 1)
masses = st.floats(0.02, 20)
hits = st.tuples(velocities, velocities, spins, spins, normals, masses, masses)
Array = NDArray[np.float64]
Spin = float | Array
Case = tuple[np.ndarray, np.ndarray, float, float, np.ndarray, float, float]


def after_hit(model: Impact, case: Case, **extra: tuple[float, float]) -> After:
    v1, v2, w1, w2, n, m1, m2 = case
    return resolve(model, v1, v2, w1, w2, n, R, mass1=m1, mass2=m2, **extra)


def closing(case: Case) -> float:
    return float((case[0] - case[1]) @ case[4])


def energy(v1: Array, v2: Array, w1: Spin, w2: Spin, m1: float, m2: float) -> float:
    k = 0.5 * R**2
    return float(m1 * (v1 @ v1 + k * w1**2) + m2 * (v2 @ v2 + k * w2**2)) / 2


@settings(deadline=None)
@given(hits, unit, st.floats(0, 1))
def test_momentum_restitution_and_energy(case: Case, e: float, mu: float) -> None:
    assume(closing(case) > 1e-6)
    v1, v2, w1, w2, n, m1, m2 = case
    for model in (PointMass(e), Frictional(e, mu, 0.5)):
        after = after_hit(model, case)
        scale = (m1 + m2) * (np.linalg.norm(v1) + np.linalg.norm(v2))
        residual = m1 * (after.v1 - v1) + m2 * (after.v2 - v2)
        assert np.abs(residual).max() <= 1e-12 * scale
        assert (after.v2 - after.v1) @ n == pytest.approx(e * closing(case), abs=1e-12)
        before = energy(v1, v2, w1, w2, m1, m2)
        assert energy(*after, m1, m2) <= before * (1 + 1e-12)


@settings(deadline=None)
@given(hits, unit, st.floats(0, 1), st.floats(0.2, 0.6), velocities)
def test_angular_momentum(case: Case, e: float, mu: float, k: float, place: np.ndarray) -> None:
    assume(closing(case) > 0)
    v1, v2, w1, w2, n, m1, m2 = case
    r1, r2 = place, place + 2 * R * n

    def angular(v1: Array, v2: Array, w1: Spin, w2: Spin) -> float:
        orbit = m1 * (r1[0] * v1[1] - r1[1] * v1[0]) + m2 * (r2[0] * v2[1] - r2[1] * v2[0])
        return float(orbit + k * R**2 * (m1 * w1 + m2 * w2))

    after = after_hit(Frictional(e, mu, k), case)
    scale = (m1 + m2) * 10 * 10
    assert angular(*after) == pytest.approx(angular(v1, v2, w1, w2), abs=1e-12 * scale)


@settings(deadline=None)
@given(hits, unit, st.floats(0.01, 1))
def test_friction_sticks_or_slips(case: Case, e: float, mu: float) -> None:
    assume(closing(case) > 1e-3)
    v1, v2, w1, w2, n, m1, _ = case
    t = tangent(n)
    after = after_hit(Frictional(e, mu, 0.5), case)

    def slip(v1: Array, v2: Array, w1: Spin, w2: Spin) -> float:
        return float((v1 - v2) @ t + R * (w1 + w2))

    along, aside = -m1 * (after.v1 - v1) @ n, m1 * (after.v1 - v1) @ t
    before, left = slip(v1, v2, w1, w2), slip(*after)
    assert abs(aside) <= mu * along * (1 + 1e-9) + 1e-12
    assert before * left >= -1e-9  # friction never turns the slip round
    if abs(left) > 1e-9:
        assert abs(aside) == pytest.approx(mu * along, rel=1e-6, abs=1e-12)


@settings(deadline=None)
@given(hits, unit)
def test_special_cases_agree(case: Case, e: float) -> None:
    assume(closing(case) > 0)
    plain = after_hit(PointMass(e), case)
    smooth = after_hit(Frictional(e, 0.0), case)
    kept = after_hit(RigidBody(e), case, spin_after=(case[2], case[3]))
    for other in (smooth, kept):
        for a, b in zip(plain, other, strict=True):
            assert b == pytest.approx(a, abs=1e-12)


@settings(deadline=None)
@given(hits, unit, spins, spins)
def test_rigid_body_keeps_each_contact_speed(case: Case, e: float, a1: float, a2: float) -> None:
    assume(closing(case) > 0)
    v1, v2, w1, w2, n, m1, m2 = case
    t = tangent(n)
    after = after_hit(RigidBody(e), case, spin_after=(a1, a2))
    assert (float(after.w1), float(after.w2)) == (a1, a2)
    assert after.v1 @ t + R * a1 == pytest.approx(v1 @ t + R * w1, abs=1e-12)
    assert after.v2 @ t - R * a2 == pytest.approx(v2 @ t - R * w2, abs=1e-12)
    normal = m1 * (after.v1 - v1) @ n + m2 * (after.v2 - v2) @ n
    assert normal == pytest.approx(0.0, abs=1e-9)
    assert (after.v2 - after.v1) @ n == pytest.approx(e * closing(case), abs=1e-12)


def test_rigid_body_needs_the_spins_after() -> None:
    with pytest.raises(ValueError, match="spins after"):
        resolve(RigidBody(), (1, 0), (0, 0), 0, 0, (1, 0))


@settings(deadline=None)
@given(hits, unit, st.floats(0, 1), st.floats(-math.pi, math.pi))
def test_rotation_mirror_and_exchange(case: Case, e: float, mu: float, angle: float) -> None:
    assume(closing(case) > 0)
    v1, v2, w1, w2, n, m1, m2 = case
    model = Frictional(e, mu)
    after = after_hit(model, case)
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    turned = after_hit(model, (turn @ v1, turn @ v2, w1, w2, turn @ n, m1, m2))
    assert turned.v1 == pytest.approx(turn @ after.v1, abs=1e-11)
    assert turned.w2 == pytest.approx(after.w2, abs=1e-9)
    flip = np.array([-1.0, 1.0])
    mirrored = after_hit(model, (flip * v1, flip * v2, -w1, -w2, flip * n, m1, m2))
    assert mirrored.v2 == pytest.approx(flip * after.v2, abs=1e-12)
    assert mirrored.w1 == pytest.approx(-after.w1, abs=1e-12)
    exchanged = after_hit(model, (v2, v1, w2, w1, -n, m2, m1))
    assert exchanged.v1 == pytest.approx(after.v2, abs=1e-12)
    assert exchanged.w1 == pytest.approx(after.w2, abs=1e-10)


def test_many_hits_at_once() -> None:
    rng = np.random.default_rng(4)
    v1, v2 = rng.normal(size=(2, 3, 5, 2))
    w1, w2 = rng.normal(size=(2, 3, 5))
    angle = rng.uniform(-3, 3, (3, 5))
    n = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    for model in (PointMass(0.8), RigidBody(0.8), Frictional(0.8)):
        many = resolve(model, v1, v2, w1, w2, n, spin_after=(w2, w1))
        one = resolve(
            model, v1[1, 2], v2[1, 2], w1[1, 2], w2[1, 2], n[1, 2], spin_after=(w2[1, 2], w1[1, 2])
        )
        for a, b in zip(many, one, strict=True):
            assert a[1, 2] == pytest.approx(b, abs=0)


def test_a_hit_as_another_program_has_it() -> None:
    # e = 1, μ_s = 0.2, k = 0.5, R = 0.145 m, 1.992 m/s, 0.10 m off the centre.
    n = np.array([0.10, math.sqrt(0.29**2 - 0.01)]) / 0.29
    after = resolve(Frictional(1.0, 0.2, 0.5), (0, 1.992), (0, 0), 0, 0, n, 0.145)
    assert after.v1 == pytest.approx([-0.539, 0.199], rel=0.01)
    assert after.v2 == pytest.approx([0.539, 1.793], rel=0.01)
    assert (after.w1, after.w2) == pytest.approx((-1.591, -1.591), rel=0.01)
