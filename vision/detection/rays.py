"""Rays about places on the ice, sampled in the picture itself.

All places of one or more pictures are treated at once: every array begins with the axis of the
places.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.cameras import Cameras
from curlshot.vision.video.colour import lab_of
from curlshot.vision.video.picture import Picture, colours_at

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]
Flags = NDArray[np.bool_]

_MOST_ROWS = 32000
"""As many as cv2.remap takes at once."""


@dataclass(frozen=True)
class Look:
    """A picture, its camera, and places on its ice.

    Attributes
    ----------
    picture, camera : Picture, Camera
    places : ndarray, shape (n, 2)
        m.
    drift : ndarray, shape (n, 2), optional
        How far what is there moves across the picture, from that before, in m of the ice there;
        None where that is not known.
    """

    picture: Picture
    camera: Camera
    places: Array
    drift: Array | None = None


def cameras_of(looks: Sequence[Look]) -> Cameras:
    """Give the cameras of all places of looks, in their order."""
    return Cameras.of([look.camera for look in looks], [len(look.places) for look in looks])


@dataclass(frozen=True)
class Rays:
    """Colours on rays around n places, from the pictures themselves.

    Attributes
    ----------
    bgr, lab : ndarray, shape (n, rays, radii, 3)
        As blue, green, red and as L*a*b*, 8 bits each.
    inside : ndarray of bool, shape (n, rays, radii)
        Where the picture shows the place.
    radius, angle : ndarray, shapes (radii,) and (rays,)
        Distances from the centre, m; counter-clockwise from the x axis of the ice, rad.
    """

    bgr: Bytes
    lab: Bytes
    inside: Flags
    radius: Array
    angle: Array

    def at(self, radius: float) -> Flags:
        """Which rays show the place at this radius, shape (n, rays)."""
        return np.asarray(self.inside[..., np.searchsorted(self.radius, radius)])

    def at_places(self, index: NDArray[np.intp]) -> Rays:
        """Take those about some of the places."""
        return Rays(self.bgr[index], self.lab[index], self.inside[index], self.radius, self.angle)

    def replaced(self, index: NDArray[np.intp], by: Rays) -> Rays:
        """Take others about some of the places."""
        bgr, lab = self.bgr.copy(), self.lab.copy()
        bgr[index], lab[index] = by.bgr, by.lab
        return Rays(bgr, lab, self.inside, self.radius, self.angle)


@lru_cache(maxsize=8)
def directions(rays: int) -> tuple[Array, Array]:
    """Angles of so many rays, rad, and unit vectors along them, shape (rays, 2)."""
    angle = np.arange(rays, dtype=np.float64) * (2 * np.pi / rays)
    return angle, np.stack([np.cos(angle), np.sin(angle)], -1)


@dataclass(frozen=True)
class Profile:
    """What lies along a ray: nodes at which the camera is evaluated, and samples between them.

    Between nodes less than a stone's radius apart every camera is straight to 0.01 px.

    Attributes
    ----------
    node_radius, node_height : ndarray, shape (nodes,)
        Distances from the centre, and how high above the ice what is seen there lies, m.
    radius : ndarray, shape (radii,)
        Of the samples, m.
    mix : ndarray, shape (nodes, radii)
        What each node has to say at each sample.
    """

    node_radius: Array
    node_height: Array
    radius: Array
    mix: Floats


def straight(nodes: Sequence[tuple[float, float]], radius: Array) -> Profile:
    """Profile through nodes (radius, height) joined by straight lines."""
    node_radius, node_height = np.array(nodes, float).T
    mix = [np.interp(radius, node_radius, row) for row in np.eye(len(node_radius))]
    return Profile(node_radius, node_height, radius, np.array(mix, np.float32))


def chained(first: Profile, second: Profile) -> Profile:
    """Profile that has the samples of one and then those of the other."""
    mix = np.zeros((len(first.mix) + len(second.mix), len(first.radius) + len(second.radius)))
    mix[: len(first.mix), : len(first.radius)] = first.mix
    mix[len(first.mix) :, len(first.radius) :] = second.mix
    return Profile(
        np.append(first.node_radius, second.node_radius),
        np.append(first.node_height, second.node_height),
        np.append(first.radius, second.radius),
        np.asarray(mix, np.float32),
    )


def sample_rays(looks: Sequence[Look], by: Cameras, profile: Profile, rays: int) -> Rays:
    """Sample pictures on rays around places on the ice.

    Parameters
    ----------
    looks : sequence of Look
        Pictures of one size, each with the centres.
    by : Cameras
        Theirs (`cameras_of`).
    profile : Profile
        Of every ray.
    rays : int
        How many, counter-clockwise from the x axis.
    """
    angle, around = directions(rays)
    spokes = around[:, None] * profile.node_radius[:, None]
    places = np.concatenate([look.places for look in looks])
    nodes = (places[:, None, None] + spokes).reshape(len(places), -1, 2)
    projected = by.project(nodes, np.tile(profile.node_height, rays))
    ends = projected.reshape(len(places), *spokes.shape).astype(np.float32)
    across, down = ends[..., 0] @ profile.mix, ends[..., 1] @ profile.mix
    width, high = looks[0].camera.size
    right, low = ends[..., 0].max(initial=0), ends[..., 1].max(initial=0)
    if ends.min(initial=0) >= 0 and right <= width - 1 and low <= high - 1:
        inside = np.ones(across.shape, bool)
    else:
        inside = (across >= 0) & (down >= 0) & (across <= width - 1) & (down <= high - 1)
    bgr = np.empty((*across.shape, 3), np.uint8)
    most, end = _MOST_ROWS // rays, 0
    for look in looks:
        begin, end = end, end + len(look.places)
        for k in range(begin, end, most):
            part = slice(k, min(k + most, end))
            x, y = (along[part].reshape(-1, along.shape[-1]) for along in (across, down))
            bgr[part] = colours_at(look.picture, x, y).reshape(-1, *bgr.shape[1:])
    return Rays(bgr, lab_of(bgr), inside, profile.radius, angle)
