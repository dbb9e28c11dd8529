from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.synthetic import PAINTS, Paint, render_still, sample_scene, still_camera
from curlshot.synthetic.scene import Scene
from curlshot.vision.optics.paint import CENTRE_LINE, LEFT, RIGHT, TEE_LINE, TWELVE
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.rig import OVERHEAD, start_rig
from curlshot.vision.sheet.marks import measure_along, measure_marks, profiles
from curlshot.vision.sheet.normals import SAMPLES, lay_out

SIZE = (960, 540)

NOISE_SD = 0.1
"""Least standard deviation of an edge point by itself, px."""


def scene(paint: Paint) -> Scene:
    base = sample_scene()
    return Scene(paint=paint, sheet=base.sheet, light=base.light)


def truth(paint: Paint) -> tuple[View, np.ndarray]:
    """The library's parameters of a camera straight above the tee."""
    rig = start_rig(OVERHEAD, (0.0, 0.0, 9.0))
    rig[3:6] = 0
    rig[6:8] = paint.radii[1:3]
    rig[8:10] = -2.375, 2.36
    return View(np.array([0.0, 0.0, 0.0, np.log(90.0 * 9)])), rig


def still(paint: Paint) -> np.ndarray:
    path = still_camera(size=SIZE, position=(0, 0, 9.0), target=(0, 0), px_per_m=90)
    return render_still(scene(paint), path)


@pytest.mark.parametrize("name", ["navy-orange", "gold-purple", "teal-red"])
def test_edges_lie_on_the_circles(name: str) -> None:
    paint = PAINTS[name]
    view, rig = truth(paint)
    evidence = measure_marks(still(paint), view.vector, rig, reach=7)
    assert (evidence.support > 0.85).all()
    # An outline is part of the paint: its outer side is the edge.
    outline = 0.0 if paint.outline is None else 90 * paint.outline_width
    middle = (np.array(SIZE) - 1) / 2
    for kind, radius in enumerate((1.829, rig[6], rig[7])):
        on = evidence.marks.pick(evidence.marks.line == kind)
        off = np.linalg.norm(on.pixel - middle, axis=1) - radius * 90
        assert abs(np.median(off)) < 0.15 + outline
        assert np.std(off) < 0.35


def test_lines_and_sides_are_measured() -> None:
    paint = PAINTS["navy-orange"]
    view, rig = truth(paint)
    marks = measure_marks(still(paint), view.vector, rig, reach=7).marks
    middle = (np.array(SIZE) - 1) / 2
    for kind, axis, place in (
        (CENTRE_LINE, 0, 0.0),
        (TEE_LINE, 1, 0.0),
        (LEFT, 0, -2.375),
        (RIGHT, 0, 2.36),
    ):
        on = marks.pick(marks.line == kind)
        assert len(on) >= 3
        assert abs(np.median(on.pixel[:, axis] - middle[axis] - 90 * place)) < 0.6


@pytest.mark.parametrize(("aside", "clear"), [(1.0, True), (3.0, False)])
def test_sides_near_the_end_of_their_short_normals_do_not_count(aside: float, clear: bool) -> None:
    paint = PAINTS["navy-orange"]
    view, rig = truth(paint)
    turned = view.vector + np.array([0.0, aside / view.focal, 0.0, 0.0])
    line = measure_marks(still(paint), turned, rig, reach=7).marks.line
    assert (line == TWELVE).sum() > 100
    assert ((line == LEFT).any(), (line == RIGHT).any()) == (clear, clear)


def test_bare_ice_gives_no_edges() -> None:
    view, rig = truth(PAINTS["navy-orange"])
    noise = np.random.default_rng(0).normal(230, 2, (SIZE[1], SIZE[0], 3))
    evidence = measure_marks(noise.astype(np.uint8), view.vector, rig, reach=7)
    assert (evidence.visible > 0.9).all()
    assert (evidence.covered == 0).all()


@pytest.mark.parametrize("name", ["navy-orange", "gold-purple"])
@pytest.mark.parametrize(("softness", "noise"), [(0.55, 2.0), (1.5, 2.0), (0.55, 5.0)])
def test_edges_are_unbiased_under_blur_and_noise(name: str, softness: float, noise: float) -> None:
    base = scene(PAINTS[name])
    path = still_camera(size=SIZE, position=(0, 0, 9.0), target=(0, 0), px_per_m=90)
    view, rig = truth(PAINTS[name])
    image = render_still(
        replace(base, light=replace(base.light, softness=softness, noise=noise)), path
    )
    normals = lay_out(view.vector, rig, SIZE, reach=7, most=60)
    (seen,) = measure_along([image], normals, normals.standing[None], least_sd=NOISE_SD)
    marks = seen.marks
    middle = (np.array(SIZE) - 1) / 2
    for kind, radius in enumerate((1.829, rig[6], rig[7])):
        on = marks.pick(marks.line == kind)
        off = np.linalg.norm(on.pixel - middle, axis=1) - radius * 90
        assert abs(np.median(off)) < 0.1
        # The stated standard deviation is that of a single mark, give or take.
        spread = 1.48 * np.median(np.abs(off - np.median(off)))
        assert 0.4 * spread < np.median(on.sd) < 2.5 * max(spread, NOISE_SD)


def test_known_colours_are_told_from_those_of_something_else() -> None:
    paint = PAINTS["navy-orange"]
    view, rig = truth(paint)
    seen = measure_marks(still(paint), view.vector, rig, reach=7)
    normals = lay_out(view.vector, rig, SIZE, reach=7)
    pictures = [still(paint), still(PAINTS["gold-purple"])]
    again, other = measure_along(
        pictures, normals, np.array([normals.standing] * 2), palette=seen.palette
    )
    assert (again.support > 0.85).all()
    assert other.support[0] < 0.1


def test_profiles_are_read_along_the_normals() -> None:
    view, rig = truth(PAINTS["navy-orange"])
    normals = lay_out(view.vector, rig, SIZE, reach=7.0, most=48)
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    image = np.stack([x / 6, y / 6, np.full_like(x, 100.0)], axis=-1).astype(np.uint8)
    share = np.linspace(-1, 1, SAMPLES)[:, None]
    shift = np.array([[2.5], [-1.25]])
    at = (normals.point + shift)[:, None] + (normals.normal * normals.reach)[:, None] * share
    (found,) = profiles([image], normals, (normals.point + shift)[None])
    np.testing.assert_allclose(found[:2], at / 6, atol=1.6)
    np.testing.assert_array_equal(found[2], 100)
    above = View(view.vector + np.array([1.2, 0.0, 0.0, 0.0]))
    none = lay_out(above.vector, rig, SIZE, reach=7.0, lines=False)
    assert not none.kinds
    assert profiles([image], none, none.point[None]).shape == (1, 3, SAMPLES, 0)
