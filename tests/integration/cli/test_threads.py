from __future__ import annotations

import os
import subprocess
import sys

from curlshot.cli.threads import LIMITS


def test_libraries_are_kept_to_one_thread() -> None:
    clean = {name: value for name, value in os.environ.items() if name not in LIMITS}
    code = "import curlshot.cli.threads as threads; threads.use_one_thread(); import cv2; "
    code += "print(cv2.getNumThreads())"
    told = subprocess.run([sys.executable, "-c", code], env=clean, capture_output=True, check=True)
    assert told.stdout.split() == [b"1"]
