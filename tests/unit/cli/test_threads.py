from __future__ import annotations

import os

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
