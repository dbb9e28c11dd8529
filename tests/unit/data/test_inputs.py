from __future__ import annotations

from pathlib import Path

import pytest

from curlshot.data.errors import InputError
from curlshot.data.inputs import find_inputs, picture_times


def made(folder: Path, *names: str) -> list[Path]:
    folder.mkdir(exist_ok=True)
    paths = [folder / name for name in names]
    for path in paths:
        path.touch()
    return paths


def test_pictures_of_a_folder_come_in_natural_order(tmp_path: Path) -> None:
    made(tmp_path / "f", "10.png", "9.PNG", "1a.jpg", "notes.txt")
    assert [path.name for path in find_inputs([tmp_path / "f"])] == ["1a.jpg", "9.PNG", "10.png"]
    names = [f"{letter}{number}.png" for letter in "abcdefgh" for number in (9, 10)]
    made(tmp_path / "g", *reversed(names))
    assert [path.name for path in find_inputs([tmp_path / "g"])] == names


@pytest.mark.parametrize("kind", ["png", "mp4"])
def test_so_do_those_that_a_shell_has_named(tmp_path: Path, kind: str) -> None:
    by_shell = made(tmp_path / "b", f"f1.{kind}", f"f10.{kind}", f"f9.{kind}")
    other = made(tmp_path / "a", f"f2.{kind}")
    found = find_inputs([*by_shell, *other])
    assert [path.stem for path in found] == ["f1", "f9", "f10", "f2"]
    # Many a country's alphabet has the line before digits, but in bytes it comes after them.
    numbers = (1, 10, 11, 2, 20, 3)
    alphabet = made(tmp_path / "c", *(f"{number}_a.{kind}" for number in numbers))
    assert [path.stem for path in find_inputs(alphabet)] == [f"{n}_a" for n in sorted(numbers)]
    two = made(tmp_path / "d", *(f"{n} {c}.{kind}" for n in (1, 10, 2) for c in ("blue", "red")))
    assert [path.stem[:2] for path in find_inputs(two)] == ["1 ", "1 ", "2 ", "2 ", "10", "10"]
    ends = [made(tmp_path / f"end {n}", f"a.{kind}")[0] for n in (1, 10, 2)]
    assert [path.parent.name for path in find_inputs(ends)] == ["end 1", "end 2", "end 10"]


@pytest.mark.parametrize("kind", ["png", "mp4"])
def test_an_order_that_no_shell_makes_is_a_person_s_own(tmp_path: Path, kind: str) -> None:
    chosen = made(tmp_path, *(f"{name}.{kind}" for name in ("start", "middle", "end 10", "end")))
    assert list(find_inputs(chosen)) == chosen


def test_a_glob_is_sorted_and_files_keep_their_order(tmp_path: Path) -> None:
    made(tmp_path, "b2.csv", "b10.csv", "a.txt")
    found = find_inputs([tmp_path / "a.txt", str(tmp_path / "b*.csv")])
    assert [path.name for path in found] == ["a.txt", "b2.csv", "b10.csv"]
    assert find_inputs(str(tmp_path / "b**.csv")) == found[1:]
    for folder in ("end 2", "end 10"):
        made(tmp_path / folder, "a.csv")
    found = find_inputs(str(tmp_path / "end*" / "a.csv"))
    assert [path.parent.name for path in found] == ["end 2", "end 10"]


def test_one_name_alone_is_no_list_of_letters(tmp_path: Path) -> None:
    (path,) = made(tmp_path, "ok.csv")
    assert find_inputs(str(path)) == find_inputs(path) == (path,)
    with pytest.raises(InputError, match="an empty name"):
        find_inputs("")


def test_brackets_in_a_name_are_a_name_first(tmp_path: Path) -> None:
    (plain,) = made(tmp_path / "take [7]", "a [1].csv")
    assert find_inputs([plain]) == (plain,)
    assert find_inputs([str(tmp_path / "take [7]" / "*.csv")]) == (plain,)
    (one,) = made(tmp_path / "x1", "a.csv")
    assert find_inputs([str(tmp_path / "x[0-9]" / "a.csv")]) == (one,)


@pytest.mark.parametrize(
    ("name", "said"),
    [("no.mp4", "no such file"), ("none*", "no such file"), ("empty", "no pictures")],
)
def test_what_is_not_there_is_named(tmp_path: Path, name: str, said: str) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=said) as refusal:
        find_inputs([str(tmp_path / name)])
    assert name in str(refusal.value)


def test_nothing_named_is_a_mistake() -> None:
    with pytest.raises(InputError, match="no input"):
        find_inputs([])


def test_an_empty_name_is_not_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made(tmp_path, "1.png")
    monkeypatch.chdir(tmp_path)
    assert len(find_inputs(["."])) == 1
    with pytest.raises(InputError, match="an empty name"):
        find_inputs(["1.png", ""])


def test_the_folder_of_a_run_is_answered_by_its_tracks(tmp_path: Path) -> None:
    made(tmp_path / "run", "tracks.csv", "overlay.mp4")
    with pytest.raises(InputError, match=r"run: the folder of a run; name its .*tracks\.csv$"):
        find_inputs([tmp_path / "run"])
    made(tmp_path / "run", "1.png")
    assert [path.name for path in find_inputs([tmp_path / "run"])] == ["1.png"]


@pytest.mark.parametrize(
    ("names", "times"),
    [
        (["a 8.png", "a 9.png", "a 10.png"], [0, 1, 2]),
        (["im_000.png", "im_001.png", "im_005.png", "im_006.png"], [0, 1, 5, 6]),
        (["f005.jpg", "f010.jpg", "f015.jpg", "f025.jpg"], [0, 1, 2, 4]),
        (["cam2_07.jpg", "cam2_08.jpg"], [0, 1]),
        (["cam1_07.jpg", "cam2_08.jpg"], None),
        (["7.png", "7b.png"], None),
        (["a.png", "b.png"], None),
        (["3.png", "2.png", "1.png"], None),
        (["only.png"], None),
    ],
)
def test_numbers_in_names_of_pictures_tell_their_times(
    names: list[str], times: list[float] | None
) -> None:
    assert picture_times([Path(name) for name in names]) == times
