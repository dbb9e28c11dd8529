"""Where a report comes from: enough to make it again."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

LIBRARIES = (
    "numpy", "scipy", "pandas", "filterpy", "opencv-python-headless", "av", "matplotlib",
)  # fmt: skip

MOST_FILES = 6
"""Input files that are listed one by one."""


@dataclass(frozen=True)
class Source:
    """A file that was read: its name, its size in bytes and its SHA-256."""

    name: str
    size: int
    sha256: str


@dataclass(frozen=True)
class Provenance:
    """What was read, by what, and how it was asked for.

    Attributes
    ----------
    version : str
        Of this program.
    command : str
        Command line that does it again; empty where it is not known.
    sources : tuple of Source
        The input files.
    """

    version: str = ""
    command: str = ""
    sources: tuple[Source, ...] = ()


UNKNOWN = Provenance()
"""Where nothing is known of how a report came to be."""


def sources(files: Sequence[Path]) -> tuple[Source, ...]:
    """Return the input files with their hashes; many as one, hashed in their order."""
    if len(files) <= MOST_FILES:
        return tuple(Source(file.name, file.stat().st_size, _sha256([file])) for file in files)
    size = sum(file.stat().st_size for file in files)
    name = f"{len(files)} files, {files[0].name} to {files[-1].name}"
    return (Source(name, size, _sha256(files)),)


def libraries() -> dict[str, str]:
    """Versions of Python and of the libraries that the numbers depend on."""
    found = {"Python": platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def _sha256(files: Sequence[Path]) -> str:
    digest = hashlib.sha256()
    for file in files:
        with file.open("rb") as stream:
            while block := stream.read(1 << 20):
                digest.update(block)
    return digest.hexdigest()
