"""Files that appear whole or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from curlshot.data.errors import InputError
from curlshot.data.text import printable

FILES = (".csv", ".json", ".html", ".mp4", ".png", ".txt", ".trk", ".trz", ".parquet")
"""Endings by which a person means a file, not a folder that is to be made."""


_FULL = frozenset({errno.ENOSPC, errno.EDQUOT})
"""Of a disk, or of what a person may write to it."""


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path` that replaces it when the block ends well.

    Parameters
    ----------
    path : Path
        Where the finished file shall be; its folder is made if need be.

    Yields
    ------
    Path
        A name in the same folder, with the same ending, to write to.

    Raises
    ------
    InputError
        Where nothing can be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(
            dir=path.parent, prefix=f".{path.stem}-", suffix=path.suffix
        )
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None
    os.close(handle)
    part = Path(name)
    try:
        yield part
        # mkstemp makes private files; a result should have the usual permissions.
        umask = os.umask(0)
        os.umask(umask)
        part.chmod(0o666 & ~umask)
        part.replace(path)
    except OSError as error:
        # A full disk is told without a name, and nobody knows the temporary one.
        if error.errno is not None and error.filename in (None, name):
            error.filename = str(path)
        raise
    finally:
        part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write UTF-8 text whole or not at all, with Unix line ends, `printable`."""
    with whole_file(path) as part:
        part.write_text(printable(text), encoding="utf-8", newline="\n")


def relative_path(path: Path, folder: Path) -> str:
    """Path from a folder, with slashes; the whole path where there is none, as on two drives."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:
        return path.resolve().as_posix()


def check_folder(out: str | Path, how: str = " with `out`") -> Path:
    """Refuse a bad place for results before an hour of work, not after; `how` to name another."""
    folder = Path(out)
    there = next(part for part in (folder, *folder.parents) if part.exists())
    if not there.is_dir():
        raise InputError(f"{there}: is a file; name a folder for the results{how}")
    if there != folder and folder.suffix.lower() in FILES:
        raise InputError(
            f"{folder}: would be a folder of results; choose a name without the ending of a"
            f" file{how}"
        )
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"{there}: nothing can be written here; name another folder{how}")
    return folder


@contextmanager
def staged(folder: Path, replaces: Sequence[str] = ()) -> Iterator[Path]:
    """Give a hidden folder; its content moves to `folder` if the block ends well.

    It lies in `folder` itself where that is there, which may be all that can be written to or a
    disc of its own, else beside it.

    Files that were there under the same names are replaced, those named in `replaces` are
    removed, for they tell of an earlier run, and others are left alone.

    Raises
    ------
    InputError
        Where nothing can be written.
    """
    with _hidden(folder) as hidden:
        stage = Path(hidden)
        try:
            yield stage
        except OSError as error:
            if error.errno not in _FULL:
                raise
            raise InputError(f"{folder}: {error.strerror}; nothing was written") from None
        folder.mkdir(parents=True, exist_ok=True)
        new = {item.name for item in stage.iterdir()}
        for name in sorted(new.union(replaces)):
            target = folder / name
            if target.is_dir() and not target.is_symlink():
                shutil.rmtree(target)
            elif name not in new:
                target.unlink(missing_ok=True)
            if name in new:
                (stage / name).replace(target)


def _hidden(folder: Path) -> tempfile.TemporaryDirectory[str]:
    """Make a folder with a name of its own in `folder`, or beside it where it is not there."""
    around = folder if folder.is_dir() else folder.parent
    try:
        around.mkdir(parents=True, exist_ok=True)
        return tempfile.TemporaryDirectory(
            dir=around, prefix=f".{folder.name}-", ignore_cleanup_errors=True
        )
    except OSError as error:
        raise InputError(
            f"{folder}: cannot be written ({error.strerror}); name another folder with `out`"
        ) from None
