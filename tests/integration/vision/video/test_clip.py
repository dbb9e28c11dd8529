from __future__ import annotations

from pathlib import Path

import numpy as np

from curlshot.config import VideoConfig
from curlshot.vision.video.reader import open_video


def test_a_rate_for_a_video_is_ignored_aloud(shared: Path) -> None:
    clip = open_video([shared / "clips" / "collision-pucks.mp4"], VideoConfig(fps=10))
    assert "its own times" in clip.warnings[0]


def test_real_clip_with_title_cards(shared: Path) -> None:
    clip = open_video([shared / "clips" / "collision-pucks.mp4"], VideoConfig(frames=(2, 32)))
    frames = list(clip)
    assert len(frames) == 31
    assert clip.size == (320, 240)
    np.testing.assert_allclose(np.diff([frame.t for frame in frames]), 1001 / 30000, atol=1e-3)
