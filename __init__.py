"""From a clip of a curling shot to its physics: tracks, restitution, friction, simulation."""

VERSION = "0.1.0"
