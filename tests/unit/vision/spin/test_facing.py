from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.handles import spectrum
from curlshot.vision.spin.facing import angle_between, angles_between


def test_many_pictures_are_told_as_each_by_itself_and_more_finely() -> None:
    turns = np.array([-0.13, 0.0, 0.07, 0.25])
    spectra = np.array([spectrum(0.4 + turn) for turn in turns])
    spectra[2, :, -3:] = 0  # rings that are not seen say nothing
    fine, likeness = angles_between(spectrum(0.4), spectra, np.zeros(4), 0.3)
    coarse = [angle_between(spectrum(0.4), each, 0.0, 0.3) for each in spectra]
    np.testing.assert_allclose(fine, turns, atol=0.002)
    np.testing.assert_allclose(fine, [angle for angle, _ in coarse], atol=0.003)
    np.testing.assert_allclose(likeness, [alike for _, alike in coarse], atol=1e-3)


def test_what_shows_nothing_faces_nowhere() -> None:
    blank = np.zeros_like(spectrum(0.0))
    angle, likeness = angle_between(spectrum(0.0), blank, 0.0, 0.3)
    assert np.isnan(angle)
    assert likeness == 0
    angles, likenesses = angles_between(
        spectrum(0.0), np.array([blank, spectrum(0.1)]), np.zeros(2), 0.3
    )
    assert np.isnan(angles).tolist() == [True, False]
    assert likenesses[0] == 0
