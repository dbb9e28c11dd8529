from __future__ import annotations

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from curlshot.data.results import JointEstimate
from curlshot.report import figures
from curlshot.tests.helpers.report.drawn import check_layout


def test_posterior_from_covariance_and_from_samples(shot):
    laws = shot.results.joint_estimate
    rng = np.random.default_rng(4)
    samples = pd.DataFrame(
        rng.multivariate_normal(laws.values, laws.cov, 3000), columns=list(laws.names)
    )
    for given in ((laws, None), (laws, samples), (None, samples)):
        figure = figures.posterior_figure(*given)
        check_layout(figure)
        assert len(figure.axes) == 9
        assert figure.axes[0].get_title().endswith("\n0.831 ± 0.012")
    one = JointEstimate(("friction",), (0.0109,), ((1e-8,),))
    check_layout(figures.posterior_figure(one))
    with pytest.raises(ValueError, match="nothing to draw"):
        figures.posterior_figure(None, pd.DataFrame({"other": [1.0]}))


@pytest.mark.parametrize(("middle", "sd"), [(0.0085, 1e-3), (0.010896, 1.1e-5), (0.0109, 4e-6)])
def test_marks_of_well_known_values_stand_apart(middle, sd):
    names = ("restitution", "friction", "stone_friction")
    cov = np.diag(np.square([80 * sd, sd, 100 * sd]))
    figure = figures.posterior_figure(
        JointEstimate(names, (0.834, middle, 0.0496), tuple(map(tuple, cov)))
    )
    check_layout(figure)
    for ax in figure.axes[6:]:
        low, high = ax.get_xlim()
        ticks = [t for t in ax.xaxis.get_major_ticks() if low <= t.get_loc() <= high]
        assert len(ticks) >= 2
        boxes = [tick.label1.get_window_extent() for tick in ticks]
        space = figure.dpi / 25
        assert all(b.x0 - a.x1 > space for a, b in pairwise(boxes))


def test_the_lines_across_a_row_are_those_of_its_numbers(shot):
    grid = np.reshape(figures.posterior_figure(shot.results.joint_estimate).axes, (3, 3))
    left, middle = (ax.yaxis.get_majorticklocs() for ax in grid[2, :2])
    np.testing.assert_allclose(middle, left)
