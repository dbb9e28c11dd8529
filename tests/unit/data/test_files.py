from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

import pytest

from curlshot.data.errors import InputError
from curlshot.data.files import check_folder, staged, whole_file, write_text


def names(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


def test_text_is_written_whole_with_unix_line_ends(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "a.txt"
    write_text(path, "μ = 0,01\nzwei\n")
    assert path.read_bytes() == "μ = 0,01\nzwei\n".encode()
    assert names(path.parent) == ["a.txt"]


def test_a_failure_leaves_the_old_file_and_no_rest(tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    write_text(path, "old")
    with pytest.raises(RuntimeError, match="half way"), whole_file(path) as part:
        part.write_text("half of the n")
        raise RuntimeError("half way")
    assert path.read_text() == "old"
    assert names(tmp_path) == ["results.json"]


def test_a_full_disk_is_told_with_the_name_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "shot.csv"
    with pytest.raises(OSError, match="No space") as caught, whole_file(path):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert caught.value.filename == str(path)


def test_a_failure_leaves_no_file_where_there_was_none(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), whole_file(tmp_path / "a.mp4") as part:
        part.write_text("half")
        raise KeyboardInterrupt
    assert names(tmp_path) == []


def test_the_temporary_file_has_the_same_ending_and_folder(tmp_path: Path) -> None:
    with whole_file(tmp_path / "overlay.mp4") as part:
        assert part.suffix == ".mp4"
        assert part.parent == tmp_path
        assert not (tmp_path / "overlay.mp4").exists()


def test_a_writer_may_replace_or_remove_its_part(tmp_path: Path) -> None:
    with whole_file(tmp_path / "a.txt") as part:
        part.unlink()
        part.write_text("again")
    assert (tmp_path / "a.txt").read_text() == "again"


def test_others_may_read_the_file(tmp_path: Path) -> None:
    old = os.umask(0o022)
    try:
        write_text(tmp_path / "a.txt", "a")
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == 0o644


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write all")
def test_results_go_into_a_folder_whose_parent_is_not_ours(tmp_path: Path) -> None:
    folder = tmp_path / "own"
    folder.mkdir()
    tmp_path.chmod(0o555)
    try:
        with staged(folder) as stage:
            (stage / "a.txt").write_text("a", encoding="utf-8")
    finally:
        tmp_path.chmod(0o755)
    assert [path.name for path in folder.iterdir()] == ["a.txt"]


def test_results_are_gathered_within_a_folder_that_is_there(tmp_path: Path) -> None:
    folder = tmp_path / "disc"
    folder.mkdir()
    with staged(folder) as stage:
        assert stage.parent == folder  # which may be a disc of its own
        (stage / "a.txt").write_text("a", encoding="utf-8")
    assert [path.name for path in folder.iterdir()] == ["a.txt"]


def test_a_place_that_takes_no_files_is_named_and_not_the_hidden_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    folder = tmp_path / "file" / "within" / "run"
    message = rf"^{folder}: cannot be written \(.+\); name another folder"
    with pytest.raises(InputError, match=message), staged(folder):
        pass


def test_a_file_that_cannot_be_written_is_named_itself(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    path = tmp_path / "file" / "a.csv"
    with pytest.raises(InputError, match=rf"^{path}: cannot be written \(.+\)$"):
        write_text(path, "a")


def test_results_do_not_go_into_a_new_folder_named_like_a_file(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"tracks\.csv: would be a folder of results; choose a name"
    ):
        check_folder(tmp_path / "tracks.csv")
    for name in ("season.2026", "old.csv"):
        (tmp_path / "old.csv").mkdir(exist_ok=True)
        assert check_folder(tmp_path / name) == tmp_path / name


def test_a_full_disc_is_told_with_the_folder_and_leaves_nothing(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    with pytest.raises(InputError, match=rf"^{folder}: .+; nothing was written$"), staged(folder):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert not list(tmp_path.iterdir())
    with pytest.raises(PermissionError), staged(folder):
        raise PermissionError
