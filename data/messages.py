"""Messages name settings and commands in backticks; the command line spells them as it has them.

So a message reads well from Python (`camera_height`), and on a terminal, in a file or a report
(--camera-height), where people use the command. What reads such a file turns them back.
"""

from __future__ import annotations

import re

OPTIONS = frozenset({
    "aim_offset", "angle_unit", "angles", "camera", "camera_height", "clip", "config", "fps",
    "frames", "friction", "house", "length_unit", "masses", "names", "no_house", "out", "overlay",
    "over", "radius", "restitution", "samples", "speed", "spin", "stick", "tab", "throw_sd",
    "units",
})  # fmt: skip
"""Settings and arguments that are options of the command."""

COMMANDS = ("check", "convert", "estimate", "run", "season", "simulate", "track")

_OTHER = {"masses": "--mass", "out": "-o", "overlay": "--no-overlay"}
_TICKED = re.compile(rf"`({'|'.join((*sorted(OPTIONS, key=len, reverse=True), *COMMANDS))})`")


def as_options(text: str) -> str:
    """Return a message with settings and commands as the command line spells them.

    Examples
    --------
    >>> as_options("give `camera_height`; `check` shows more")
    'give --camera-height; curlshot check shows more'
    """
    return _TICKED.sub(lambda match: _spelled(match[1]), text)


def as_settings(text: str) -> str:
    """Return a message of the command line with settings and commands in backticks.

    It is the inverse of `as_options`.

    Examples
    --------
    >>> as_settings("give --camera-height; curlshot check shows more")
    'give `camera_height`; `check` shows more'
    """
    return _SPELLED.sub(lambda match: f"`{_NAMED[match[0]]}`", text)


def option(name: str) -> str:
    """Return the option of the command that is the setting of that name.

    Examples
    --------
    >>> option("camera_height"), option("masses")
    ('--camera-height', '--mass')
    """
    return _OTHER.get(name, f"--{name.replace('_', '-')}")


def _spelled(name: str) -> str:
    return f"curlshot {name}" if name in COMMANDS else option(name)


_NAMED = {_spelled(name): name for name in (*OPTIONS, *COMMANDS)}
_SPELLED = re.compile(rf"(?<![\w-])({'|'.join(_NAMED)})(?![\w-])")
