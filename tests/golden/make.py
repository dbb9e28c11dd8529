"""Make golden runs: their inputs, and what a command makes of them.

    python tests/golden/make.py inputs FOLDER
    python tests/golden/make.py outputs INPUTS OUT [--command CURLSHOT] [--only NAME ...]
    python tests/golden/make.py renew [NAME ...]

`inputs` renders and writes what the runs read. `outputs` runs a command on it, by default
``curlshot``; so two environments are compared on the same inputs (`tests/golden/compare.py`).
`renew` writes again what ``pytest -m golden`` compares with.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

from curlshot.tests.golden.cases import SAMPLE, SHARED, SHOTS, Case, all_cases, shared_tables
from curlshot.tests.golden.clips import CLIPS
from curlshot.tests.golden.tables import WRITERS

KEPT = (
    "results.json", "tracks.csv", "camera.csv", "simulation.csv", "outcomes.csv", "whatif.json",
    "season.json", "shots.csv", "hits.csv",
)  # fmt: skip
"""Files of an output that are compared."""

SAID, ENDED = "stdout.txt", "ended.json"
"""What the commands of a case printed, and their exit codes and errors."""

AT_ONCE = 2
LONGEST = 900
"""Commands at once, and seconds that one may take."""


def write_inputs(folder: Path) -> None:
    """Render clips and write tables, shots and the folder of an earlier run."""
    from curlshot import pipeline

    folder.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(pipeline.sample_clip(), folder / f"{SAMPLE}.mp4")
    for name, write in WRITERS.items():
        target = folder / "tables" / name
        target.mkdir(parents=True, exist_ok=True)
        write(target)
    (folder / "shots").mkdir(exist_ok=True)
    for name, (text, _) in SHOTS.items():
        (folder / "shots" / f"{name}.toml").write_text(text, encoding="utf-8")
    with ProcessPoolExecutor(AT_ONCE) as pool:
        for name, clip in zip(CLIPS, pool.map(_rendered, CLIPS), strict=True):
            shutil.copyfile(clip, folder / f"{name}.mp4")
    _write_pictures(folder / "fixed.mp4", folder / "pictures")
    pipeline.run(folder / f"{SAMPLE}.mp4", folder / "earlier" / SAMPLE, overlay=False)


def _rendered(name: str) -> Path:
    return CLIPS[name]().render()


def _write_pictures(clip: Path, folder: Path) -> None:
    import av
    from PIL import Image

    folder.mkdir(exist_ok=True)
    with av.open(str(clip)) as container:
        for number, frame in enumerate(container.decode(video=0)):
            if number % 2 == 0:
                image = Image.fromarray(frame.to_ndarray(format="rgb24"))
                image.save(folder / f"{number // 2:04d}.png")


def write_outputs(inputs: Path, out: Path, command: str, only: Sequence[str]) -> list[str]:
    """Run the command on all cases, or those named, and return the names of those that failed."""
    cases = {case.name: case for case in all_cases(inputs)}
    unknown = set(only) - set(cases)
    if unknown:
        raise SystemExit(f"no case {', '.join(sorted(unknown))}; there is {', '.join(cases)}")
    wanted = [*(only or cases)]
    needed = {need for name in wanted for need in cases[name].needs}
    first = [name for name in cases if name in wanted or name in needed]
    first, last = (
        [name for name in first if bool(cases[name].needs) == dependent]
        for dependent in (False, True)
    )
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        folders = {"inputs": str(inputs), "out": scratch, "shared": str(SHARED)}
        with ThreadPoolExecutor(AT_ONCE) as pool:
            ended = {}
            for names in (first, last):
                runs = pool.map(lambda name: _run(cases[name], command, folders), names)
                for name, codes in zip(names, runs, strict=True):
                    ended[name] = codes
                    print(f"{name}: {' '.join(map(str, codes))}", flush=True)
        for name in wanted:
            _keep(Path(scratch) / name, out / name)
    return [name for name in wanted if any(ended[name])]


def _run(case: Case, command: str, folders: dict[str, str]) -> list[int]:
    """Run the commands of a case and return their exit codes."""
    folder = Path(folders["out"]) / case.name
    folder.mkdir(parents=True)
    said, ended = [], []
    for words in case.commands:
        filled = [word.format(**folders) for word in words]
        try:
            done = subprocess.run(
                [command, *filled], capture_output=True, text=True, check=False, timeout=LONGEST,
                cwd=folders["out"],
            )  # fmt: skip
            code, printed, errors = done.returncode, done.stdout, done.stderr.strip()
        except subprocess.TimeoutExpired:
            code, printed, errors = -1, "", f"not done in {LONGEST} s"
        said.append(printed)
        lines = errors.replace(folders["out"], "OUT").splitlines() if code else []
        ended.append({"exit": code, "error": lines[-1] if lines else ""})
    text = "".join(said).replace(folders["out"], "OUT").replace(folders["inputs"], "INPUTS")
    (folder / SAID).write_text(text, encoding="utf-8")
    (folder / ENDED).write_text(json.dumps(ended, indent=1) + "\n", encoding="utf-8")
    return [int(str(one["exit"])) for one in ended]


def _keep(made: Path, kept: Path) -> None:
    """Copy what is compared of an output."""
    shutil.rmtree(kept, ignore_errors=True)
    kept.mkdir(parents=True)
    for name in (*KEPT, SAID, ENDED):
        if (made / name).exists():
            shutil.copyfile(made / name, kept / name)


def renew(names: Sequence[str]) -> None:
    """Store the cases named, or all that are there."""
    from curlshot.tests.golden import stored

    every = [*stored.names(), *shared_tables()]
    unknown = set(names) - set(every)
    if unknown:
        raise SystemExit(f"no case {', '.join(sorted(unknown))}; there is {', '.join(every)}")
    with ProcessPoolExecutor(AT_ONCE) as pool:
        wanted = names or every
        for name, size in zip(wanted, pool.map(stored.renew, wanted), strict=True):
            print(f"{name}: {size} bytes", flush=True)


def main() -> int:
    """Make inputs, outputs or the stored runs."""
    parser = argparse.ArgumentParser(description="Make golden runs.")
    tasks = parser.add_subparsers(dest="task", required=True)
    inputs = tasks.add_parser("inputs", help="write all inputs")
    inputs.add_argument("folder", type=Path)
    outputs = tasks.add_parser("outputs", help="run a command on the inputs")
    outputs.add_argument("inputs", type=Path)
    outputs.add_argument("out", type=Path)
    outputs.add_argument("--command", default="curlshot", help="the program to run")
    outputs.add_argument("--only", nargs="+", default=[], metavar="NAME", help="cases to run")
    renewed = tasks.add_parser("renew", help="write again what the tests compare with")
    renewed.add_argument("names", nargs="*", metavar="NAME", help="cases; all of them if none")
    given = parser.parse_args()
    if given.task == "renew":
        renew(given.names)
        return 0
    if given.task == "inputs":
        write_inputs(given.folder.resolve())
        return 0
    failed = write_outputs(given.inputs.resolve(), given.out.resolve(), given.command, given.only)
    print(f"exit codes other than 0: {', '.join(failed) or 'none'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
