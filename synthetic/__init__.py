"""Clips of curling shots whose truth is known, rendered from a scene and a camera.

`render_clip` writes one, `cached_clip` keeps it between test runs, `render_still` gives one
picture; `plain_pictures` is a second renderer, as a check on the first; `sample_scene`,
`random_scene` and the cameras are good places to start, to be varied with
`dataclasses.replace`. Shares no code with the library.
"""

from curlshot.synthetic.camera import (
    CameraPath,
    Key,
    View,
    broadcast_camera,
    still_camera,
    tilted_camera,
)
from curlshot.synthetic.clip import (
    TrueHit,
    Truth,
    cached_clip,
    describe,
    frame_times,
    pictures,
    render_clip,
    render_still,
)
from curlshot.synthetic.physics import Ice, Impact, Start, simulate
from curlshot.synthetic.plain import plain_pictures
from curlshot.synthetic.scene import Cut, Graphic, Light, Mark, Paint, Person, Scene, Sheet, Stone
from curlshot.synthetic.scenes import (
    PAINTS,
    random_scene,
    red_stone,
    sample_camera,
    sample_scene,
    sweepers,
    yellow_stone,
)
from curlshot.synthetic.video import write_video

__all__ = [
    "PAINTS", "CameraPath", "Cut", "Graphic", "Ice", "Impact", "Key", "Light", "Mark", "Paint",
    "Person", "Scene", "Sheet", "Start", "Stone", "TrueHit", "Truth", "View", "broadcast_camera",
    "cached_clip", "describe", "frame_times", "pictures", "plain_pictures", "random_scene",
    "red_stone", "render_clip", "render_still", "sample_camera", "sample_scene", "simulate",
    "still_camera", "sweepers", "tilted_camera", "write_video", "yellow_stone",
]  # fmt: skip
