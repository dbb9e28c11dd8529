"""The exceptions that a person's mistake or an unusable input ends in.

Tree::

    CurlshotError           anything the user can mend; one line, exit code 2
    ├── InputError          a file that is missing, empty, of the wrong kind or makes no sense
    ├── SceneError          a readable clip in which what is needed cannot be seen
    └── MissingPackageError a package that is optional and not installed
"""

from __future__ import annotations


class CurlshotError(Exception):
    """Something that the user can mend: says what is wrong, where, and what to do.

    Examples
    --------
    >>> import curlshot
    >>> try:
    ...     curlshot.run("nowhere.mp4")
    ... except curlshot.CurlshotError as error:
    ...     print(error)
    nowhere.mp4: no such file
    """


class InputError(CurlshotError):
    """A file that is missing, empty, of the wrong kind, or whose content makes no sense.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.Config().replace(radius=14.55)
    Traceback (most recent call last):
        ...
    curlshot.data.errors.InputError: radius: 14.55 is not a radius in metres, 0.001 to 1
    """


class SceneError(CurlshotError):
    """A readable clip in which the house, the scale or the stones cannot be seen.

    Examples
    --------
    >>> import curlshot
    >>> issubclass(curlshot.SceneError, curlshot.CurlshotError)
    True
    """


class MissingPackageError(CurlshotError, ImportError):
    """A package that is optional and not installed."""
