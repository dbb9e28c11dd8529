"""Motion blur by the shutter: whether it acted on linear light or on gamma-coded values.

The shutter of a camera blurs light (see `curlshot.vision.sheet.mixing`): of an edge that is smeared
by 15 px half the light lies 3 px within dark paint. Where pictures are means of others, codes were
blurred. Which it was, edges along the pan tell beside those across it: on either side of a ring
they are moved towards the darker colour, as no view moves them. One smeared frame shows it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.camera_path.smear import SHARP
from curlshot.vision.optics.linear import Observations, linearised
from curlshot.vision.optics.paint import CIRCLES, FIXED, TWELVE, Marks
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.robust import WIDTH, regress
from curlshot.vision.sheet.mixing import half_light
from curlshot.vision.sheet.outline import PaintEdge

Array = NDArray[np.float64]
Index = NDArray[np.int64]

LEAST_SMEAR = 3.0
"""Smear from which on edges tell what it is of, px."""

UNTOLD, DRIFT = 0.5, 0.02
"""Standard errors of the share of light before a pan, and of that in one frame for the next."""

VAGUE = 0.25
"""Standard error of a share from which on a frame tells nothing: where few circles are in view,
what else is not quite known moves edges by more."""

RANGE = 0.0, 1.5
"""What a share may come to: more than all where the smear is longer than is known."""

ALIKE = 6.0
"""How many edges beside each other err alike."""

LEAST_EDGES, LEAST_SCATTER = 20, 0.05
"""Edges without which a frame tells nothing, and the least by which edges scatter, px."""

ROUNDS = 4


@dataclass(frozen=True)
class ShutterLight:
    """How much of what a shutter blurs is light: from 0 (codes) to 1, or what looks like more.

    Attributes
    ----------
    share, sd : float
        And its standard error.
    """

    share: float
    sd: float = UNTOLD

    @classmethod
    def of(cls, edge: PaintEdge, palette: Array) -> ShutterLight:
        """As long as no pan has told it: as of what blurs pictures in which things rest."""
        most = float(half_light(palette)[TWELVE])
        return cls(float(np.clip(edge.light[TWELVE] / most, 0, 1)) if most else 0.0)

    def taking(self, share: float, sd: float) -> ShutterLight:
        """Take in what one more frame tells, with such an error."""
        own, new = 1 / (self.sd**2 + DRIFT**2), 1 / sd**2
        mean = (own * self.share + new * share) / (own + new)
        return ShutterLight(float(np.clip(mean, *RANGE)), float((own + new) ** -0.5))


@dataclass(frozen=True)
class Smeared:
    """Edges in a picture that a pan smears.

    Attributes
    ----------
    sweep : ndarray, shape (2,)
        How far those along x and those along y are smeared, px.
    palette : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge.
    edge : PaintEdge
        Where circles are in profiles across them that nothing smears.
    """

    sweep: Array
    palette: Array
    edge: PaintEdge

    def levels(self, line: Index, normal: Array, share: float) -> Array | None:
        """At which levels edges are crossed beside what `edge` says, (n,); None if at the same.

        Parameters
        ----------
        line : ndarray of int, shape (n,)
            The kind of each.
        normal : ndarray, shape (n, 2)
        share : float
            Of light in what the shutter blurs.
        """
        if not self._tells:
            return None
        still = np.append(self.edge.light, np.zeros(FIXED - CIRCLES))
        part, _ = self._smear(normal)
        return np.asarray(part * (share * half_light(self.palette) - still)[line])

    def told(
        self, marks: Marks, view: View, rig: Array, size: tuple[int, int], share: float
    ) -> tuple[float, float, float] | None:
        """Tell the share of light by where a frame has its edges.

        Parameters
        ----------
        marks : Marks
            As measured with a share that is taken for known.
        view, rig : View, ndarray
            The camera fitted to them, as in `curlshot.vision.optics.pose` and
            `curlshot.vision.optics.rig`.
        size : tuple of int
            Width and height of the picture, px.
        share : float
            That share.

        Returns
        -------
        share, sd, most : float
            With its standard error, and how far light moves edges at most, px. None where the
            frame tells nothing.
        """
        if not self._tells:
            return None
        moved = self.by_light(marks)
        more = more_light(marks, view, rig, size, moved)
        return None if more is None else (share + more[0], more[1], float(np.abs(moved).max()))

    def by_light(self, marks: Marks) -> Array:
        """How far edges lie along their normals if light is blurred beside if codes are, (n,), px.

        At no place where no pan smears them by much.
        """
        if not self._tells:
            return np.zeros(len(marks))
        part, width = self._smear(marks.normal)
        return np.asarray(half_light(self.palette)[marks.line] * part * width)

    @property
    def _tells(self) -> bool:
        return bool(np.linalg.norm(self.sweep) >= LEAST_SMEAR)

    def _smear(self, normal: Array) -> tuple[Array, Array]:
        """Part of the blur (of its variance) that is the shutter's, and width of edges, px."""
        square = (normal @ self.sweep) ** 2
        # A smear s adds s² / 12 to the variance, a slope of 1 / SHARP is that of SHARP² / 2π.
        return square / (square + 2 * SHARP**2), np.sqrt(square + SHARP**2)


def more_light(
    marks: Marks, view: View, rig: Array, size: tuple[int, int], by_light: Array
) -> tuple[float, float] | None:
    """Tell by how much more of what the shutter blurs is light than edges were measured with.

    Parameters
    ----------
    marks, view, rig, size
        As in `Smeared.told`.
    by_light : ndarray, shape (n,)
        How far light moves each, px.

    Returns
    -------
    share, sd : float
        With its standard error; None where the frame tells nothing.
    """
    if len(marks) < LEAST_EDGES:
        return None
    observed = Observations(marks, size)
    at = linearised(observed, observed.points(rig), view.vector, rig)
    known = np.append(at.by_view * marks.sd, by_light[None], axis=0).T
    value = at.residual * marks.sd
    found, cov, scatter = regress(known, value, width=WIDTH, least=LEAST_SCATTER, rounds=ROUNDS)
    sd = scatter * float(np.sqrt(ALIKE * cov[-1, -1]))
    return None if sd > VAGUE else (float(found[-1]), sd)
