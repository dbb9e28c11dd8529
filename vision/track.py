"""From a clip and its cameras to the table of detections: each stone, each frame, each angle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import STONE, Stone
from curlshot.data.tracks import DETECTION_COLUMNS, Columns, no_rows
from curlshot.vision.association.bare import with_handles
from curlshot.vision.association.follow import Track, follow
from curlshot.vision.association.graphic import is_graphic
from curlshot.vision.association.late import seen_late
from curlshot.vision.association.naming import named_by_motion
from curlshot.vision.association.rejoin import rejoined
from curlshot.vision.association.strays import without_strays
from curlshot.vision.association.watch import Watch
from curlshot.vision.detection.appearance import Appearance, other_stone
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.patch import HANDLE_HEIGHT_SD, handle_radii, is_plain
from curlshot.vision.detection.roundness import edge_errors
from curlshot.vision.detection.smeared import widened
from curlshot.vision.detection.steady import Lightness, common_share, lightness_of, steadied
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.cameras import Cameras
from curlshot.vision.spin.angles import angles_in_parts
from curlshot.vision.spin.common_height import common_height, turned_widely
from curlshot.vision.spin.handle import HandleAngles
from curlshot.vision.video.reader import Video

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

TOLD = 1.15, 1.5
"""Least evidence in tracks of stones, and in brief ones in the open: there they show 2 to 3, half
covered 1.3 or more; people who stand about 1.08, and for a moment 1.2."""

PLAIN = 0.85, 0.85
"""The same for plain discs."""

HARDLY_TOLD = 0.004
"""How far aside a stone lies, m per axis, whose cap is hardly told from granite: lamps mirrored on
it move the edge that is found. Five filmed ones lay 2 to 7 mm off."""

TOGETHER = 0.84
"""Share of what parts of the error that places share (camera, slant, edges) come to that is stated.
Each part is as large as it may be, and no clip has all of them: places of some 700 stones in five
sets of drawn clips were off by 0.70 to 0.95 of it, 0.84 in the mean of the sets. Those of stones
cut out of pictures were off by 1.1 of it, but where they are is known to millimetres only."""


@dataclass(frozen=True)
class StoneTracks:
    """The stones of a clip.

    Attributes
    ----------
    table : Columns
        With `DETECTION_COLUMNS`, by stone and time; stones A, B, C … in the order in which they
        first move, then those at rest by their distance to the tee.
    warnings : tuple of str
        What a person should know.
    """

    table: Columns
    warnings: tuple[str, ...] = ()

    @cached_property
    def detections(self) -> pd.DataFrame:
        """The same as a DataFrame."""
        import pandas as pd

        return pd.DataFrame(self.table)


def track_stones(video: Video, cameras: Sequence[Camera], *, disc: Stone = STONE) -> StoneTracks:
    """Find, follow and name the stones of a clip and measure how they are turned.

    Parameters
    ----------
    video : Video
        Read once.
    cameras : sequence of Camera
        One per frame; frames without one are left out.
    disc : Stone
        Size of the stones, or `plain_disc(radius)` for other discs.

    Returns
    -------
    StoneTracks
        Possibly without any stone; then a warning says so.
    """
    by_frame = {camera.frame: camera for camera in cameras}
    watch = Watch(disc)
    for frame in video:
        if frame.index in by_frame:
            watch.look(frame, by_frame[frame.index])
    return tracks_of(watch, cameras)


def tracks_of(watch: Watch, cameras: Sequence[Camera]) -> StoneTracks:
    """Follow and name the stones that a watch has seen, and measure how they are turned.

    Parameters
    ----------
    watch : Watch
        Has looked at all frames.
    cameras : sequence of Camera
        One per frame, as they are known in the end; frames without one are left out.

    Returns
    -------
    StoneTracks
        As `track_stones`.
    """
    disc = watch.disc
    least = PLAIN if is_plain(disc) else TOLD
    seen = watch.finish(cameras)
    other = other_stone(watch.appearance)
    tracks = rejoined(follow(seen, disc.radius, *least, other), disc.radius, other)
    tracks = without_strays(tracks, disc.radius)
    tracks = [track for track in tracks if not is_graphic(track, cameras, disc)]
    tracks = with_handles(tracks, watch.appearance, disc)
    named, rest = named_by_motion(tracks, disc.radius)
    if not named:
        return StoneTracks(no_rows(DETECTION_COLUMNS), ("no stones were found on the ice",))
    hardly = watch.appearance is not None and watch.appearance.own
    errors = _by_edges([track.detections for track in named.values()], disc, hardly)
    edge = dict(zip(named, errors, strict=True))
    team = _teams(named, watch.appearance)
    slants = slants_of(named, cameras, disc)
    light = {name: lightness_of(track.times, track.detections) for name, track in named.items()}
    share = {
        cap: common_share(light[name] for name in named if team[name] == cap)
        for cap in set(team.values())
    }
    angles = _angles(named, disc, slants)
    late = seen_late({name: named[name] for name in rest}, cameras, disc)
    del tracks  # each goes when its rows are made
    rows = [
        _rows(
            name,
            named.pop(name),
            team[name],
            edge[name],
            angles[name],
            (light[name], share[team[name]]),
        )
        for name in sorted(named)
    ]
    return StoneTracks(
        {name: np.concatenate([part[name] for part in rows]) for name in DETECTION_COLUMNS},
        (*late, *_without_colour(watch.appearance)),
    )


def slants_of(
    tracks: Mapping[str, Track], cameras: Sequence[Camera], disc: Stone
) -> dict[str, Array]:
    """By stone, slants of the view of its places (n, 2): see `Cameras.slants`.

    On a plain disc nothing stands up: it looks as if seen from above.
    """
    by_frame = {camera.frame: camera for camera in cameras}
    out = {}
    for name, track in tracks.items():
        places = track.detections.columns("x", "y").T
        by = Cameras.of([by_frame[frame] for frame in track.frames], [1] * len(places))
        out[name] = 0 * places if is_plain(disc) else by.slants(places)
    return out


def off_axis(track: Track, slants: Array) -> Array:
    """How far aside the pictures of a cap may have been unrolled, m: a standard error per axis.

    By the errors of the centres and, in a slanting view, of the height at which the handle is.
    """
    sd = np.mean(track.detections.columns("sd_x", "sd_y"), axis=0)
    return np.asarray(np.hypot(sd, HANDLE_HEIGHT_SD * np.hypot(*slants.T)))


def _angles(
    tracks: Mapping[str, Track], disc: Stone, slants: Mapping[str, Array]
) -> dict[str, HandleAngles]:
    """Tell how stones are turned; such as hardly are, at the height at which others turn."""

    def told(name: str, height: int | None = None) -> HandleAngles:
        track, slant = tracks[name], slants[name]
        off, spectra = off_axis(track, slant), track.detections.spectra
        times, radii = np.array(track.times), handle_radii(disc)
        return angles_in_parts(times, spectra, radii, off, slants=slant, height=height)

    angles = {name: told(name) for name in tracks}
    height = common_height(angles.values())
    if height is None:
        return angles
    doubtful = [
        name for name, own in angles.items() if own.heights - {height} and not turned_widely(own)
    ]
    return angles | {name: told(name, height) for name in doubtful}


def _rows(
    name: str,
    track: Track,
    team: str,
    edge: Array,
    angles: HandleAngles,
    light: tuple[Lightness, float],
) -> Columns:
    # Made only now: the angles take much memory, and so do the detections of a long clip.
    seen = steadied(widened(track.times, [*track.detections]), *light)
    x, y, sd_x, sd_y, sd_place_x, sd_place_y = np.array(
        [(item.x, item.y, item.sd_x, item.sd_y, *item.sd_place) for item in seen]
    ).T
    return {
        "stone": np.full(len(seen), name),
        "frame": np.array(track.frames),
        "t": np.array(track.times),
        "x": x,
        "y": y,
        "theta": angles.theta,
        "sd_x": sd_x,
        "sd_y": sd_y,
        "sd_theta": angles.sd,
        "sd_place_x": np.hypot(TOGETHER * sd_place_x, edge[0]),
        "sd_place_y": np.hypot(TOGETHER * sd_place_y, edge[1]),
        "rise_a": angles.rise[:, 0],
        "rise_b": angles.rise[:, 1],
        "team": np.full(len(seen), team),
    }


def _by_edges(stones: Sequence[Sequence[Detection]], disc: Stone, hardly: bool) -> Array:
    """State how far edges of stones may be aside, (stones, 2), m: see `edge_errors`.

    `hardly` says that caps are hardly told from granite, of which the error was measured by itself.
    """
    errors = TOGETHER * edge_errors(stones, disc.cap_radius or disc.radius)
    return np.asarray(np.hypot(errors, HARDLY_TOLD) if hardly else errors)


def _without_colour(appearance: Appearance | None) -> tuple[str, ...]:
    """Warn where caps are told by their lightness alone, and all are alike."""
    caps = () if appearance is None else appearance.caps
    if len(caps) != 1 or not caps[0].grey:
        return ()
    return (
        f"only caps without colour are detected, {caps[0].name}; stones with caps about as light"
        " as their granite would be missed",
    )


def _teams(tracks: Mapping[str, Track], appearance: Appearance | None) -> dict[str, str]:
    """Colour of the caps of each stone's team; "" where the colours of the clip are not known."""
    if appearance is None:
        return dict.fromkeys(tracks, "")
    return {
        name: appearance.caps[appearance.nearest(track.colour)[0]].name
        for name, track in tracks.items()
    }
