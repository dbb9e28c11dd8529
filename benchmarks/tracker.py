"""How long large exports of Tracker take to read, beside pandas on the same numbers.

Run ``python -m benchmarks.tracker``: CPU time, the best of three.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from curlshot.data.tracker import read_table

ROWS = 100_000


def exports(folder: Path) -> dict[str, tuple[Path, str, str, int]]:
    """Write exports; each with its delimiter, decimal sign and lines above the numbers."""
    t = np.arange(ROWS) / 1000
    one = folder / "one.txt"
    one.write_text(
        "\tpuck\t\t\t\t\t\nt\tx\ty\tvx\tvy\tframe\t\n"
        + "".join(
            f"{v:.6E}\t{np.sin(v):.6E}\t{np.cos(v):.6E}\t\t1.5E0\t{k}\n" for k, v in enumerate(t)
        )
    )
    two = folder / "two.txt"
    two.write_text(
        "#multi:\n;puck;;other;;\nt;x;y;x;y;\n"
        + "".join(
            f"{v:.3f};{np.sin(v):.3f};{np.cos(v):.3f};{np.cos(v):.6E};{np.sin(v):.3f}\n".replace(
                ".", ","
            )
            for v in t
        )
    )
    return {
        "one track, tabs": (one, "\t", ".", 2),
        "two tracks, decimal commas": (two, ";", ",", 3),
    }


def cpu(work: Callable[[], object]) -> float:
    """CPU time, s, the best of three."""
    spent = []
    for _ in range(3):
        start = time.process_time()
        work()
        spent.append(time.process_time() - start)
    return min(spent)


def main() -> None:
    """Print one line per export."""
    print(f"{ROWS} rows{'':27}curlshot  pandas.read_csv")
    with tempfile.TemporaryDirectory() as folder:
        for name, (path, delimiter, decimal, above) in exports(Path(folder)).items():
            ours = cpu(partial(read_table, [path]))
            bare = cpu(
                partial(
                    pd.read_csv, path, sep=delimiter, decimal=decimal, skiprows=above, header=None
                )
            )
            print(f"{name:38}{ours:6.2f} s  {bare:6.2f} s")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__).parse_args()
    main()
