"""Run benchmarks, store their figures, and compare two records.

    python -m benchmarks.record run "camera --size 720" stills frames shots variants cost
    python -m benchmarks.record compare benchmarks/history/A.json benchmarks/history/B.json

A name may be followed by the options of its benchmark. A record is one JSON file in
``benchmarks/history``, named by date and commit. It holds the machine, and of each benchmark the
lines that it printed and how long it took. Figures are the numbers in these lines, by the words
before the first of them.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from curlshot.data.files import write_text

ROOT = Path(__file__).resolve().parents[1]
HISTORY = Path(__file__).resolve().parent / "history"
NUMBER = re.compile(r"(?<![\w.])[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
CHANGED = 0.2
"""Part of itself by which a figure must change to be listed."""


def machine() -> dict[str, Any]:
    """Return what of the machine the figures depend on."""
    names = ("numpy", "scipy", "pandas", "opencv-python-headless", "av")
    code = f"import importlib.metadata as m; print(*(m.version(n) for n in {names}))"
    versions = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    processor = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        found = re.search(r"model name\s*: (.*)", cpuinfo.read_text(encoding="utf-8"))
        processor = found[1] if found else processor
    return {
        "system": platform.system(),
        "processor": processor,
        "processors": os.cpu_count(),
        "python": platform.python_version(),
        **dict(zip(names, versions, strict=True)),
    }


def commit() -> str:
    """Return the commit of the checkout, with a + where files differ from it."""
    git = ["git", "-C", str(ROOT)]
    name = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    changes = subprocess.run([*git, "status", "--porcelain"], capture_output=True, text=True)
    return name.stdout.strip() + ("+" if changes.stdout.strip() else "")


def measured(name: str, words: Sequence[str] = ()) -> dict[str, Any]:
    """Run one benchmark and return its lines and times."""
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-m", f"benchmarks.{name}", *words],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode not in (0, 1):  # 1: a figure misses its bar
        raise SystemExit(f"{name}: exit code {done.returncode}\n{done.stderr}")
    taken = round(time.monotonic() - began, 1)
    return {"words": list(words), "wall_s": taken, "lines": done.stdout.splitlines()}


def figures(lines: Sequence[str]) -> Iterator[tuple[str, list[float]]]:
    """Yield the numbers of each line, by the words before the first of them."""
    seen: dict[str, int] = {}
    for line in lines:
        found = [*NUMBER.finditer(line)]
        if found and not line.startswith("/"):
            label = " ".join(line[: found[0].start()].split())
            seen[label] = seen.get(label, 0) + 1
            numbers = [float(one[0].replace("−", "-")) for one in found]
            yield f"{label} #{seen[label]}" if seen[label] > 1 else label, numbers


def compare(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """Return a line for each figure that changed by more than `CHANGED` of itself."""
    lines = []
    for name in before["benchmarks"].keys() & after["benchmarks"].keys():
        old, new = (dict(figures(one["benchmarks"][name]["lines"])) for one in (before, after))
        lines += [f"{name}: {label}: only before" for label in old.keys() - new.keys()]
        for label, numbers in new.items():
            past = old.get(label)
            if past is None:
                lines.append(f"{name}: {label}: only after")
            elif len(past) != len(numbers) or any(
                abs(b - a) > CHANGED * abs(a) for a, b in zip(past, numbers, strict=True)
            ):
                lines.append(f"{name}: {label}: {past} -> {numbers}")
    return sorted(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    kinds = parser.add_subparsers(dest="kind", required=True)
    run = kinds.add_parser("run", help="run benchmarks and store a record")
    run.add_argument("names", nargs="+")
    run.add_argument("--out", type=Path, help="file to write, instead of one in the history")
    both = kinds.add_parser("compare", help="list what changed between two records")
    both.add_argument("before", type=Path)
    both.add_argument("after", type=Path)
    arguments = parser.parse_args()
    if arguments.kind == "compare":
        records = [json.loads(path.read_text("utf-8"))
                   for path in (arguments.before, arguments.after)]  # fmt: skip
        print("\n".join(compare(*records)) or "no figure changed")
        return
    date = datetime.now(UTC).date().isoformat()
    record = {"date": date, "commit": commit(), "machine": machine(), "benchmarks": {}}
    for name, *words in map(str.split, arguments.names):
        record["benchmarks"][name] = measured(name, words)
        print(f"{name}: {record['benchmarks'][name]['wall_s']} s", flush=True)
    path = arguments.out or HISTORY / f"{date}-{record['commit']}.json"
    write_text(path, json.dumps(record, indent=1, ensure_ascii=False) + "\n")
    print(path)


if __name__ == "__main__":
    main()
