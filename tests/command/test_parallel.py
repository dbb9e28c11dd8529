from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest

from command.parallel import in_processes, processors


def squared(number: int) -> tuple[int, int]:
    time.sleep(0.2 if number == 1 else 0.0)  # the first is not the first to be done
    return number**2, os.getpid()


def fails_beside(marks: tuple[Path, str]) -> None:
    folder, role = marks
    (folder / f"{role} begun").touch()
    if role == "fails":
        while not (folder / "slow begun").exists():
            time.sleep(0.01)
        raise ValueError("as it must")
    try:
        time.sleep(60)
    finally:
        (folder / f"{role} cleaned up").touch()


def killed(_: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)


def test_each_item_is_worked_on_in_another_process_and_they_stay_in_their_order() -> None:
    told: list[tuple[str, int, int | None]] = []
    items = {f"n{number}": number for number in (1, 2, 3, 4)}
    done = in_processes(squared, items, 2, "numbers", lambda *step: told.append(step))
    assert {name: square for name, (square, _) in done.items()} == {
        "n1": 1, "n2": 4, "n3": 9, "n4": 16
    }  # fmt: skip
    assert list(done) == list(items)
    makers = {maker for _, maker in done.values()}
    assert 1 <= len(makers) <= 2 and os.getpid() not in makers
    assert told == [("numbers", number, 4) for number in range(5)]


def test_what_fails_stops_the_others_and_they_clean_up(tmp_path: Path) -> None:
    items = {role: (tmp_path, role) for role in ("slow", "fails", "queued", "last")}
    begun = time.monotonic()
    with pytest.raises(ValueError, match="as it must"):
        in_processes(fails_beside, items, 2, "things")
    assert time.monotonic() - begun < 30
    for _ in range(500):
        if (tmp_path / "slow cleaned up").exists():
            break
        time.sleep(0.01)
    left = {path.name for path in tmp_path.iterdir()}
    assert "slow cleaned up" in left and "last begun" not in left


def test_a_process_that_is_killed_is_told_of_as_too_little_memory() -> None:
    with pytest.raises(MemoryError):
        in_processes(killed, {"one": 1, "two": 2}, 2, "things")


def test_there_is_a_processor() -> None:
    assert processors() >= 1
