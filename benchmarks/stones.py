"""How well stones are found and followed: ``python -m benchmarks.stones`` from the root.

Clips with a known truth: recall of the stone-frames in view, false tracks, identity
switches, position and spin errors, time. Stills: precision and recall over the marked
boxes on the sheet, and errors of the places measured by hand. Clips and stills that are
not at hand are left out.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from curlshot.benchmarks.frames import stone_boxes
from curlshot.data.sheet import STONE
from curlshot.synthetic.camera import broadcast_camera, tilted_camera
from curlshot.synthetic.clip import cached_clip
from curlshot.synthetic.scenes import random_scene, sweepers
from curlshot.synthetic.scoring import score_tracks
from curlshot.vision.detection.glance import glance
from curlshot.vision.detection.stones import SEARCH
from curlshot.vision.optics.camera import Camera
from curlshot.vision.track import track_stones
from curlshot.vision.video.reader import open_video

ROOT = Path(__file__).resolve().parents[1]
SHARED = ROOT.parent / "shared"


def camera_of_pose(frame: dict[str, Any], size: tuple[int, int]) -> Camera:
    """Camera from a homography, a pose x_cam = R X + T and OpenCV's k1."""
    focal = float(frame["K"][0][0])
    position = -np.array(frame["R"]).T @ np.array(frame["T"])
    # OpenCV's k1 belongs to lengths over the focal length, ours to lengths over R.
    k1 = float(frame["k1"]) * (np.hypot(*size) / 2 / focal) ** 2
    homography = np.array(frame["homography"])
    return Camera(frame["frame"], frame["t"], homography, size, k1, 0.0, focal, position)


def cameras_of_table(table: pd.DataFrame, size: tuple[int, int]) -> tuple[Camera, ...]:
    """Give the true cameras of a table with the columns of ``camera.csv``: no edge is aside."""
    cameras = []
    for index, row in enumerate(table.to_dict("records")):
        matrix = np.array([[row[f"h{i}{j}"] for j in (1, 2, 3)] for i in (1, 2, 3)])
        lens = row["k1"], row["k2"], row["f_px"]
        place = np.array([row["cam_x"], row["cam_y"], row["cam_z"]])
        cameras.append(Camera(index, row.get("t", np.nan), matrix, size, *lens, place, 0.0))
    return tuple(cameras)


Case = tuple[str, Path, tuple[Camera, ...], pd.DataFrame]


def real_clips() -> Iterator[Case]:
    for path in sorted((SHARED / "clips").glob("*.truth.json")):
        truth = json.loads(path.read_text())
        width, height = truth["size"]
        cameras = tuple(camera_of_pose(frame, (width, height)) for frame in truth["frames"])
        clip = path.with_name(path.name.replace(".truth.json", ".mp4"))
        yield clip.stem, clip, cameras, pd.read_csv(path.with_suffix(".csv"))


def rendered_clips(count: int = 6) -> Iterator[Case]:
    sample = json.loads((ROOT / "data" / "sample.truth.json").read_text())
    width, height = sample["size"]
    frames = range(len(sample["t"]))
    tracks = pd.concat(
        [
            pd.DataFrame({"stone": name, "frame": frames, "t": sample["t"], **columns})
            for name, columns in sample["stones"].items()
        ]
    )
    table = pd.DataFrame(sample["camera"]).assign(t=sample["t"])
    cameras = cameras_of_table(table, (width, height))
    yield "sample", ROOT / "data" / "sample.mp4", cameras, tracks
    for number in range(count):
        scene = random_scene(np.random.default_rng(number), resting=8)
        tilt = (0, 0, 30)[number % 3]
        path_of_camera = tilted_camera(np.radians(tilt)) if tilt else broadcast_camera(end=3.0)
        if number % 2:
            scene = scene.__class__(**{**vars(scene), "people": sweepers(scene, 3.0)})
        clip, truth = cached_clip(scene, path_of_camera, duration=3.0)
        name = f"rendered {number}, {tilt}°{', sweepers' if number % 2 else ''}"
        yield name, clip, cameras_of_table(truth.camera, truth.size), truth.tracks


