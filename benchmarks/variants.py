"""The sample's shot otherwise: whether a whole run stays as good as on the sample itself.

    python -m benchmarks.variants [--first 0] [--count 6]

Each variant is rendered from a seed of its own (other restitution, frictions, throw, spins,
camera, rate and size of the picture: `curlshot.synthetic.scenes.sample_variant`), run as a clip,
and laid beside its truth. Last places are those of the model `frictional`, in cm, their stated
errors in brackets: of the shot again, with the start and the laws that fit the whole of it; as
predicted from what was seen before the first hit, with the laws as measured; and as predicted with
those of the literature.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from curlshot import pipeline
from curlshot.data.results import Estimate, Prediction
from curlshot.outcome import Run
from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.prediction.forecast import predict
from curlshot.physics.prediction.laws import measured_laws
from curlshot.physics.shot_fit.priors import Priors, literature
from curlshot.synthetic.clip import Truth, cached_clip
from curlshot.synthetic.scenes import sample_variant

DURATION = 6.0


def rendered(seed: int) -> tuple[Path, Truth]:
    """Render a variant, once per machine."""
    rng = np.random.default_rng(seed)
    scene, camera = sample_variant(rng)
    rate = float(rng.choice([25.0, 60.0]))
    return cached_clip(scene, camera, fps=rate, duration=DURATION)


def row(seed: int) -> tuple[str, bool]:
    """Run one variant: the outcome as a line, and whether it keeps the bars."""
    clip, truth = rendered(seed)
    measured = pipeline.measure([clip])
    done = pipeline.analyse(measured)
    results, e, mu = done.results, truth.hits[0].restitution, truth.friction
    off_e = (results.restitution.value or np.nan) - e
    off_mu = (results.friction.value or np.nan) / mu - 1
    score = results.simulations["frictional"]
    again = {stone: off for stone, off in score.rest_error.items() if off is not None}
    ahead = foretold(done, measured.detections)
    forecast = results.predictions["frictional"]
    kept = abs(off_e) <= 0.01 and abs(off_mu) <= 0.03 and max(again.values(), default=1.0) <= 0.03
    wide, high = truth.size
    cells = [
        f"{seed:4d}  {wide}x{high} {truth.fps:.0f} fps",
        f"e {e:.3f} {off_e:+.4f} ± {results.restitution.stderr or np.nan:.4f}",
        f"mu {mu:.4f} {100 * off_mu:+.2f} ± {100 * (results.friction.stderr or np.nan) / mu:.2f} %",
        f"again {_places(again, score.rest_sd)}",
        f"before {_places(ahead.rest_error, ahead.rest_sd)}",
        f"literature {_places(forecast.rest_error, forecast.rest_sd)}",
    ]
    return "  ".join([*cells, "yes" if kept else "NO"]), kept


def foretold(done: Run, detections: pd.DataFrame) -> Prediction:
    """Predict the shot from what was seen before its first hit, with the laws as measured."""
    results = done.results
    found = estimate(detections, detect_hits(detections, results.radius), radius=results.radius)
    laws = as_measured(found, results.radius)
    return predict(detections, done.tracks, found, radius=results.radius, laws=laws)["frictional"]


def as_measured(shot: Estimates, radius: float) -> Priors:
    """Return the laws of a measured shot as what is known of them before it is seen again.

    How friction falls and paths curl is as the fit of the whole shot has it, else as on any ice.
    """
    laws, usual = measured_laws(shot, radius), literature(radius).friction
    told = Estimate(shot.friction.value, shot.friction.stderr)
    friction = usual if told.value is None else told
    known = Priors(laws.restitution, laws.stone_friction, friction, laws.size)
    if shot.shot_fit is None:
        return known
    names = ("slope", "v_c", "turn", "loss", "inertia")
    return replace(known, **{name: Estimate(shot.shot_fit[name].value, 0.0) for name in names})


def _places(errors: Mapping[str, float | None], stated: Mapping[str, float | None]) -> str:
    """Errors of places and, in brackets, the stated ones, cm."""
    known = {stone: np.nan if off is None else off for stone, off in errors.items()}
    return " ".join(
        f"{stone} {100 * off:.1f} ({100 * (stated.get(stone) or np.nan):.1f})"
        for stone, off in known.items()
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--count", type=int, default=6, help="number of variants")
    arguments = parser.parse_args()
    kept = 0
    for seed in range(arguments.first, arguments.first + arguments.count):
        line, good = row(seed)
        kept += good
        print(line, flush=True)
    print(f"{kept} of {arguments.count} within 0.01 of e, 3 % of mu and 3 cm of rest")


if __name__ == "__main__":
    main()
