from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.results import JointEstimate
from curlshot.report import figures


def test_an_ellipse_lies_as_the_covariance_says():
    laws = JointEstimate(("restitution", "friction"), (0.8, 0.01), ((4e-4, 8e-7), (8e-7, 1e-8)))
    figure = figures.posterior_figure(laws)
    (one, two) = figure.axes[2].patches
    c, s = np.cos(np.radians(one.get_angle())), np.sin(np.radians(one.get_angle()))
    axes = np.array([[c, -s], [s, c]]) * [one.get_width() / 2, one.get_height() / 2]
    np.testing.assert_allclose(axes @ axes.T, laws.cov, rtol=1e-6)
    assert two.get_width() == pytest.approx(2 * one.get_width())
