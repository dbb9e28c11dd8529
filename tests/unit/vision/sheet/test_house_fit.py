from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.synthetic import render_still
from curlshot.synthetic.camera import CameraPath
from curlshot.tests.helpers.vision.house_fit import OVER, SCENE, SIZE, TILTED, guess, roughly
from curlshot.vision.optics.pose import ROLL, camera
from curlshot.vision.optics.rig import ANYWHERE, OVERHEAD
from curlshot.vision.sheet.house_fit import fit_roughly, start


@pytest.mark.parametrize("path", [OVER, TILTED], ids=["overhead", "tilted"])
def test_it_starts_where_the_guess_is(path: CameraPath) -> None:
    here = guess(path)
    view, rig, prior = start(here, SIZE)
    assert prior is (OVERHEAD if path is OVER else ANYWHERE)
    tee, right, up = camera(view, rig, SIZE).project(0.1 * np.array([[0, 0], [1, 0], [0, 1]]))
    np.testing.assert_allclose(tee, here.centre, atol=0.01)
    assert np.linalg.norm(right - tee) == pytest.approx(0.1 * here.scale, rel=0.06)
    assert up[1] < tee[1] and abs(up[0] - tee[0]) < 0.1 * (tee[1] - up[1])
    short = np.linalg.norm(up - tee) / np.linalg.norm(right - tee)
    assert short == pytest.approx(here.foreshortening, rel=0.05)


def test_circles_alone_do_not_roll_a_view() -> None:
    begin, *_ = start(guess(OVER), SIZE)
    rough = roughly(render_still(SCENE, OVER), OVER)
    assert rough is not None
    assert abs(rough.view.vector[ROLL] - begin.vector[ROLL]) < 0.003


def test_what_lies_aside_is_worth_less() -> None:
    image, here = render_still(SCENE, OVER), guess(OVER)
    scores = []
    for x in (0.5, 0.9):
        fit = fit_roughly(image, *start(here, SIZE), here.scale, x * SIZE[0])
        assert fit is not None
        scores.append(fit.score)
    assert scores[0] > scores[1] + 0.5


def test_nothing_is_fitted_to_bare_ice() -> None:
    bare = render_still(SCENE, replace(OVER, keys=(replace(OVER.keys[0], y=9.0),)))
    assert roughly(bare, OVER) is None
