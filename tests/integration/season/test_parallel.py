from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from curlshot.season.parallel import in_processes, processors


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
    os.kill(os.getpid(), signal.SIGKILL)


def killed_beside(marks: tuple[Path, str]) -> None:
    folder, role = marks
    if role == "slow":
        fails_beside(marks)
    while not (folder / "slow begun").exists():
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGKILL)


def test_each_item_is_worked_on_in_another_process_and_they_stay_in_their_order() -> None:
    told: list[tuple[str, int, int | None]] = []
    items = {f"n{number}": number for number in (1, 2, 3, 4)}
    done = in_processes(squared, items, 2, "numbers", lambda *step: told.append(step))
    assert {name: square for name, (square, _) in done.items()} == {
        "n1": 1, "n2": 4, "n3": 9, "n4": 16
    }  # fmt: skip
    assert list(done) == list(items)
    makers = {maker for _, maker in done.values()}
    assert len(makers) == 4 and os.getpid() not in makers
    assert told == [("numbers", number, 4) for number in range(5)]


def test_what_fails_stops_the_others_and_they_clean_up(tmp_path: Path) -> None:
    items = {role: (tmp_path, role) for role in ("slow", "fails", "queued", "last")}
    begun = time.monotonic()
    with pytest.raises(ValueError, match="as it must"):
        in_processes(fails_beside, items, 2, "things")
    assert time.monotonic() - begun < 30
    left = {path.name for path in tmp_path.iterdir()}
    assert "slow cleaned up" in left and "last begun" not in left


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="nothing is killed so on Windows")
def test_a_process_that_is_killed_is_told_of_as_too_little_memory() -> None:
    with pytest.raises(MemoryError):
        in_processes(killed, {"one": 1, "two": 2}, 2, "things")


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="nothing is killed so on Windows")
def test_beside_one_that_is_killed_the_others_clean_up(tmp_path: Path) -> None:
    begun = time.monotonic()
    with pytest.raises(MemoryError):
        in_processes(killed_beside, {r: (tmp_path, r) for r in ("slow", "killed")}, 2, "things")
    assert (tmp_path / "slow cleaned up").exists() and time.monotonic() - begun < 30


def ended(_: int) -> None:
    os._exit(3)


def test_a_process_that_ends_by_itself_is_not_told_of_as_too_little_memory() -> None:
    with pytest.raises(RuntimeError, match="before its work"):
        in_processes(ended, {"one": 1, "two": 2}, 2, "things")


def test_processes_of_others_are_left_alone() -> None:
    other = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(60,))
    other.start()
    try:
        with pytest.raises(ZeroDivisionError) as told:
            in_processes(divided, {"one": 1, "two": 0}, 2, "things")
        assert "in divided" in told.value.__notes__[0]  # where it was, there
        other.join(0.5)
        assert other.is_alive()
    finally:
        other.kill()
        other.join()


def divided(number: int) -> float:
    return 1 / number


def large(mark: Path) -> bytes:
    """Go on when told to end, with more to send than a pipe holds."""
    if mark.name == "fails":
        while not mark.with_name("large").exists():
            time.sleep(0.01)
        raise ValueError("as it must")
    try:
        mark.touch()
        time.sleep(60)
    except KeyboardInterrupt:
        pass
    return bytes(10_000_000)


def test_one_that_goes_on_when_it_is_told_to_end_is_not_waited_for_for_ever(tmp_path: Path) -> None:
    begun = time.monotonic()
    with pytest.raises(ValueError, match="as it must"):
        in_processes(large, {name: tmp_path / name for name in ("large", "fails")}, 2, "things")
    assert time.monotonic() - begun < 30


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="Windows tells of no closed terminal")
def test_what_is_ignored_as_under_nohup_stays_so() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert in_processes(hung_up, {"one": 1, "two": 2}, 2, "things") == {"one": 1, "two": 2}
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        with pytest.raises(KeyboardInterrupt):
            in_processes(hung_up, {"one": 1, "two": 2}, 2, "things")
    finally:
        signal.signal(signal.SIGHUP, before)


def hung_up(number: int) -> int:
    signal.raise_signal(signal.SIGHUP)
    return number


ALONE = """
import sys
from pathlib import Path
from curlshot.season.parallel import in_processes
from curlshot.tests.integration.season.test_parallel import fails_beside
if __name__ == "__main__":
    folder = Path(sys.argv[1])
    in_processes(fails_beside, {role: (folder, role) for role in ("slow", "other")}, 2, "things")
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="Windows ends them without cleaning")
def test_no_process_is_left_where_the_first_one_is_killed(tmp_path: Path) -> None:
    script = tmp_path / "alone.py"
    script.write_text(ALONE, "utf-8")
    # Its output is at an end when none of them has it open any more.
    with subprocess.Popen(
        [sys.executable, str(script), str(tmp_path)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as first:  # fmt: skip
        begun = time.monotonic()
        while len(list(tmp_path.glob("* begun"))) < 2 and time.monotonic() - begun < 30:
            time.sleep(0.02)
        first.kill()
        first.communicate(timeout=20)
    assert len(list(tmp_path.glob("* cleaned up"))) == 2


def test_there_is_a_processor() -> None:
    assert processors() >= 1
