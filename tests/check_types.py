"""Check the types of the whole package: ``python tests/check_types.py``.

The tree is the package ``curlshot``, whatever its folder is called. So mypy is led to it through a
link of that name.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "curlshot").symlink_to(ROOT, target_is_directory=True)
        command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml")]
        cache = ["--cache-dir", str(ROOT / ".mypy_cache")]
        done = subprocess.run(
            [*command, *cache], cwd=folder, env={**os.environ, "MYPYPATH": folder}, check=False
        )
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
