"""Interlaced recordings: of two fields taken one after the other, pictures of one moment each.

A camcorder's 50i is 25 pictures a second, each the even lines of one moment woven with the odd ones
of 1/50 s later: what moves is combed, and is where it was at neither time. The lines of the first
field are kept, and the others put between them and those of the pictures before and after, as far
as nothing moves there (FFmpeg's filter bwdif; the frame stays the one of its index and time).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import Any

import av

PULLED_DRY = av.error.BlockingIOError, av.error.EOFError


def deinterlaced(frames: Iterable[av.VideoFrame], stream: Any) -> Iterator[av.VideoFrame]:
    """Give the frames of a stream in order, those that are told to be interlaced as of one moment.

    Parameters
    ----------
    frames : iterable of av.VideoFrame
        As decoded.
    stream : av.VideoStream
        Whose they are.

    Yields
    ------
    av.VideoFrame
        Up to the first interlaced one as they are; what the others have as time base may differ
        from the stream's.
    """
    frames = map(_stamped, frames)
    for _, alike in groupby(frames, lambda frame: (frame.width, frame.height, frame.format.name)):
        graph = None
        for frame in alike:
            if graph is None and not frame.interlaced_frame:
                yield frame
                continue
            graph = graph or _graph(frame, stream)
            graph.push(frame)
            yield from _pulled(graph)
        if graph is not None:
            graph.push(None)
            yield from _pulled(graph)


def _stamped(frame: av.VideoFrame) -> av.VideoFrame:
    """Let a frame without a time of its own be shown when it was decoded."""
    if frame.pts is None:
        frame.pts = frame.dts
    return frame


def _graph(frame: av.VideoFrame, stream: Any) -> av.filter.Graph:
    """Graph for frames like this one; lines of those that are not interlaced stay as they are."""
    graph = av.filter.Graph()
    graph.threads = 1
    source = graph.add_buffer(
        width=frame.width,
        height=frame.height,
        format=frame.format,
        time_base=stream.time_base,
    )
    fields = graph.add("bwdif", "mode=send_frame:deint=interlaced")
    graph.link_nodes(source, fields, graph.add("buffersink")).configure()
    return graph


def _pulled(graph: av.filter.Graph) -> Iterator[av.VideoFrame]:
    while True:
        try:
            frame = graph.pull()
        except PULLED_DRY:
            return
        assert isinstance(frame, av.VideoFrame)
        yield frame
