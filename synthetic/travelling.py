"""A camera that does not stay where it is."""

from __future__ import annotations

from dataclasses import dataclass

from curlshot.synthetic.camera import CameraPath, View


@dataclass(frozen=True)
class Travelling(CameraPath):
    """A camera that is at `position` at first and glides on.

    Attributes
    ----------
    velocity : tuple of float
        M/s.
    """

    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def at(self, t: float) -> View:
        """Return the view at time t, s."""
        x, y, z = (p + t * v for p, v in zip(self.position, self.velocity, strict=True))
        still = {k: v for k, v in vars(self).items() if k != "velocity"}
        return CameraPath(**{**still, "position": (x, y, z)}).at(t)
