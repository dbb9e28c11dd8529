"""How good a whole run is, on clips whose truth is known: one row a clip.

    python -m benchmarks.shots [CLIP.mp4 ...] [--shared ../shared]

The truth of a clip ``NAME.mp4`` lies beside it, in ``NAME.truth.json`` and perhaps ``.csv``.
The yardstick for the time is decoding the clip alone.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from curlshot import pipeline
from curlshot.synthetic.scoring import read_truth, score_tracks
from curlshot.vision.video.reader import open_video

ROOT = Path(__file__).resolve().parents[1]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="*", type=Path)
    parser.add_argument("--shared", type=Path, default=ROOT.parent / "shared")
    parser.add_argument("--out", type=Path, help="keep the results here")
    arguments = parser.parse_args()
    clips = arguments.clips or [
        pipeline.sample_clip(),
        *sorted((arguments.shared / "clips").glob("semireal_*.mp4")),
    ]
    with tempfile.TemporaryDirectory() as scratch:
        for clip in clips:
            print(row(clip, (arguments.out or Path(scratch)) / clip.stem), flush=True)


def row(clip: Path, out: Path) -> str:
    truth = read_truth(clip)
    start = time.process_time()
    frames = sum(1 for _ in open_video([clip]))
    decoding = time.process_time() - start
    start, wall = time.process_time(), time.perf_counter()
    done = pipeline.run([clip], out)
    cpu, wall = time.process_time() - start, time.perf_counter() - wall
    score = score_tracks(done.tracks, truth.stones)
    e, mu = done.results.restitution, done.results.friction
    return "\n".join(
        [
            f"{clip.stem}: {frames} frames, {cpu:.1f} s CPU, {wall:.1f} s, decoding {decoding:.1f}",
            f"  recall {score.recall:.3f}  missed {score.missed}  switches {score.switches}"
            f"  false {score.false_tracks} ({score.false_frames} frames)",
            f"  position RMSE {score.rmse * 1e3:.1f} mm  bias {score.bias[0] * 1e3:+.1f}"
            f" {score.bias[1] * 1e3:+.1f} mm  within two sd {score.within_two_sd:.2f}",
            f"  e {e.value} ± {e.stderr} (true {truth.restitution})",
            f"  mu {mu.value} ± {mu.stderr} (true {truth.friction:.5f})",
            *(f"  {hit.stones} t {hit.t:.4f} e {hit.restitution} ± {hit.stderr}"
              for hit in done.results.collisions),
            *(f"  {model} rmse {s.rmse} rest {dict(s.rest_error)}"
              for model, s in done.results.simulations.items()),
            *(f"  warning: {text}" for text in done.results.warnings),
        ]
    )  # fmt: skip


if __name__ == "__main__":
    main()
