"""Frames that repeat the one before, in the tables of a run: rows at their own times, not seen."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from curlshot import pipeline
from curlshot.config import Config
from curlshot.synthetic.video import write_video

FPS, RADIUS, SCALE = 25.0, 0.08, 200.0
SIZE = 320, 160
STEP = 0.012
"""How far the disc goes from frame to frame, m."""

CONFIG = Config().replace(radius=RADIUS, stick=(0.0, 80.0, SCALE, 80.0, 1.0))


def disc(number: int) -> np.ndarray:
    """A disc that glides to the right over printed ice, and its number of steps."""
    rng = np.random.default_rng(4)
    ice = cv2.GaussianBlur(rng.integers(190, 250, (*SIZE[::-1], 3)).astype(np.uint8), (0, 0), 3)
    at = SCALE * (0.3 + STEP * number)
    cv2.circle(ice, (round(16 * at), 16 * 80), round(16 * SCALE * RADIUS), (40, 40, 160), -1,
               cv2.LINE_AA, 4)  # fmt: skip
    return ice


def clip(path: Path, shown: list[int]) -> Path:
    write_video(path, [(k / FPS, disc(number)) for k, number in enumerate(shown)], fps=FPS)
    return path


@pytest.mark.parametrize(
    ("shown", "frames", "repeats"),
    [
        ([*range(40), *[39] * 5], None, [*range(40, 45)]),
        ([0, 0, *range(2, 42)], None, [1]),
        ([*range(20), *[19] * 4, *range(24, 44)], None, [20, 21, 22, 23]),
        ([*range(40), *[39] * 5], (4, 42), [40, 41, 42]),
    ],
    ids=["end", "begin", "halt", "range"],
)
def test_every_decoded_frame_has_a_row(
    tmp_path: Path, shown: list[int], frames: tuple[int, int] | None, repeats: list[int]
) -> None:
    run = pipeline.run([clip(tmp_path / "a.mp4", shown)], config=CONFIG, frames=frames)
    first, last = frames or (0, len(shown) - 1)
    numbers = np.arange(first, last + 1)
    assert run.tracks["frame"].tolist() == run.cameras["frame"].tolist() == numbers.tolist()
    for table in (run.tracks, run.cameras):
        np.testing.assert_allclose(table["t"], numbers / FPS, atol=1e-3)
    unseen = run.tracks["seen"] == 0
    assert run.tracks.loc[unseen, "frame"].tolist() == repeats
    assert run.cameras.loc[run.cameras["found"] == 0, "frame"].tolist() == repeats
    # A repeat's place is that of its own time, on the straight way of the disc.
    np.testing.assert_allclose(run.tracks["x"], 0.3 + STEP * numbers, atol=0.004)