def spin_error(found: pd.DataFrame, truth: pd.DataFrame, names: dict[str, str]) -> float:
    """RMS of the spin from nine frames' angles against the true spin, rad/s."""
    errors: list[float] = []
    for true_name, name in names.items():
        seen = found[(found["stone"] == name) & found["theta"].notna()]
        true = truth[truth["stone"] == true_name].set_index("frame")
        if true["omega"].isna().all():
            continue
        for first in range(len(seen) - 8):
            part = seen.iloc[first : first + 9]
            spins = true.loc[part["frame"], "omega"]
            if spins.max() - spins.min() < 0.05:
                slope = np.polyfit(part["t"] - part["t"].mean(), part["theta"], 1)[0]
                errors.append(float(slope - spins.mean()))
    return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")


def clips_table() -> pd.DataFrame:
    rows = []
    for name, path, cameras, truth in (*real_clips(), *rendered_clips()):
        clip = open_video([path])
        start = time.process_time()
        stones = track_stones(clip, cameras)
        spent = time.process_time() - start
        table = stones.detections.assign(seen=1)
        for axis in "xy":
            table[f"sd_{axis}"] = np.hypot(table[f"sd_{axis}"], table[f"sd_place_{axis}"])
        score = score_tracks(table, truth)
        rows.append(
            {
                "clip": name,
                "recall": score.recall,
                "missed": " ".join(score.missed),
                "false tracks": len(score.false_tracks),
                "false frames": score.false_frames,
                "switches": score.switches,
                "RMSE mm": 1e3 * score.rmse,
                "within 2 sd": score.within_two_sd,
                "spin rad/s": spin_error(stones.detections, truth, score.names),
                "ms/frame": 1e3 * spent / len(cameras),
            }
        )
    return pd.DataFrame(rows)


def stills_table() -> pd.DataFrame:
    rows = []
    stills = json.loads((SHARED / "frames" / "stills.json").read_text())["frames"]
    for still in stills:
        picture = open_video([SHARED / "frames" / "images" / still["file"]])
        image = next(iter(picture)).image
        size = (still["size"][0], still["size"][1])
        place = np.array(still["camera"]["xyz"])
        matrix = np.array(still["homography"])
        camera = Camera(0, 0.0, matrix, size, still["k1"], still["k2"], position=place)
        (seen,) = glance([(image, camera)])
        found = np.array([(stone.x, stone.y) for stone in seen.stones]).reshape(-1, 2)
        boxes = stone_boxes(SHARED / "frames", Path(still["file"]).stem)
        marked = camera.ice(boxes[:, :2] * size - 0.5, STONE.cap_height)
        whole = np.all(np.abs(boxes[:, :2] - 0.5) < 0.5 - 0.1 * boxes[:, 2:], axis=1)
        on_sheet = np.abs(marked[:, 0]) < SEARCH.half_width - 0.1
        marked = marked[on_sheet & whole]
        apart = np.hypot(*(found[:, None] - marked[None]).transpose(2, 0, 1))
        measured = np.array([(s["x"], s["y"]) for s in still["stones"]])
        errors = np.hypot(*(found[:, None] - measured[None]).transpose(2, 0, 1)).min(0)
        near_measured = np.hypot(*(found[:, None] - measured[None]).transpose(2, 0, 1)).min(1) < 0.1
        true = (apart.min(1) < 0.12 if len(marked) else np.zeros(len(found), bool)) | near_measured
        rows.append(
            {
                "still": still["file"],
                "marked": len(marked),
                "found of them": int((apart.min(0) < 0.12).sum()),
                "false": int((~true).sum()),
                "measured": len(measured),
                "median mm": 1e3 * float(np.median(errors[errors < 0.1])),
                "worst mm": 1e3 * float(errors[errors < 0.1].max()),
                "errors": (1e3 * errors[errors < 0.1]).round(1).tolist(),
            }
        )
    return pd.DataFrame(rows)


def main() -> None:
    pd.set_option("display.width", 200)
    pd.set_option("display.max_columns", 20)
    print(clips_table().round(3).to_string(index=False))
    if (SHARED / "frames").is_dir():
        table = stills_table()
        print()
        print(table.drop(columns="errors").round(1).to_string(index=False))
        errors = np.concatenate(table["errors"].to_list())
        found, marked = table["found of them"].sum(), table["marked"].sum()
        print(
            f"stills: recall {found / marked:.3f}, precision"
            f" {found / (found + table['false'].sum()):.3f}; places: median"
            f" {np.median(errors):.1f} mm, 95 % within {np.percentile(errors, 95):.1f} mm"
        )


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__).parse_args()
    main()
