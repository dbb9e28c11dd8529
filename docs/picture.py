"""Make the picture at the top of the README from a run of the sample.

Run it as ``python docs/picture.py RUN``. RUN is the folder that `curlshot run` wrote of the
bundled sample.
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
from PIL import Image

from curlshot.data.results_file import read_results
from curlshot.data.sheet import HOUSE
from curlshot.data.tracks import read_tracks
from curlshot.report.figures import plan_figure
from curlshot.report.style import render

WHEN = 3.2  # s in the clip, after both hits
HEIGHT = 720  # px of the picture, as of the clip
SHOWN = (0.14, 0.84)  # of the width of the frame: the sheet, not its neighbours


def picture(run: Path) -> Image.Image:
    """Return a frame of the annotated clip, and beside it the plan view."""
    frame = annotated(run / "overlay.mp4", WHEN)
    results, tracks = read_results(run / "results.json"), read_tracks(run / "tracks.csv")
    simulations = dict(list(pd.read_csv(run / "simulation.csv").groupby("model")))
    figure = plan_figure(tracks, simulations, results.collisions, house=HOUSE)
    plan = Image.open(BytesIO(render(figure)[1])).convert("RGB")
    parts = [scaled(part) for part in (frame, plan)]
    whole = Image.new("RGB", (sum(part.width for part in parts), HEIGHT), "white")
    left = 0
    for part in parts:
        whole.paste(part, (left, 0))
        left += part.width
    # A palette takes a third of the bytes.
    return whole.quantize(256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)


def scaled(part: Image.Image) -> Image.Image:
    """Return a part of the picture at the height of all."""
    size = round(part.width * HEIGHT / part.height), HEIGHT
    return part.resize(size, Image.Resampling.LANCZOS)


def annotated(clip: Path, when: float) -> Image.Image:
    """Return the frame of a clip at a time, s."""
    capture = cv2.VideoCapture(str(clip))
    capture.set(cv2.CAP_PROP_POS_MSEC, 1000 * when)
    found, pixels = capture.read()
    capture.release()
    if not found:
        raise SystemExit(f"{clip}: no frame at {when} s")
    left, right = (round(share * pixels.shape[1]) for share in SHOWN)
    return Image.fromarray(np.ascontiguousarray(pixels[:, left:right, ::-1]))


if __name__ == "__main__":
    picture(Path(sys.argv[1])).save(Path(__file__).parent / "result.png", optimize=True)
