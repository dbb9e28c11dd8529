from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import estimate_locally
from curlshot.tests.helpers.physics.free_glides import FPS, told
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_an_orbit_has_no_friction() -> None:
    t = np.arange(0.0, 10.0, 1 / FPS)
    found = told(np.column_stack([np.cos(1.3 * t), 0.5 * np.sin(1.3 * t)]))
    assert not found.glides
    assert found.friction.value is None
    assert "no stone glides freely" in str(found.friction_doubt)
    assert any("S0 is apparently pushed or carried" in text for text in found.warnings)


@pytest.mark.parametrize("gain", [0.3, 0.6, 1.0])
def test_a_push_up_to_the_hit_spoils_neither_restitution_nor_tracks(gain: float) -> None:
    detections = watch(hit_motion(1.5, 0.08), np.random.default_rng(3), sd=0.002)
    pushed = (detections["stone"] == "A") & (detections["t"] < 1.0)
    away = 1.0 - detections.loc[pushed, "t"]
    detections.loc[pushed, "y"] += 0.5 * (gain + 0.0109 * 9.81) * away**2
    contacts = detect_hits(detections, RADIUS)
    found = estimate_locally(detections, contacts, radius=RADIUS)
    assert found.restitution.value == pytest.approx(0.83, abs=0.02)
    assert found.restitution.stderr is not None and found.restitution.stderr < 0.02
    assert found.friction.value == pytest.approx(0.0109, abs=0.0005)
    assert any("A is apparently pushed or carried" in text for text in found.warnings)
    tracks = smooth(detections, contacts, radius=RADIUS).query("stone == 'A' and t < 0.98")
    speed = 1.5 - gain * (1.0 - tracks["t"])
    assert np.sqrt(np.mean((tracks["vy"] - speed) ** 2)) < 0.05
