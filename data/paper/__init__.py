"""Tables 1 to 4 of the study that this program began with, as printed.

"Dynamic Modeling and Analysis of an Olympic Curling Shot" (2023/24): one shot of the men's
final at PyeongChang 2018, marked by hand in Tracker. Stone A hits B, B hits C.

Table 1 holds the two material values beside those of the literature, with the range given
there; Table 2 what was measured; Tables 3 and 4 what the authors computed with rigid
bodies and with point masses. The printed numbers contain slips, which are kept:
``docs/paper.md`` lists them.
"""

from __future__ import annotations

from importlib.resources import files

import pandas as pd

TABLES = (1, 2, 3, 4)


def table(number: int) -> pd.DataFrame:
    """Return one of the printed tables.

    Parameters
    ----------
    number : {1, 2, 3, 4}
        Which.

    Returns
    -------
    DataFrame
        Table 1: ``quantity, measured, literature, low, high``. Tables 2 to 4, one row per
        event and stone: ``event, frame, t, stone, x, y, vx, vy, omega`` in s, m, m/s and
        rad/s, NaN where the study prints nothing or question marks.

    Raises
    ------
    ValueError
        For any other number.
    """
    if number not in TABLES:
        raise ValueError(f"the study has tables {TABLES}, not {number}")
    with (files(__name__) / f"table{number}.csv").open(encoding="utf-8") as text:
        return pd.read_csv(text)
