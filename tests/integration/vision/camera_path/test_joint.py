from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from curlshot import pipeline
from curlshot.tests.helpers.vision.clip_marks import SIZE, seen_marks
from curlshot.tests.helpers.vision.joint import HOUSE, clip, true_view
from curlshot.vision.camera_path.follow_house import follow_house
from curlshot.vision.camera_path.joint import Seen, fit_clip
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.rig import OVERHEAD, start_rig
from curlshot.vision.video.disk_cache import Cached
from curlshot.vision.video.reader import open_video

SAMPLE = pipeline.sample_clip()


@pytest.mark.parametrize("height", [0.0, 0.12])
def test_cameras_are_recovered_within_their_stated_errors(height: float) -> None:
    scaled = []
    for seed in range(4):
        track = fit_clip(clip(np.random.default_rng(seed)), start_rig(OVERHEAD), OVERHEAD, SIZE)
        for camera in track.cameras[::3]:
            true = true_view(0.1, 950.0 + 30 * camera.frame)
            pixels = true.project(np.c_[HOUSE, np.full(len(HOUSE), height)])
            off = camera.ice(pixels, height) - HOUSE
            cov = camera.place_cov(HOUSE, height)
            assert np.hypot(*off.T).max() < 0.003
            scaled.append(off / np.sqrt(np.diagonal(cov, axis1=-2, axis2=-1)))
    assert np.mean(np.abs(np.concatenate(scaled)) < 2) > 0.92


def test_noise_that_stays_with_the_picture_is_not_taken_for_new_in_every_frame() -> None:
    true, off, scaled = true_view(0.1, 1000.0), [], []
    start = View(np.array([-0.1, 0.0, 0.0, np.log(true.focal)]))
    for seed in range(12):
        marks = Cached(seen_marks(true, np.random.default_rng(seed), 5, 0.1))
        seen = [Seen(k, k / 25, start, marks, True) for k in range(12)]
        camera = fit_clip(seen, start_rig(OVERHEAD), OVERHEAD, SIZE).cameras[0]
        off.append(camera.ice(true.project(np.c_[HOUSE, np.zeros(len(HOUSE))])) - HOUSE)
        cov = camera.place_cov(HOUSE)
        scaled.append(off[-1] / np.sqrt(np.diagonal(cov, axis1=-2, axis2=-1)))
    assert np.sqrt(np.mean(np.square(off))) < 0.0005  # by pieces of several marks 0.0006
    # Stated for what clips err beyond this noise (`LONG_RANGE`): twice as much, and no more.
    assert 0.35 < np.sqrt(np.mean(np.square(scaled))) < 0.7


def test_quality_falls_when_the_fit_is_bad() -> None:
    tracks = [
        fit_clip(clip(np.random.default_rng(1), noise=noise), start_rig(OVERHEAD), OVERHEAD, SIZE)
        for noise in (0.1, 2.5)
    ]
    assert ["explains little" in " ".join(t.warnings) for t in tracks] == [False, True]
    good, bad = (t.cameras[0] for t in tracks)
    assert 1 >= good.quality > bad.quality + 0.2
    assert bad.rms_px > 1.0 > good.rms_px
    assert np.trace(bad.place_cov((1.0, 1.0))) > 4 * np.trace(good.place_cov((1.0, 1.0)))


@pytest.mark.parametrize(
    ("columns", "told"), [(0, False), (20, False), (80, True), (150, True), (-150, True)]
)
def test_a_picture_cropped_off_its_middle_is_told_and_less_trusted(
    columns: int, told: bool
) -> None:
    seen, aside = [], np.array([columns / 2, 0.0])
    for s in clip(np.random.default_rng(7), noise=0.1):
        marks = s.marks.get()  # so many columns are missing at the right: the middle moves
        seen.append(replace(s, marks=Cached(replace(marks, pixel=marks.pixel + aside))))
    track = fit_clip(seen, start_rig(OVERHEAD), OVERHEAD, SIZE)
    assert any("cropped" in w for w in track.warnings) == told
    camera = track.cameras[0]
    pixels = true_view(0.1, 950.0).project(np.c_[HOUSE, np.zeros(len(HOUSE))])
    off, cov = camera.ice(pixels + aside) - HOUSE, camera.place_cov(HOUSE)
    scaled = off / np.sqrt(np.diagonal(cov, axis1=-2, axis2=-1))
    assert np.sqrt(np.mean(np.square(scaled))) < 2
    assert (float(np.sqrt(np.trace(cov, axis1=-2, axis2=-1)).mean()) > 0.003) == told
    assert (track.position_sd[0] > 0.06) == told


@pytest.mark.parametrize(("bent", "told"), [(0.0, False), (1.2, True)])
def test_a_lens_that_bends_all_pictures_alike_is_told_though_it_passes_for_paint(
    bent: float, told: bool
) -> None:
    seen = []
    for one in clip(np.random.default_rng(8), noise=0.1, zoom=1.0):
        marks = one.marks.get()
        waves = bent * np.sqrt(2) * np.sin(marks.pixel[:, ::-1] / [40.0, 55.0])
        seen.append(replace(one, marks=Cached(replace(marks, pixel=marks.pixel + waves))))
    track = fit_clip(seen, start_rig(OVERHEAD), OVERHEAD, SIZE)
    assert track.cameras[0].rms_px < 0.4
    assert ("explains little" in " ".join(track.warnings)) == told


def true_camera(index: int) -> Camera:
    facts = json.loads(SAMPLE.with_suffix(".truth.json").read_text())
    row = {
        key: column[index] for key, column in facts["camera"].items() if isinstance(column, list)
    }
    matrix = np.array([[row.get(f"h{i}{j}", 1.0) for j in (1, 2, 3)] for i in (1, 2, 3)])
    return Camera(index, 0.0, matrix, tuple(facts["size"]), row["k1"], row["k2"])


def test_stated_error_covers_the_true_one() -> None:
    ratios, sizes = [], []
    house = np.array([(x, y) for x in np.linspace(-1.8, 1.8, 7) for y in np.linspace(-1.8, 3, 9)])
    for camera in follow_house(open_video([SAMPLE])).cameras[::20]:
        pixels = true_camera(camera.frame).project(house)
        shown = ((pixels > 0) & (pixels < camera.size)).all(-1)
        off = (camera.ice(pixels) - house)[shown]
        sd = np.sqrt(np.diagonal(camera.place_cov(house[shown]), axis1=-2, axis2=-1))
        ratios.append((off / sd).ravel())
        sizes.append(camera.place_sd(house[shown]))
    assert np.mean(np.abs(np.concatenate(ratios)) < 2) > 0.9
    assert np.median(np.concatenate(sizes)) < 0.005
