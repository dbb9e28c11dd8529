from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.synthetic.camera import Lens
from curlshot.synthetic.camera import View as TrueView
from curlshot.tests.helpers.vision.clip_marks import SIZE, seen_marks
from curlshot.tests.helpers.vision.joint import HOUSE, clip, true_view
from curlshot.vision.camera_path.joint import TOGETHER, Seen, fit_clip
from curlshot.vision.camera_path.keyframe import Keyframe
from curlshot.vision.optics.paint import (
    FIXED,
    HOG_LINE,
    LEFT,
    RIGHT,
    TWELVE,
    Marks,
    joined,
)
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.resection import solve_view
from curlshot.vision.optics.rig import OVERHEAD, start_rig
from curlshot.vision.video.disk_cache import Cached


def side_marks(true: TrueView, rng: np.random.Generator) -> Marks:
    """Points of both sides of a sheet, measured with noise."""
    y = np.linspace(-1.5, 5.0, 120)
    found = []
    for side, x in ((LEFT, -2.38), (RIGHT, 2.33)):
        pixel = true.project(np.stack([np.full_like(y, x), y, 0 * y], axis=-1))
        ahead = true.project(np.stack([np.full_like(y, x), y + 1e-4, 0 * y], axis=-1)) - pixel
        normal = np.stack([ahead[:, 1], -ahead[:, 0]], axis=-1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        pixel = pixel + normal * rng.normal(0, 0.3, (len(y), 1))
        found.append(Marks(np.full(len(y), side), y, pixel, normal, np.full(len(y), 0.45)))
    return joined(found)


def test_a_wide_lens_hangs_where_clubs_have_theirs() -> None:
    """What hangs straight above was 6.7 m up, as if it were for a broadcast: it is at 4.6 m."""
    size = (720, 1280)
    lens = Lens(size, -0.24, 0.058)
    true = TrueView(np.array([0.05, 0.1, 4.6]), np.diag([1.0, -1.0, -1.0]), 432.0, lens)
    for seed in range(3):
        rng = np.random.default_rng(seed)
        marks = joined([seen_marks(true, rng, 5, 0.3), side_marks(true, rng)])
        seen = [Seen(0, 0.0, View(np.array([0.0, 0.0, 0.0, np.log(432.0)])), Cached(marks), True)]
        (camera,) = fit_clip(seen, start_rig(OVERHEAD), OVERHEAD, size).cameras
        assert camera.position is not None and abs(camera.position[2] - 4.6) < 1.5
        assert camera.k1 == pytest.approx(-0.24, abs=0.01)
        assert camera.k2 == pytest.approx(0.058, abs=0.01)


def test_less_seen_is_known_less_and_no_error() -> None:
    rng = np.random.default_rng(3)
    whole = fit_clip(clip(rng), start_rig(OVERHEAD), OVERHEAD, SIZE).cameras[0]
    circle = fit_clip(clip(rng, 1), start_rig(OVERHEAD), OVERHEAD, SIZE)
    one = circle.cameras[0]
    few = [
        Seen(s.index, s.t, s.view, Cached(s.marks.get().pick(np.arange(5))), True)
        for s in clip(rng)
    ]
    least = fit_clip(few, start_rig(OVERHEAD), OVERHEAD, SIZE).cameras[0]
    sds = [float(np.sqrt(np.trace(c.place_cov((1.0, 1.0))))) for c in (whole, one, least)]
    assert sds[0] < sds[1] < sds[2]
    assert any("y is taken to be up" in w for w in circle.warnings)
    assert whole.quality > one.quality > least.quality > 0


def test_a_shaking_picture_is_aside_wherever_in_the_clip_it_is() -> None:
    seen = clip(np.random.default_rng(6), count=TOGETHER + 1, zoom=0.5)
    cameras = fit_clip(seen, start_rig(OVERHEAD), OVERHEAD, SIZE).cameras
    aside = [np.sqrt(c.error.own[0, 0]) * c.f_px for c in cameras if c.error is not None]
    np.testing.assert_allclose(aside, 0.1, rtol=0.2)  # half of what is left of its edges


def test_a_line_that_no_frame_with_rings_shows_moves_no_view() -> None:
    """As a wide hog line, of which one edge is measured 5 cm beside its middle."""
    seen = clip(np.random.default_rng(7), noise=0.1)
    true = true_view(0.1, 1240.0)
    x = np.linspace(-2, 2, 20)
    places = [np.c_[x + aside, np.full((20, 2), [6.45, 0.0])] for aside in (0.0, 1e-4)]
    pixel, ahead = (true.project(place) for place in places)
    way = (ahead - pixel) / np.linalg.norm(ahead - pixel, axis=1, keepdims=True)
    normal = np.stack([way[:, 1], -way[:, 0]], axis=-1)
    hog = Marks(np.full(20, HOG_LINE), x, pixel, normal, np.full(20, 0.45))
    rings = seen_marks(true, np.random.default_rng(8), 5, 0.1)
    found = []
    for marks in (rings, joined([rings, hog])):
        carried = Seen(8, 8 / 25, seen[-1].view, Cached(marks), False)
        track = fit_clip([*seen, carried], start_rig(OVERHEAD), OVERHEAD, SIZE)
        found.append(track.cameras[-1].ice(true.project(np.c_[HOUSE, np.zeros(len(HOUSE))])))
    np.testing.assert_allclose(found[1], found[0], atol=1e-9)
    assert np.hypot(*(found[1] - HOUSE).T).max() < 0.005


def larger(seen: Seen, times: float) -> Seen:
    """The same of a picture so many times as large."""
    marks = seen.marks.get()
    view = View(seen.view.vector + np.log(times) * np.eye(4)[3])
    middle = (np.array(SIZE) - 1) / 2
    pixel = times * (marks.pixel - middle) + (times * np.array(SIZE) - 1) / 2
    grown = replace(marks, pixel=pixel, sd=times * marks.sd)
    return replace(seen, view=view, marks=Cached(grown))


def test_quality_is_the_same_in_a_larger_picture() -> None:
    seen = clip(np.random.default_rng(7), noise=0.45)
    small = fit_clip(seen, start_rig(OVERHEAD), OVERHEAD, SIZE)
    size = (3 * SIZE[0], 3 * SIZE[1])
    large = fit_clip([larger(s, 3.0) for s in seen], start_rig(OVERHEAD), OVERHEAD, size)
    assert large.cameras[0].rms_px > 1.0 > small.cameras[0].rms_px
    for one, other in zip(small.cameras, large.cameras, strict=True):
        assert other.quality == pytest.approx(one.quality, abs=0.05)
    assert not large.warnings


def test_places_scatter_as_their_covariance_by_a_views_own_marks() -> None:
    rng = np.random.default_rng(5)
    rig = start_rig(OVERHEAD)
    true = true_view(0.1, 1000.0)
    rig[:6] = *true.position, -0.03, 0.0, 0.01
    start = View(np.array([-0.1, 0.0, 0.0, np.log(1000.0)]))
    fits = [solve_view(seen_marks(true, rng, 5, 0.45), start, rig, SIZE) for _ in range(300)]
    scatter = np.std([f.view.vector for f in fits], axis=0)
    stated = np.sqrt(np.mean([np.diag(f.cov) for f in fits], axis=0))
    np.testing.assert_allclose(stated / scatter, 1.0, atol=0.2)


@pytest.mark.parametrize(("kinds", "lined"), [(5, True), (3, False)])
def test_fixed_points_may_join_and_are_no_line(kinds: int, lined: bool) -> None:
    rng = np.random.default_rng(2)
    frames = clip(rng, kinds)
    line = np.full(4, FIXED)
    along, across = np.array([1.0, -1.0, 1.0, -1.0]), np.array([1.0, 0.5, 1.0, 0.5])
    true = true_view(0.1, 950.0)
    pixel = true.project(np.stack([along, across, np.zeros(4)], axis=-1))
    normal = np.repeat(np.eye(2), 2, axis=0)
    fixed = Marks(line, along, pixel, normal, np.full(4, 0.3), across)
    first = frames[0]
    none = np.zeros((0, 2))
    key = Keyframe(
        0, first.view, start_rig(OVERHEAD), np.zeros((9, 16), np.uint8), none, none, 0.003
    )
    frames.append(Seen(8, 8 / 25, first.view, Cached(fixed), False, key))
    track = fit_clip(frames, start_rig(OVERHEAD), OVERHEAD, SIZE)
    assert any("neither centre line" in text for text in track.warnings) is not lined
    cameras = track.cameras
    camera = cameras[-1]
    assert not camera.found and camera.quality == 0
    assert np.isfinite(camera.place_cov((0.0, 0.0))).all()
    assert camera.place_sd((0.0, 0.0)) > cameras[0].place_sd((0.0, 0.0))
    assert (seen_marks(true, rng, 1, 0.0).line == TWELVE).all()
