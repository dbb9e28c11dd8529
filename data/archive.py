"""Files of a clip out of an archive that nobody vouches for."""

from __future__ import annotations

import posixpath
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path, PurePath, PurePosixPath

from curlshot.data.errors import InputError

LARGEST_CLIP = 2_000_000_000
"""Bytes, of all files of a clip together; an hour of high definition."""

MOST_PACKED = 100
"""How many times smaller an honest clip gets: codecs have packed it, blank pictures are more."""

SMALL = 10_000_000
"""Bytes; how far what unpacks to no more is packed does not matter."""

UNREADABLE = (
    zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, ValueError
)  # fmt: skip
"""What `zipfile` raises for damaged, exotic and encrypted entries."""

_CHUNK = 1 << 20


def unpack(
    archive: zipfile.ZipFile, path: Path, start: PurePath, names: Sequence[str], folder: Path
) -> tuple[Path, ...]:
    """Copy some files of an archive into a folder, under names of our own.

    Parameters
    ----------
    archive : ZipFile
        Where they are.
    path : Path
        What to call it in messages.
    start : PurePath
        Folder within the archive from which the names count.
    names : sequence of str
        The files, as a project names them.
    folder : Path
        Where they go. No name in the archive is used as a path.

    Raises
    ------
    InputError
        A file that is not there, or that promises or gives more than a clip has.
    """
    entries = [_entry(archive, path, start, name) for name in names]
    promised = sum(entry.file_size for entry in entries)
    packed = sum(entry.compress_size for entry in entries)
    if promised > LARGEST_CLIP or promised > max(SMALL, MOST_PACKED * packed):
        raise InputError(
            f"{path}: its clip would unpack to {promised / 1e6:.0f} MB, which is too large for a"
            " clip"
        )
    files = []
    left = promised
    for rank, entry in enumerate(entries):
        # The rank keeps the order and sets same names apart; the name is for messages.
        safe = "".join(c for c in PurePosixPath(entry.filename).name if c.isalnum() or c in " ._-")
        target = folder / f"{rank:06d}-{safe[-60:]}"
        with archive.open(entry) as source, target.open("wb") as copy:
            while chunk := source.read(_CHUNK):
                left -= len(chunk)
                if left < 0:
                    raise InputError(f"{path}: its clip unpacks to more than the archive says")
                copy.write(chunk)
        files.append(target)
    return tuple(files)


def _entry(archive: zipfile.ZipFile, path: Path, start: PurePath, name: str) -> zipfile.ZipInfo:
    """Find a file by the path from the project, else the only one of its bare name."""
    wanted = posixpath.normpath(
        posixpath.join(PurePosixPath(start).as_posix(), name.replace("\\", "/"))
    )
    bare = posixpath.basename(wanted)
    there = {entry.filename: entry for entry in archive.infolist() if not entry.is_dir()}
    if wanted in there:
        return there[wanted]
    alike = [entry for key, entry in there.items() if posixpath.basename(key) == bare]
    if len(alike) != 1:
        what = "is not in it" if not alike else f"is in it {len(alike)} times"
        raise InputError(f"{path}: its clip {bare[:80]} {what}")
    return alike[0]
