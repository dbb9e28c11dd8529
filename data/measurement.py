"""What was measured, before any physics: detections of every stone and where they come from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from curlshot.data.sheet import House

if TYPE_CHECKING:
    import pandas as pd

    from curlshot.data.tracks import Table


class Duplicate(NamedTuple):
    """A decoded frame that repeats one before it: its time, s, and the number of that one."""

    t: float
    of: int


@dataclass(frozen=True, eq=False)
class Measurement:
    """Detections of the stones and where they come from.

    Attributes
    ----------
    files : tuple of Path
        What was read.
    table : Table
        One row per stone and frame, with `curlshot.data.tracks.DETECTION_COLUMNS`.
    fps : float or None
        Nominal rate of frames, 1/s.
    frames : int
        How many frames were decoded, duplicates among them.
    warnings : tuple of str
        What a person should know.
    clip : object or None
        The clip that was read (see `curlshot.vision.video.reader.Video`); None for tables.
    cameras : tuple
        One per frame (see `curlshot.vision.optics.camera.Camera`); empty for tables.
    house : House or None
        The rings; None where the scene has no house.
    masses : mapping of str to float
        Masses by stone as a table states them.
    duplicates : mapping of int to Duplicate
        Frames that repeat one before and were not measured.
    """

    files: tuple[Path, ...]
    table: Table
    fps: float | None
    frames: int
    warnings: tuple[str, ...] = ()
    clip: Any = None
    cameras: tuple[Any, ...] = ()
    house: House | None = None
    masses: Mapping[str, float] = field(default_factory=dict)
    duplicates: Mapping[int, Duplicate] = field(default_factory=dict)

    @cached_property
    def detections(self) -> pd.DataFrame:
        """The table as a DataFrame."""
        import pandas as pd

        return pd.DataFrame(self.table)
