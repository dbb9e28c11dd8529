from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from curlshot import pipeline
from curlshot.cli.main import main


def _tab(name: str, columns: dict[str, np.ndarray]) -> str:
    """Tracker 6, full precision, tabs."""
    head = f"\t{name}" + "\t" * (len(columns) - 1) + "\nt\t" + "\t".join(list(columns)[1:]) + "\t\n"
    return head + "".join(
        "\t".join(f"{v:.6E}" for v in row) + "\n" for row in np.column_stack(list(columns.values()))
    )


def _swedish(name: str, columns: dict[str, np.ndarray]) -> str:
    """The same with semicolons and Swedish numbers."""
    plain = _tab(name, columns).replace("\t", ";").split("\n", 2)
    body = plain[2].replace(".", ",").replace("E+", "×10^").replace("E", "×10^")
    return "\n".join([*plain[:2], body.replace("-", "\N{MINUS SIGN}")])


def _legacy(name: str, columns: dict[str, np.ndarray]) -> str:
    """Tracker 4 and 5, commas."""
    head = name.replace(" ", "_") + "\n" + ",".join(columns) + "\n"
    return head + "".join(
        ",".join(f"{v:.9E}" for v in row) + "\n" for row in np.column_stack(list(columns.values()))
    )


def test_the_road_of_the_paper_from_text_files_alone(tmp_path: Path) -> None:
    truth = json.loads((pipeline.sample_clip().parent / "sample.truth.json").read_text("utf-8"))
    t = np.array(truth["t"])
    rng = np.random.default_rng(1)
    places, angles, names = [], [], []
    for stone, write in zip("ABC", (_tab, _swedish, _legacy), strict=True):
        track = truth["stones"][stone]
        seen = np.array(track["visible"]) > 0.9
        x, y, theta = (np.array(track[key], float)[seen] for key in ("x", "y", "theta"))
        x, y = (v + rng.normal(0, 2e-3, v.shape) for v in (x, y))
        edge = theta + rng.normal(0, 0.02, theta.shape)
        edge -= 2 * np.pi * np.round(edge[0] / (2 * np.pi))  # begins within half a turn
        name = f"mass {stone}"
        path = tmp_path / f"{stone}.txt"
        path.write_text(write(name, {"t": t[seen], "x": x, "y": y}), encoding="utf-8")
        places.append(str(path))
        columns = {"t": t[seen], "θ": np.degrees(edge)}
        if stone != "A":
            columns |= {"x": 0.14 * np.cos(edge), "y": 0.14 * np.sin(edge)}
        angle = tmp_path / f"{stone}_angle.txt"
        angle.write_text(write(f"edge {stone}", columns), encoding="utf-8")
        angles += ["--angles", f"{stone}={angle}"]
        names += ["--names", f"{stone}={name.replace(' ', '_') if stone == 'C' else name}"]
    out = tmp_path / "out"
    done = main(["run", *places, *angles, *names, "-o", str(out), "-q"])
    assert done == 0
    results = json.loads((out / "results.json").read_text("utf-8"))
    for key, true in (("restitution", 0.8345), ("friction", truth["friction"])):
        assert abs(results[key]["value"] - true) < 3 * results[key]["stderr"]
    assert results["restitution"]["stderr"] < 0.03
    for hit, true in zip(results["collisions"], truth["hits"], strict=True):
        assert hit["stones"] == true["stones"]
        for when in ("before", "after"):
            for stone, (_, _, omega) in zip(true["stones"], true[when], strict=True):
                assert abs(hit[when][stone]["omega"] - omega) < 0.1
    assert (out / "report.html").stat().st_size > 10_000
    assert len(list((out / "figures").glob("*.png"))) >= 3
