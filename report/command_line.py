"""The command line that does a run again."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from curlshot.config import CONFIG_FILE, Config
from curlshot.data.messages import OPTIONS, option

MOST_FILES = 8
"""Input files that are named one by one."""


def command_of(files: Sequence[Path], config: Config) -> str:
    """Return the ``curlshot run`` that reads the same files with the same settings.

    Parameters
    ----------
    files : sequence of Path
        What was read; of many the folder is named.
    config : Config
        The settings of the run. Those that only a file can set are in the config.toml of its
        folder.
    """
    inputs = [file.name for file in files]
    if len(files) > MOST_FILES:
        inputs = [f"{files[0].parent.name}/"]
    words = ["curlshot", "run", *inputs]
    changed = config.changed()
    for name, value in changed.items():
        words += _option(name, value) if name in OPTIONS else []
    if not OPTIONS.issuperset(changed):
        words += ["--config", CONFIG_FILE]  # what only a file can set
    return shlex.join(words)


def _option(key: str, value: object) -> list[str]:
    """Words of one option on the command line."""
    name = option(key)
    if isinstance(value, bool):
        return [name]
    if isinstance(value, Mapping):
        return [word for stone, item in value.items() for word in (name, f"{stone}={item}")]
    if key == "frames" and isinstance(value, tuple):
        first, last = value
        return [name, f"{first}:{'' if last is None else last}"]
    if key == "house" and isinstance(value, tuple):
        frame, *points = value
        text = ",".join(map(str, points))
        return [name, text if frame is None else f"{frame}:{text}"]
    if isinstance(value, tuple):
        return [name, ",".join(map(str, value))]
    return [name, str(value)]
