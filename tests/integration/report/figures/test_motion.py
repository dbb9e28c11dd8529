from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.results import Glide
from curlshot.report import figures
from curlshot.tests.helpers.report.drawn import check_layout, texts


@pytest.mark.parametrize("stone", ["A", "B", "C"])
def test_motion_says_the_fitted_velocities_with_their_errors(shot, stone):
    collisions, glides = shot.results.collisions, shot.results.glides
    figure = figures.motion_figure(shot.tracks, stone, collisions, glides)
    check_layout(figure)
    assert len(figure.axes) == 3
    said = " ".join(t.get_text() for t in texts(figure))
    for hit in collisions:
        if stone in hit.stones:
            after = hit.after[stone]
            assert f"{abs(after.vx):.3f} ± 0.012" in said
            assert f"{abs(after.vy):.3f} ± 0.015" in said
    for glide in glides:
        if glide.friction is not None:
            assert (f"± {glide.stderr}" in said) == (glide.stone == stone)


@pytest.mark.parametrize("stone", ["A", "B", "C"])
def test_spin_says_the_fitted_spins_with_their_errors(shot, stone):
    figure = figures.spin_figure(shot.tracks, stone, shot.results.collisions)
    check_layout(figure)
    assert [ax.get_ylabel() for ax in figure.axes] == ["angle (rad)", "spin (rad/s)"]
    said = " ".join(t.get_text() for t in texts(figure))
    for hit in shot.results.collisions:
        if stone in hit.stones:
            assert f"{hit.after[stone].omega:.3f} ± 0.021" in said


def test_speed_is_cut_at_hits(shot):
    figure = figures.speed_figure(shot.tracks, shot.results.collisions)
    check_layout(figure)
    line = figure.axes[0].lines[0]
    t, speed = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert np.isnan(speed).sum() == 1
    assert np.nanmax(np.abs(np.diff(speed))) < 0.05
    assert t[0] == 0


def test_of_many_glides_the_legend_names_the_first(shot):
    glides = [Glide("C", 1.6 + 0.2 * k, 1.78 + 0.2 * k, 0.0109, 1e-3) for k in range(24)]
    figure = figures.motion_figure(shot.tracks, "C", shot.results.collisions, glides)
    check_layout(figure)
    said = [t.get_text() for t in figure.axes[2].get_legend().get_texts()]
    assert len(said) == 10
    assert said[-1] == "and 15 more"
