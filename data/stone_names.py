"""Which track of which file is which stone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from curlshot.data.errors import InputError
from curlshot.data.track_file import TrackFile


def chosen(
    paths: Sequence[Path], files: Sequence[TrackFile], names: Mapping[str, str]
) -> tuple[list[Path], list[TrackFile]]:
    """Keep the tracks that are named, under the names of their stones.

    Parameters
    ----------
    paths : sequence of Path
        Where each file was read from.
    files : sequence of TrackFile
        What they hold.
    names : mapping
        Names of stones to names of tracks.

    Raises
    ------
    InputError
        A track that is not there, or that shall be two stones.
    """
    there = list(dict.fromkeys(t for file in files for t in file.tracks["stone"].unique()))
    missing = [track for track in names.values() if track not in there]
    if missing:
        raise InputError(f"no track named {missing[0]}; there are {', '.join(there)}")
    stones = {track: stone for stone, track in names.items()}
    if len(stones) < len(names):
        raise InputError("one track cannot be two stones; name each once (`names`)")
    kept = [_renamed(file, stones) for file in files]
    used = [(path, file) for path, file in zip(paths, kept, strict=True) if len(file.tracks)]
    return [path for path, _ in used], [file for _, file in used]


def _renamed(file: TrackFile, names: Mapping[str, str]) -> TrackFile:
    """Give tracks new names, and leave out those without."""
    tracks = file.tracks.assign(stone=file.tracks["stone"].map(names))
    masses = {names[track]: mass for track, mass in file.masses.items() if track in names}
    return replace(file, tracks=tracks.dropna(subset=["stone"], ignore_index=True), masses=masses)


def named_by_file(
    paths: Sequence[Path], files: Sequence[TrackFile]
) -> tuple[list[TrackFile], list[str]]:
    """Name tracks after their files where each file has one and they share a name.

    Projects of one stone each often call it all the same, as Tracker proposes.

    Returns
    -------
    list of TrackFile
        With the names told apart where that is clear.
    list of str
        A warning for each name that was shared.
    """
    tracks = [list(file.tracks["stone"].unique()) for file in files]
    shared = [name for name, n in Counter(t for each in tracks for t in each).items() if n > 1]
    out = list(files)
    warnings = []
    for name in shared:
        where = [k for k, each in enumerate(tracks) if name in each]
        stems = [paths[k].stem for k in where]
        taken = {track for each in tracks for track in each if track != name}
        if any(len(tracks[k]) > 1 for k in where) or len({*stems} - taken) < len(where):
            continue  # to be refused
        for k, stem in zip(where, stems, strict=True):
            out[k] = _renamed(files[k], {name: stem})
        warnings.append(
            f"{', '.join(str(paths[k]) for k in where)}: all their tracks are named {name}; named"
            f" after the files instead: {', '.join(stems)}"
        )
    return out, warnings


def refuse_shared_names(paths: Sequence[Path], files: Sequence[TrackFile]) -> None:
    """Raise `InputError` where tracks of two files still have one name."""
    owner: dict[str, Path] = {}
    for path, file in zip(paths, files, strict=True):
        for stone in file.tracks["stone"].unique():
            if stone in owner:
                raise InputError(
                    f"{path}: two stones with one name, {stone}, which is in {owner[stone]} too;"
                    " rename one (the line above the header, or the file)"
                )
            owner[stone] = path
