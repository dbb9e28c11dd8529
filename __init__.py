"""From a clip of a curling shot to its physics: tracks, restitution, friction, simulation."""

from curlshot.data.version import VERSION as __version__

__all__ = ["__version__"]
