from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest

from curlshot import pipeline
from curlshot.cli.main import main
from curlshot.config import Config
from curlshot.data.errors import CurlshotError, InputError
from curlshot.data.files import staged
from curlshot.data.inputs import find_inputs
from curlshot.data.results_file import read_results
from curlshot.data.tracks import MEASURED_AS, TRACK_COLUMNS
from curlshot.outcome import Run
from curlshot.report.summary import summary
from curlshot.synthetic.scoring import read_truth, score_tracks
from curlshot.synthetic.video import write_video
from curlshot.vision.video.reader import open_video

SAMPLE = pipeline.sample_clip()
CONTRACT = {
    "tracks.csv",
    "camera.csv",
    "results.json",
    "simulation.csv",
    "ensemble.json",
    "report.html",
    "figures",
    "tables",
    "overlay.mp4",
}
SHOT = """
[[stone]]
name = "A"
x = 0.0
y = 0.0
vx = 0.0
vy = 2.4
omega = 1.5707963267948966
"""


def curlshot(
    *words: str | Path, cwd: Path | None = None, env: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-W", "error", "-m", "curlshot", *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
        cwd=cwd,
        env={**os.environ, **(env or {})},
    )


def in_python(code: str) -> subprocess.CompletedProcess[str]:
    """Run some code in an interpreter of its own, which must end well."""
    return subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
    )


def test_sample_is_measured_to_the_bars(sample: Run) -> None:
    truth = read_truth(SAMPLE)
    score = score_tracks(sample.tracks, truth.stones)
    assert score.missed == ()
    assert score.switches == 0
    assert score.false_tracks == ()
    assert score.rmse < 0.020
    e, mu = sample.results.restitution, sample.results.friction
    assert e.value == pytest.approx(truth.restitution, abs=0.03)
    assert mu.value == pytest.approx(truth.friction, rel=0.10)
    assert e.stderr is not None and mu.stderr is not None
    assert abs(e.value - truth.restitution) < 4 * e.stderr
    assert abs(mu.value - truth.friction) < 4 * mu.stderr


