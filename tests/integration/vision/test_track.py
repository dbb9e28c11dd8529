from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.config import VideoConfig
from curlshot.data.sheet import STONE
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.synthetic.scoring import score_tracks
from curlshot.vision.detection.stones import plain_disc
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.stick import stick_cameras
from curlshot.vision.track import (
    track_stones,
)
from curlshot.vision.video.reader import open_video


@pytest.mark.parametrize("name", ["pyeongchang_two_hits", "lgt_glancing"])
def test_real_stones(shared: Path, name: str) -> None:
    truth = json.loads((shared / "clips" / f"semireal_{name}.truth.json").read_text())
    width, height = truth["size"]
    cameras = tuple(
        Camera(
            frame["frame"], frame["t"], np.array(frame["homography"]), (width, height),
            position=-np.array(frame["R"]).T @ np.array(frame["T"]),
        )
        for frame in truth["frames"]
    )  # fmt: skip
    assert all(frame["k1"] == 0 for frame in truth["frames"])
    tracks = pd.read_csv(shared / "clips" / f"semireal_{name}.truth.csv")
    clip = open_video([shared / "clips" / f"semireal_{name}.mp4"], VideoConfig(frames=(40, 110)))
    stones = track_stones(clip, cameras, disc=STONE)
    score = score_tracks(stones.detections.assign(seen=1), tracks[tracks["frame"].between(40, 110)])
    assert score.recall > 0.97
    assert score.switches == 0
    assert not score.false_tracks
    assert score.rmse < 0.015


@pytest.mark.parametrize(
    ("name", "last", "hit"),
    [("video_1_0233_0240", None, 0.95), ("video_13_0030_0034", 52, 1.1)],
)
def test_balls_among_projected_rings_hit_each_other(
    shared: Path, name: str, last: int | None, hit: float
) -> None:
    clip = open_video([shared / "clips" / f"{name}.mp4"], VideoConfig(frames=(0, last)))
    cameras = stick_cameras(clip, (70.0, 360.0, 1173.0, 360.0, 1.9))
    seen = track_stones(clip, cameras, disc=plain_disc(0.0286)).detections
    (contact,) = detect_hits(seen, 0.0286)
    assert contact.t == pytest.approx(hit, abs=0.05)
    assert {*seen.loc[seen["t"] > hit, "stone"]} == {*contact.stones}


def test_pucks_on_a_dark_table(shared: Path) -> None:
    clip = open_video([shared / "clips" / "collision-pucks.mp4"], VideoConfig(frames=(2, 31)))
    cameras = stick_cameras(clip, (20.0, 219.8, 20.0, 35.9, 0.5))
    stones = track_stones(clip, cameras, disc=plain_disc(0.0465))
    table = stones.detections
    assert table["stone"].value_counts().to_dict() == {"A": 30, "B": 30}
    thrown, other = (table[table["stone"] == name] for name in "AB")
    # The masses are equal: what the two move by in all stays the same through the hit.
    total = thrown[["x", "y"]].to_numpy() + other[["x", "y"]].to_numpy()
    before, after = (
        np.polyfit(np.arange(13), total[:13], 1),
        np.polyfit(np.arange(13), total[-13:], 1),
    )
    assert np.hypot(*(before[0] - after[0])) < 0.03 * np.hypot(*before[0])
    assert np.nanmax(np.abs(np.diff(thrown["theta"]))) < 0.05
