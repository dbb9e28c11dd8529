"""At which height the handles of a clip are seen, told by the stones that turned.

Caps are unrolled at the height of the grip and at that of the cap (`curlshot.vision.spin.handle`).
At the wrong one what turns about the stone's axis is seen beside it, and pictures of a stone that
turned widely are much less alike. Those of a stone that turned a little are about as much alike at
either height, light and shade on the cap decide, and its angles, told about a point beside its
axis, are off by a tenth. Stones of one clip have handles of one make: what turned tells it for the
others.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from curlshot.vision.spin.handle import DOUBT, HandleAngles

WIDELY = 1.5
"""By how much a stone turned that tells the height by itself, rad. Of 27 drawn stones seen at 45 to
55 degrees all 12 that turned by 1.9 and more told the right one, and 11 of the 15 others."""


def turned_widely(told: HandleAngles) -> bool:
    """Say whether a stone turned so far that it tells by itself at which height that is seen."""
    seen = told.theta[np.isfinite(told.theta)]
    return len(seen) > 0 and float(np.ptp(seen)) > WIDELY


def common_height(stones: Collection[HandleAngles]) -> int | None:
    """Tell at which of two heights what turns is seen on the stones of a clip.

    Parameters
    ----------
    stones : collection of HandleAngles

    Returns
    -------
    int or None
        Of the two; None if no stone turned widely or both heights are about as good, as from above.
    """
    wide = [told.unlike for told in stones if len(told.unlike) == 2 and turned_widely(told)]
    if not wide:
        return None
    unlike = np.sum(wide, axis=0)
    better, worse = np.argsort(unlike).tolist()
    return better if unlike[worse] > DOUBT * unlike[better] else None