def test_a_clip_told_at_another_rate_tells_what_it_tells_at_its_own(
    sample: Run, tmp_path: Path
) -> None:
    pictures = [frame.image for frame in islice(open_video([SAMPLE]), 76)]
    # 25 a second told as 30: five pictures in six frames.
    thirty = [(k / 30, pictures[5 * k // 6]) for k in range(90)]
    write_video(tmp_path / "thirty.mp4", thirty, fps=30.0)
    run = pipeline.run([tmp_path / "thirty.mp4"])
    hits, known = run.results.collisions, sample.results.collisions
    assert [hit.stones for hit in hits] == [("A", "B"), ("B", "C")]
    for hit, other in zip(hits, known, strict=True):
        assert hit.restitution == pytest.approx(other.restitution, abs=0.015)
        assert hit.stderr is not None and other.stderr is not None
        assert hit.stderr < 3 * other.stderr
    assert hits[1].t - hits[0].t == pytest.approx(known[1].t - known[0].t, abs=0.002)
    assert run.results.friction.value == pytest.approx(sample.results.friction.value, rel=0.03)
    assert len(run.results.warnings) == 1
    # All frames are in the tables, those that repeat as not seen, at times in their order.
    assert run.cameras["frame"].tolist() == [*range(90)]
    assert (run.cameras["t"].diff().iloc[1:] > 0).all()
    of_a = run.tracks[run.tracks["stone"] == "A"]
    assert of_a["frame"].tolist() == [*range(90)]
    assert set(of_a.loc[of_a["frame"] % 6 == 1, "seen"]) == {0}


def test_sample_names_stones_by_their_first_motion(sample: Run) -> None:
    assert [hit.stones for hit in sample.results.collisions] == [("A", "B"), ("B", "C")]


def test_run_writes_the_whole_contract(sample: Run) -> None:
    assert sample.out is not None
    assert {item.name for item in sample.out.iterdir()} == CONTRACT
    tracks = pd.read_csv(sample.out / "tracks.csv")
    assert tuple(tracks.columns) == (*TRACK_COLUMNS, *MEASURED_AS)
    simulation = pd.read_csv(sample.out / "simulation.csv")
    assert tuple(simulation.columns) == ("model", *TRACK_COLUMNS)
    assert set(simulation["model"]) == {"point-mass", "rigid-body", "frictional"}
    assert read_results(sample.out / "results.json") == sample.results
    raw = json.loads((sample.out / "results.json").read_text())
    assert raw["schema"] == 1
    assert raw["restitution"]["value"] == sample.results.restitution.value
    teams = raw["teams"]
    assert teams["A"] == teams["C"] == teams["D"] != teams["B"] == teams["E"] == teams["F"]
    assert dict(zip(tracks["stone"], tracks["team"], strict=True)) == teams


def test_tracks_come_back_to_the_same_physics(sample: Run) -> None:
    assert sample.out is not None
    again = pipeline.run([sample.out / "tracks.csv"])
    for name in ("restitution", "friction"):
        first, second = getattr(sample.results, name), getattr(again.results, name)
        assert second.value == pytest.approx(first.value, rel=1e-6)
        assert second.stderr == pytest.approx(first.stderr, rel=1e-3)
    assert len(again.results.collisions) == len(sample.results.collisions)
    assert again.cameras is None


def test_summary_says_what_a_person_asks(sample: Run) -> None:
    text = summary(sample.results, sample.tracks, sample.out)
    for word in ("stones", "A on B", "B on C", "e = ", "μ = ", "±", "report.html"):
        assert word in text
    lines = text.splitlines()
    said = [k for k, line in enumerate(lines) if line.startswith("predicted")]
    assert len(said) == 2
    for k in said:  # three stones, soon after the hit and at the end
        assert [line.count("(±") for line in lines[k + 1 : k + 3]] == [3, 3]
        # μ is told by the ice seen.
        assert "from before the first hit, e = 0.83 assumed:" in lines[k]


def test_single_picture_gives_positions_only(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capture = cv2.VideoCapture(str(SAMPLE))
    capture.set(cv2.CAP_PROP_POS_FRAMES, 0)
    ok, image = capture.read()
    capture.release()
    assert ok
    picture = tmp_path / "still.png"
    cv2.imwrite(str(picture), image)
    done = pipeline.run([picture], tmp_path / "out")
    truth = read_truth(SAMPLE).stones
    score = score_tracks(done.tracks, truth[truth["frame"] == 0])
    assert score.recall == 1
    assert score.rmse < 0.03
    assert done.tracks["vx"].isna().all()
    assert main(["simulate", str(tmp_path / "out")]) == 2
    assert "no shot to reconstruct" in capsys.readouterr().err
    assert done.results.restitution.value is None
    assert done.results.friction.value is None
    assert done.results.warnings


def test_folder_of_pictures_is_a_clip(tmp_path: Path) -> None:
    capture = cv2.VideoCapture(str(SAMPLE))
    for index in range(12):
        _, image = capture.read()
        cv2.imwrite(str(tmp_path / f"f{index}.png"), image)
    capture.release()
    measured = pipeline.measure([tmp_path], Config().replace(fps=25))
    assert measured.frames == 12
    assert measured.detections["t"].max() == pytest.approx(11 / 25)
    assert [p.name for p in measured.files[8:]] == ["f8.png", "f9.png", "f10.png", "f11.png"]


def test_a_glob_inside_a_folder_with_brackets_in_its_name(tmp_path: Path) -> None:
    folder = tmp_path / "shot [1]"
    folder.mkdir()
    for index in (10, 9):
        (folder / f"{index}.png").touch()
    found = find_inputs([folder / "*.png"])
    assert [path.name for path in found] == ["9.png", "10.png"]


def test_simulate_prints_and_writes(tmp_path: Path) -> None:
    shot = tmp_path / "SHOT.toml"
    shot.write_text(SHOT)
    done = curlshot("simulate", shot, "--json", "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    rest = json.loads(done.stdout)["stones"]["A"]
    # From an independent program: see the regression values of the ice law FCV1.
    assert rest["x"] == pytest.approx(-2.098, abs=0.002)
    assert rest["y"] == pytest.approx(38.232, abs=0.002)
    assert rest["t"] == pytest.approx(28.75, abs=0.01)
    table = pd.read_csv(tmp_path / "out" / "simulation.csv")
    assert table["t"].iloc[1] == pytest.approx(1 / 25)
    assert table["y"].iloc[-1] == pytest.approx(rest["y"], abs=1e-6)


def test_what_if_of_a_measured_shot(
    sample: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert sample.out is not None
    measured, out = str(sample.out / "results.json"), tmp_path / "out"
    words = ["simulate", measured, "-q", "-o", str(out)]
    assert main([*words, "--samples", "60"]) == 0
    text = capsys.readouterr().out
    for word in ("A on B", "A thrown 60 times", "in the house", "shot stone", "outcomes.csv"):
        assert word in text
    names = {"simulation.csv", "plan.png", "outcomes.csv", "whatif.json", "spread.png"}
    assert {item.name for item in out.iterdir()} == names
    outcomes = pd.read_csv(out / "outcomes.csv")
    assert outcomes["sample"].nunique() == 60
    assert set(outcomes["stone"]) == set("ABCDEF")
    as_it_was = json.loads((out / "whatif.json").read_text())
    assert as_it_was["thrown"] == "A" and as_it_was["samples"] == 60
    # Half a metre to its right it passes B and hits D; all is told as JSON.
    changes = ["--aim-offset", "-0.5", "--speed", "0.9x", "--restitution", "0.9"]
    changes += ["--friction", "0.012", "--spin=-0.5x", "--samples", "20", "--throw-sd", "0,0"]
    assert main([*words, *changes, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [hit["stones"] for hit in told["nominal"]["hits"]] == [["A", "D"]]
    assert told["stones"]["B"]["moved"] == 0
    assert told["changes"]["speed"] == {"value": 0.9, "relative": True}
    # What an earlier call left does not stay beside a shot without samples.
    assert main([*words, "--samples", "0"]) == 0
    assert {item.name for item in out.iterdir()} == {"simulation.csv", "plan.png"}
    assert main(["simulate", measured, "-o", str(sample.out)]) == 2
    assert "holds the run itself" in capsys.readouterr().err


def test_what_if_of_a_written_shot(tmp_path: Path) -> None:
    shot, out = tmp_path / "SHOT.toml", tmp_path / "out"
    shot.write_text(SHOT)
    assert main(["simulate", str(shot), "-o", str(out), "--samples", "200"]) == 0
    outcomes = pd.read_csv(out / "outcomes.csv")
    assert outcomes["y"].mean() == pytest.approx(38.232, abs=0.1)
    assert 0.1 < outcomes["y"].std() < 0.5


def test_help_has_examples_everywhere() -> None:
    for words in (
        ["--help"],
        *([name, "--help"] for name in ("run", "track", "estimate", "simulate")),
    ):
        done = curlshot(*words)
        assert done.returncode == 0
        assert "example" in done.stdout


def test_help_goes_into_a_file_without_greek_letters() -> None:
    done = curlshot("run", "--help", env={"PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0
    assert "e, mu, simulation" in done.stdout


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys, pipeline\npipeline.command_line('').format_help()\nprint(sorted(sys.modules))"
    )
    done = in_python(code)
    for heavy in ("numpy", "pandas", "cv2", "scipy", "matplotlib", "av", "multiprocessing"):
        assert f"'{heavy}'" not in done.stdout


def bad_inputs(folder: Path) -> dict[str, list[str | Path]]:
    (folder / "empty.mp4").touch()
    (folder / "text.mp4").write_text("this is no film\n" * 100)
    (folder / "column.csv").write_text("t\n1\n2\n3\n")
    (folder / "nan.csv").write_text("stone,t,x,y\nA,0,nan,nan\nA,1,nan,nan\n")
    (folder / "back.csv").write_text("stone,t,x,y\nA,0,0,0\nA,0.2,0,1\nA,0.1,0,2\n")
    (folder / "twice.csv").write_text("stone,t,x,y\nA,0,0,0\nA,0,1,1\nA,1,0,0\nA,1,1,1\n")
    (folder / "empty folder").mkdir()
    (folder / "bad.toml").write_text("[[stone]]\nname = 'A'\n")
    grey = np.full((240, 320, 3), 128, np.uint8)
    (folder / "ice").mkdir()
    for index in range(3):
        cv2.imwrite(str(folder / "ice" / f"{index}.png"), grey)
    (folder / "late.csv").write_text("stone,t,x,y\nA,0,0,0\nA,1e300,0,1\nA,2e300,0,2\n")
    (folder / "good.csv").write_text("stone,t,x,y\nA,0,0,0\nB,0,1,1\nA,1,0,0\nB,1,1,1\n")
    (folder / "good.toml").write_text(SHOT)
    (folder / "alone.json").write_text("{}")
    still: list[str | Path] = ["run", folder / "ice"]
    return {
        "missing": ["run", folder / "none.mp4"],
        "empty": ["run", folder / "empty.mp4"],
        "text": ["run", folder / "text.mp4"],
        "one column": ["run", folder / "column.csv"],
        "nan": ["run", folder / "nan.csv"],
        "time goes back": ["run", folder / "back.csv"],
        "two of one name": ["run", folder / "twice.csv"],
        "empty folder": ["run", folder / "empty folder"],
        "no house": ["run", folder / "ice"],
        "mixed": ["run", folder / "back.csv", folder / "text.mp4"],
        "estimate a clip": ["estimate", folder / "text.mp4"],
        "track a table": ["track", folder / "back.csv"],
        "bad shot": ["simulate", folder / "bad.toml"],
        "bad stick": ["run", folder / "ice", "--stick", "1,2,3"],
        "bad house": [*still, "--house", "160,120,200"],
        "house of no frame": [*still, "--house", "7:160,120,200,120,160,80"],
        "house like a line": [*still, "--house", "160,120,200,120,160,119"],
        "no camera": [*still, "--camera", folder / "none.csv"],
        "camera of a table": [*still, "--camera", folder / "good.csv"],
        "two cameras": [
            *still,
            "--stick",
            "1,2,3,4,5",
            "--house",
            "160,120,200,120,160,80",
        ],
        "bad frames": ["run", folder / "ice", "--frames", "x"],
        "no frames left": ["run", folder / "ice", "--frames", "9:"],
        "time without end": ["run", folder / "late.csv"],
        "mass of nobody": ["run", folder / "good.csv", "--mass", "Q=1"],
        "mass of some": ["run", folder / "good.csv", "--mass", "A=1"],
        "discs like dots": [*still, "--stick", "10,10,110,10,1", "--radius", "1e-9"],
        "a diameter": [*still, "--radius", "0.291"],
        "discs like moons": [*still, "--stick", "10,10,110,10,1", "--radius", "1e9"],
        "half a run": ["simulate", folder / "alone.json"],
        "no number": ["simulate", folder / "good.toml", "--speed", "fast"],
        "no speed": ["simulate", folder / "good.toml", "--speed", "0"],
        "no restitution": ["simulate", folder / "good.toml", "--restitution", "1.2"],
        "not used for friction": ["simulate", folder / "good.toml", "--friction", "nan"],
        "no aim": ["simulate", folder / "good.toml", "--aim-offset", "left"],
        "no spin": ["simulate", folder / "good.toml", "--spin", "1y"],
        "no samples": ["simulate", folder / "good.toml", "--samples", "1e9"],
        "no throw": ["simulate", folder / "good.toml", "--throw-sd", "0.1"],
        "endless samples": ["simulate", folder / "good.toml", "--fps", "1e12"],
        "no command": [],
        "unknown option": ["run", "--what"],
    }


def test_mistakes_end_in_one_line_and_exit_code_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    places = tmp_path / "in"
    places.mkdir()
    for name, words in bad_inputs(places).items():
        out = tmp_path / "out"
        extra = ["-o", str(out)] if words and words[0] in ("run", "estimate", "track") else []
        try:
            code = main([*map(str, words), *extra])
        except SystemExit as exit_:  # argparse leaves by itself
            code = int(exit_.code or 0)
        said = capsys.readouterr()
        assert code == 2, name
        lines = [line for line in said.err.splitlines() if "curlshot" in line]
        assert len(lines) == 1, (name, said.err)
        assert "Traceback" not in said.err, name
        assert not out.exists(), name
        assert [item.name for item in tmp_path.iterdir()] == ["in"], name


def test_a_house_or_a_camera_may_be_given(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    common = [str(SAMPLE), "--frames", "0:8", "-q", "-o"]
    # The tee and two points of the 12-ft ring, some pixels beside their true places.
    house = "4:631,529,902,536,632,263"
    assert main(["track", *common, str(tmp_path / "one"), "--house", house]) == 0
    table = tmp_path / "one" / "camera.csv"
    assert main(["track", *common, str(tmp_path / "two"), "--camera", str(table)]) == 0
    assert "do not include that of the given camera" in capsys.readouterr().out
    one, two = (pd.read_csv(tmp_path / name / "tracks.csv") for name in ("one", "two"))
    assert len(one) == len(two) and one["frame"].nunique() == 9
    # The one's stones were measured while its cameras were provisional.
    np.testing.assert_allclose(one[["x", "y"]], two[["x", "y"]], atol=1e-3)
    assert main(["check", *common, str(tmp_path / "see"), "--camera", str(table)]) == 0
    assert (tmp_path / "see" / "check.png").exists()


def test_out_that_is_a_file_is_refused_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("here already")
    with pytest.raises(InputError, match="folder"):
        pipeline.run([SAMPLE], tmp_path / "out")
    assert (tmp_path / "out").read_text() == "here already"


def test_failed_run_leaves_earlier_results_alone(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "results.json").write_text("earlier")

    def fail(stage: Path) -> None:
        (stage / "results.json").write_text("half")
        raise CurlshotError("the disc is full")

    with pytest.raises(CurlshotError), staged(folder) as stage:
        fail(stage)
    assert (folder / "results.json").read_text() == "earlier"
    assert [item.name for item in tmp_path.iterdir()] == ["out"]


def test_truncated_clip_is_used_as_far_as_it_goes(tmp_path: Path) -> None:
    cut = tmp_path / "cut.mp4"
    shutil.copy(SAMPLE, cut)
    with cut.open("r+b") as file:
        file.truncate(int(SAMPLE.stat().st_size * 0.5))
    measured = pipeline.measure([cut])
    assert 10 < measured.frames < pipeline.measure([SAMPLE]).frames
    assert any("ends after" in text for text in measured.warnings)


def test_pucks_from_a_stick(shared: Path) -> None:
    clip = shared / "clips" / "collision-pucks.mp4"
    settings = Config().replace(
        frames=(2, 31), stick=(20.0, 35.6, 20.0, 219.6, 0.5), radius=0.0465, overlay=False
    )
    done = pipeline.run([clip], config=settings)
    assert done.tracks["stone"].nunique() == 2
    (hit,) = done.results.collisions
    assert hit.restitution is not None and hit.stderr is not None
    assert 0.5 < hit.restitution < 1.05
    assert hit.momentum_residual is not None and hit.momentum_residual < 0.15
    assert done.tracks.groupby("stone")["omega"].count().min() > 20


def test_masses_reach_estimate_and_simulation(tmp_path: Path) -> None:
    (tmp_path / "hit.csv").write_text(central_hit(masses=(1.0, 2.0), restitution=0.8))
    settings = Config().replace(masses={"A": 1.0, "B": 2.0})
    done = pipeline.run([tmp_path / "hit.csv"], config=settings)
    assert done.results.restitution.value == pytest.approx(0.8, abs=0.02)
    (hit,) = done.results.collisions
    assert hit.momentum_residual is not None and hit.momentum_residual < 0.02
    score = done.results.simulations["point-mass"]
    assert score.rmse is not None and score.rmse < 0.02


def central_hit(masses: tuple[float, float], restitution: float) -> str:
    """A at 1.5 m/s into B at rest, on ice without friction, as a table."""
    (a, b), speed, gap = masses, 1.5, 0.6
    after_b = a * (1 + restitution) * speed / (a + b)
    after_a = after_b - restitution * speed
    rows = ["stone,t,x,y"]
    rng = np.random.default_rng(0)
    for t in np.arange(60) / 30:
        since = max(0.0, t - gap / speed)
        y_a = -0.291 - gap + speed * min(t, gap / speed) + after_a * since
        for name, y in (("A", y_a), ("B", after_b * since)):
            x, y = rng.normal((0.0, y), 0.0005)
            rows.append(f"{name},{t:.6f},{x:.6f},{y:.6f}")
    return "\n".join(rows)


def test_files_of_an_earlier_run_do_not_stay_beside_the_new(tmp_path: Path) -> None:
    (tmp_path / "hit.csv").write_text(central_hit(masses=(1.0, 1.0), restitution=0.8))
    out = tmp_path / "out"
    (out / "figures").mkdir(parents=True)
    for name in ("camera.csv", "overlay.mp4", "figures/motion_Z.png", "notes.txt"):
        (out / name).write_text("earlier")
    steps: list[str] = []
    pipeline.run([tmp_path / "hit.csv"], out, progress=lambda what, *_: steps.append(what))
    assert steps == ["physics", "physics", "report", "report"]
    left = {item.name for item in out.iterdir()}
    assert left == CONTRACT - {"camera.csv", "overlay.mp4"} | {"notes.txt"}
    assert not (out / "figures" / "motion_Z.png").exists()


def test_summary_tells_what_moved_without_a_hit(tmp_path: Path) -> None:
    rows = [f"A,{t / 10:.1f},{np.cos(t / 5):.4f},{np.sin(t / 5):.4f}" for t in range(30)]
    (tmp_path / "round.csv").write_text("\n".join(["stone,t,x,y", *rows]))
    done = pipeline.run([tmp_path / "round.csv"])
    assert "moved: A" in summary(done.results, done.tracks)


def test_a_terminal_without_greek_letters_gets_its_answer(tmp_path: Path) -> None:
    (tmp_path / "hit.csv").write_text(central_hit(masses=(1.0, 1.0), restitution=0.8))
    done = curlshot(
        "estimate", tmp_path / "hit.csv", "-o", tmp_path / "out", env={"PYTHONIOENCODING": "ascii"}
    )
    assert done.returncode == 0, done.stderr
    assert "restitution e = " in done.stdout


def test_a_clip_is_tracked_without_what_takes_long_to_load(tmp_path: Path) -> None:
    clip = str(pipeline.sample_clip())
    code = (
        "import sys\nfrom curlshot import pipeline\n"
        f"main(['track', {clip!r}, '--frames', '0:9', '-q', '-o', {str(tmp_path)!r}])\n"
        "print({'pandas', 'scipy', 'filterpy', 'matplotlib'} & sys.modules.keys() or 'none')"
    )
    done = in_python(code)
    assert done.stdout.splitlines()[-1] == "none"
    assert (tmp_path / "tracks.csv").exists()


def test_tracks_from_a_table_never_load_opencv(tmp_path: Path) -> None:
    (tmp_path / "hit.csv").write_text(central_hit(masses=(1.0, 1.0), restitution=0.8))
    code = (
        "import sys\nfrom curlshot import pipeline\n"
        f"pipeline.run([{str(tmp_path / 'hit.csv')!r}], {str(tmp_path / 'out')!r})\n"
        "print('cv2' in sys.modules)"
    )
    done = in_python(code)
    assert (done.stdout, done.stderr) == ("False\n", "")


def test_a_restitution_of_nothing_is_told_as_a_change(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shot, out = tmp_path / "shot.toml", tmp_path / "out"
    shot.write_text('[[stone]]\nname = "A"\nx = 0\ny = -3\nvy = 2\n')
    words = ["simulate", str(shot), "-o", str(out), "--samples", "3", "--json", "--restitution"]
    assert main([*words, "0"]) == 0
    assert json.loads(capsys.readouterr().out)["changes"] == {"restitution": 0.0}


def test_convert_does_not_write_over_its_input(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, folder = tmp_path / "a.csv", tmp_path / "b.csv"
    table.write_text("stone,t,x,y\nA,0,0,0\nA,0.04,0.1,0\n")
    before = table.read_bytes()
    folder.mkdir()
    for out, why in ((table, "is the file to convert"), (folder, "is a folder")):
        assert main(["convert", str(table), str(out)]) == 2
        assert f"{out}: {why}" in capsys.readouterr().err
    assert main(["convert", str(table), str(table / "c.csv")]) == 2
    refusal = capsys.readouterr().err
    assert f"{table}: is a file" in refusal
    assert "-o" not in refusal.split("; ")[-1]  # convert knows no -o
    assert table.read_bytes() == before
