"""From a clip to tracks: the only room that knows pixels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.config import VideoConfig

if TYPE_CHECKING:
    from curlshot.vision.video.reader import Video

__all__ = ["open_video"]


def open_video(
    files: str | Path | Sequence[str | Path], config: VideoConfig = VideoConfig()
) -> Video:
    """Open a clip for reading: a video, pictures, or a Tracker project with its clip.

    Parameters
    ----------
    files : str or Path, or sequence of them
        One video, one project, or pictures (files, a folder or a glob).
    config : VideoConfig
        Rate of pictures, and the range of frames to use.

    Returns
    -------
    Video
        Iterating it yields frames at their true times, without duplicates and fields.

    Raises
    ------
    curlshot.data.errors.InputError
        Where there is no such clip, or it cannot be read.

    Examples
    --------
    >>> from curlshot.pipeline import sample_clip
    >>> video = open_video(sample_clip(), VideoConfig(frames=(10, 12)))
    >>> [(frame.index, round(frame.t, 2)) for frame in video]
    [(10, 0.4), (11, 0.44), (12, 0.48)]
    """
    from curlshot.data.inputs import find_inputs
    from curlshot.vision.video import reader

    return reader.open_video(find_inputs(files), config)
