"""Hits drawn at random, and what they are judged by."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from curlshot.physics.impact import After, Impact, resolve

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
