"""Render the bundled sample: ``python -m curlshot.synthetic.sample`` from the repository root.

Writes data/sample.mp4 and data/sample.truth.json. The clip is rendered, not filmed; what it
shows and what was chosen is told at `curlshot.synthetic.scenes.sample_scene`.
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

from curlshot.synthetic.clip import Truth, render_clip
from curlshot.synthetic.scenes import sample_camera, sample_scene

FPS, DURATION, CRF, SHUTTER = 25.0, 6.6, 19, 0.012


def truth_as_json(truth: Truth) -> str:
    """Return the truth in one small JSON text: stones per frame, hits and cameras."""
    stones = {
        str(name): {
            "visible": rows["visible"].round(2).tolist(),
            **{c: rows[c].round(5).tolist() for c in ("x", "y", "theta", "vx", "vy", "omega")},
        }
        for name, rows in truth.tracks.groupby("stone")
    }
    hits = [
        {
            "t": round(h.t, 5),
            "stones": list(h.stones),
            "normal": [round(n, 5) for n in h.normal],
            "restitution": h.restitution,
            "before": [[round(v, 5) for v in s] for s in h.before],
            "after": [[round(v, 5) for v in s] for s in h.after],
        }
        for h in truth.hits
    ]
    frames = truth.camera.drop(columns=["frame", "t", "main"])
    what = {
        "note": "Rendered, not filmed: the truth of sample.mp4. SI units; theta points from "
        "the centre to the handle's free end; before and after are (vx, vy, omega) of each stone.",
        "fps": truth.fps,
        "size": list(truth.size),
        "friction": truth.friction,
        "hits": hits,
        "t": truth.camera["t"].round(6).tolist(),
        "stones": stones,
        "camera": {c: [float(f"{v:.9g}") for v in frames[c]] for c in frames},
    }
    return json.dumps(what, separators=(",", ":")) + "\n"


def main() -> None:
    """Render the clip and write its truth."""
    folder = Path(__file__).resolve().parents[1] / "data"
    with tempfile.TemporaryDirectory(dir=folder) as scratch:
        fresh = Path(scratch) / "sample.mp4"
        truth = render_clip(
            sample_scene(), sample_camera(), fresh,
            fps=FPS, duration=DURATION, crf=CRF, shutter=SHUTTER,
        )  # fmt: skip
        fresh.replace(folder / "sample.mp4")
    (folder / "sample.truth.json").write_text(truth_as_json(truth), encoding="utf-8")


if __name__ == "__main__":
    main()
