"""The tracks in one file, in that file's units."""

from __future__ import annotations

from dataclasses import dataclass, field

import pandas as pd


@dataclass
class TrackFile:
    """What one file holds, in the file's units.

    Attributes
    ----------
    tracks : DataFrame
        ``stone, t, x, y`` and, where the file has them, ``theta``, ``frame``, ``team`` and the sd
        columns; t in s, all with a place. Of a run's table ``seen`` and what it measured, too.
    decimals : int or None
        To how many decimals the times are printed; None where that does not matter.
    length_unit, angle_unit : str or None
        As the header says, or the project.
    continuous : bool
        Whether angles run on past a full turn by the layout's own rule.
    warnings : list of str
        What was decided on evidence, or left out.
    masses : dict of str to float
        Masses of the tracks by name, where the file has them.
    """

    tracks: pd.DataFrame
    decimals: int | None = None
    length_unit: str | None = None
    angle_unit: str | None = None
    continuous: bool = False
    warnings: list[str] = field(default_factory=list)
    masses: dict[str, float] = field(default_factory=dict)
