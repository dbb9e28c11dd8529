from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.impact import Frictional, PointMass, RigidBody, resolve


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
