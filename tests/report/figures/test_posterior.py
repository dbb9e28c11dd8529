from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from data.results import Joint
from report import figures
from tests.report.figures.drawn import check_layout


def test_posterior_from_covariance_and_from_samples(shot):
    laws = shot.results.laws
    rng = np.random.default_rng(4)
    samples = pd.DataFrame(
        rng.multivariate_normal(laws.values, laws.cov, 3000), columns=list(laws.names)
    )
    for given in ((laws, None), (laws, samples), (None, samples)):
        figure = figures.posterior_figure(*given)
        check_layout(figure)
        assert len(figure.axes) == 9
        assert figure.axes[0].get_title().startswith("0.831 ± 0.012")
    one = Joint(("friction",), (0.0109,), ((1e-8,),))
    check_layout(figures.posterior_figure(one))
    with pytest.raises(ValueError, match="nothing to draw"):
        figures.posterior_figure(None, pd.DataFrame({"other": [1.0]}))


def test_an_ellipse_lies_as_the_covariance_says():
    laws = Joint(("restitution", "friction"), (0.8, 0.01), ((4e-4, 8e-7), (8e-7, 1e-8)))
    figure = figures.posterior_figure(laws)
    (one, two) = figure.axes[2].patches
    c, s = np.cos(np.radians(one.get_angle())), np.sin(np.radians(one.get_angle()))
    axes = np.array([[c, -s], [s, c]]) * [one.get_width() / 2, one.get_height() / 2]
    np.testing.assert_allclose(axes @ axes.T, laws.cov, rtol=1e-6)
    assert two.get_width() == pytest.approx(2 * one.get_width())
