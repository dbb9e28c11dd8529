from __future__ import annotations

import os
import subprocess
import sys

import pytest

from curlshot.cli.threads import LIMITS, use_one_thread


def test_what_a_person_has_set_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in LIMITS:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    use_one_thread()
    assert {name: os.environ[name] for name in LIMITS} == dict.fromkeys(LIMITS, "1") | {
        "OMP_NUM_THREADS": "3"
    }


def test_libraries_are_kept_to_one_thread() -> None:
    clean = {name: value for name, value in os.environ.items() if name not in LIMITS}
    code = "import curlshot.cli.threads as threads; threads.use_one_thread(); import cv2; "
    code += "print(cv2.getNumThreads())"
    told = subprocess.run([sys.executable, "-c", code], env=clean, capture_output=True, check=True)
    assert told.stdout.split() == [b"1"]
