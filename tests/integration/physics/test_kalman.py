from __future__ import annotations

from pathlib import Path

from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.tests.helpers.physics.watch import airtable


def test_angles_that_nobody_saw_are_empty(shared: Path) -> None:
    seen = airtable(shared)
    tracks = smooth(seen, detect_hits(seen, 0.035), radius=0.035)
    assert tracks[["theta", "omega", "sd_theta", "sd_omega"]].isna().all().all()
    assert tracks[["x", "vx", "sd_x", "sd_vx"]].notna().all().all()
