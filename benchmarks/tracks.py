"""How true the tracks of rendered clips are: ``python -m benchmarks.tracks`` from the root.

Each kind of shot that occurs (`curlshot.benchmarks.kinds`), rendered with a known truth and
followed from the picture to the filter. One row per kind, pooled over its clips: stone-frames found
of those in view, switched stones, false tracks, errors of place, speed and spin, and how many true
values lie within two stated standard errors. A star marks what misses its bar; a column is empty
where the clips have nothing to tell, as spins of stones that are drawn without handles.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from curlshot.benchmarks.kinds import KINDS, Kind, clip_of
from curlshot.benchmarks.stones import cameras_of_table
from curlshot.data.sheet import STONE
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.synthetic import Truth
from curlshot.synthetic.scoring import score_tracks
from curlshot.vision.camera_path.follow_house import follow_house
from curlshot.vision.optics.camera import Camera
from curlshot.vision.track import track_stones
from curlshot.vision.video.reader import Video

SLOW, IDLE = 0.05, 0.05
"""Below these a stone does not count as moving (m/s) or turning (rad/s)."""

BESIDE = 0.01
"""Rows nearer to a hit, s, may lie on its other side."""


@dataclass(frozen=True)
class Bar:
    """What a column must reach: at least `low`, at most `high`."""

    low: float = -np.inf
    high: float = np.inf


COVERED = Bar(0.90, 0.98)
BARS = {
    "recall": Bar(low=0.99), "switches": Bar(high=0), "false": Bar(high=0),
    "speed m/s": Bar(high=0.01), "spin rad/s": Bar(high=0.05),
    "in 2 sd: x": COVERED, "v": COVERED, "omega": COVERED,
}  # fmt: skip


def tracks_of(clip: Video, cameras: Sequence[Camera]) -> pd.DataFrame:
    """Give what ``tracks.csv`` of a clip holds."""
    detections = track_stones(clip, cameras).detections
    hits = detect_hits(detections, STONE.radius)
    return smooth(detections, hits, radius=STONE.radius)


def errors_of(tracks: pd.DataFrame, truth: Truth, names: dict[str, str]) -> pd.DataFrame:
    """Errors and stated errors of all rows that belong to a true stone.

    Returns
    -------
    DataFrame
        ``stone, t, moving, turning``, and per state its error ``d_`` and ``sd_``.
    """
    parts = []
    for true_name, name in names.items():
        ours = tracks[tracks["stone"] == name].set_index("frame")
        true = truth.tracks[truth.tracks["stone"] == true_name].set_index("frame").loc[ours.index]
        hits = np.array([hit.t for hit in truth.hits if true_name in hit.stones])
        beside = np.zeros(len(ours), bool)
        if len(hits):
            beside = np.abs(ours["t"].to_numpy()[:, None] - hits).min(1) < BESIDE
        part = pd.DataFrame({"stone": true_name, "t": ours["t"], "seen": ours["seen"] == 1})
        part["moving"] = (np.hypot(true["vx"], true["vy"]) > SLOW) & ~beside
        part["turning"] = (true["omega"].abs() > IDLE) & ~beside
        for state in ("x", "y", "vx", "vy", "theta", "omega"):
            part[f"d_{state}"] = ours[state] - true[state]
            part[f"sd_{state}"] = ours[f"sd_{state}"]
        part["d_theta"] -= part["d_theta"].median()
        parts.append(part.reset_index())
    return pd.concat(parts, ignore_index=True)


def within(errors: pd.DataFrame, *states: str) -> float:
    """Share of errors of these states within two stated standard errors."""
    told = [errors[errors[f"d_{state}"].notna()] for state in states]
    inside = [
        (rows[f"d_{s}"].abs() < 2 * rows[f"sd_{s}"]) for rows, s in zip(told, states, strict=True)
    ]
    return float(np.concatenate(inside).mean()) if any(map(len, inside)) else float("nan")


def rms(*values: pd.Series) -> float:
    """Root mean square of the sum of squares."""
    square = np.sum([np.square(v.to_numpy(float)) for v in values], axis=0)
    told = square[np.isfinite(square)]
    return float(np.sqrt(told.mean())) if len(told) else float("nan")


def score(kind: Kind, seeds: Sequence[int], found: bool) -> tuple[dict[str, object], pd.DataFrame]:
    """One row of the table, and the errors behind it."""
    scores, errors = [], []
    for seed in seeds:
        clip, truth = clip_of(kind, seed)
        cameras = (
            follow_house(clip).cameras if found else cameras_of_table(truth.camera, truth.size)
        )
        tracks = tracks_of(clip, cameras)
        result = score_tracks(tracks, truth.tracks)
        scores.append(result)
        errors.append(errors_of(tracks, truth, result.names).assign(seed=seed))
    table = pd.concat(errors, ignore_index=True)
    moving, turning = table[table["moving"]], table[table["turning"]]
    return {
        "kind": kind.name,
        "recall": float(np.mean([s.recall for s in scores])),
        "switches": sum(s.switches for s in scores),
        "false": sum(len(s.false_tracks) for s in scores),
        "RMSE mm": 1e3 * rms(table["d_x"], table["d_y"]),
        "bias x": 1e3 * float(table["d_x"].mean()),
        "bias y": 1e3 * float(table["d_y"].mean()),
        "speed m/s": rms(moving["d_vx"], moving["d_vy"]),
        "spin rad/s": rms(turning["d_omega"]),
        "spin told": float(turning["d_omega"].notna().mean()),
        "theta rad": rms(table["d_theta"]),
        "in 2 sd: x": within(table, "x", "y"),
        "v": within(moving, "vx", "vy"),
        "omega": within(turning, "omega"),
    }, table  # fmt: skip


def marked(kind: Kind, row: dict[str, object]) -> dict[str, str]:
    """Numbers as text, with a star where the bar is missed."""
    bars = {**BARS, "RMSE mm": Bar(high=1e3 * kind.rmse)}
    out = {}
    for name, value in row.items():
        if not isinstance(value, int | float):
            out[name] = str(value)
            continue
        bar = bars.get(name, Bar())
        text = str(value) if isinstance(value, int) else f"{value:.3f}".replace("nan", "")
        out[name] = text + ("*" if value < bar.low or value > bar.high else " ")
    return out


def rows(
    kinds: Sequence[Kind], seeds: Sequence[int], found: bool
) -> Iterator[tuple[dict[str, str], pd.DataFrame]]:
    """One row per kind, and the errors behind it."""
    for kind in kinds:
        row, errors = score(kind, seeds, found)
        yield marked(kind, row), errors.assign(kind=kind.name)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", nargs="+", help="only those whose names begin so")
    parser.add_argument("--seeds", nargs="+", type=int, default=[101, 102])
    parser.add_argument("--found", action="store_true", help="cameras as found, not as true")
    parser.add_argument("--errors", help="write all errors to this CSV file")
    said = parser.parse_args()
    starts = tuple(said.kinds or [""])
    kinds = [kind for kind in KINDS if kind.name.startswith(starts)]
    tables = []
    for index, (row, errors) in enumerate(rows(kinds, said.seeds, said.found)):
        if not index:
            print(f"{'kind':21}", *(f"{name:>10}" for name in list(row)[1:]))
        print(f"{row['kind']:21}", *(f"{text:>10}" for text in list(row.values())[1:]), flush=True)
        tables.append(errors)
    everything = pd.concat(tables, ignore_index=True)
    moving, turning = everything[everything["moving"]], everything[everything["turning"]]
    print(
        f"within two standard errors, all: places {within(everything, 'x', 'y'):.3f}, velocities"
        f" {within(moving, 'vx', 'vy'):.3f}, spins {within(turning, 'omega'):.3f}"
    )
    if said.errors:
        everything.to_csv(said.errors, index=False)


if __name__ == "__main__":
    main()
