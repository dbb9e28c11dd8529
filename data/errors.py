"""The exceptions that a person's mistake or an unusable input ends in.

Tree::

    CurlshotError           anything the user can mend; one line, exit code 2
    ├── InputError          a file that is missing, empty, of the wrong kind or makes no sense
    └── SceneError          a readable clip in which what is needed cannot be seen
"""

from __future__ import annotations


class CurlshotError(Exception):
    """Something that the user can mend: says what is wrong, where, and what to do."""


class InputError(CurlshotError):
    """A file that is missing, empty, of the wrong kind, or whose content makes no sense."""


class SceneError(CurlshotError):
    """A readable clip in which the house, the scale or the stones cannot be seen."""
