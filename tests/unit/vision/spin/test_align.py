from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.align import spectra
from curlshot.tests.helpers.vision.handles import RADII, patch
from curlshot.vision.spin.align import align, rings_seen
from curlshot.vision.spin.handle import cap_spectrum


def test_angles_are_found_from_beside_them() -> None:
    true = np.linspace(0, 5, 30)
    pictures = spectra(true.tolist(), [(0.0, 0.0)] * 30)
    rough = true + np.where(np.arange(30) % 2, 0.05, -0.05)
    fit = align(pictures, rough, RADII, np.full(len(rough), 0.001))
    error = fit.angle - true
    assert np.std(error) < 0.003
    assert np.abs(fit.shift).max() < 2e-4


def test_a_shift_is_told_from_a_turn() -> None:
    rng = np.random.default_rng(1)
    true = rng.uniform(0, 2 * np.pi, 40)
    # Along the handle's own axes: whatever way the cap is turned, its picture lies as far aside.
    aside = np.where(np.arange(40) % 2, 0.002, -0.002)
    shifts = [
        (-a * float(np.sin(t)), a * float(np.cos(t))) for a, t in zip(aside, true, strict=True)
    ]
    fit = align(spectra(true.tolist(), shifts), true, RADII, np.full(len(true), 0.003))
    assert np.std(fit.angle - true) < 0.01
    found = fit.shift[:, 1] - fit.shift[:, 1].mean()
    assert found == pytest.approx(aside, abs=0.0008)


def test_errors_grow_with_the_noise() -> None:
    true = np.linspace(0, 4, 40)
    rngs = [np.random.default_rng([2, k]) for k in range(40)]
    quiet = spectra(true.tolist(), [(0.0, 0.0)] * 40)
    noisy = np.array([cap_spectrum(patch(a, r), RADII) for a, r in zip(true, rngs, strict=True)])
    sure, unsure = (align(each, true, RADII, np.full(len(true), 0.001)) for each in (quiet, noisy))
    assert np.median(unsure.sd) > 3 * np.median(sure.sd)
    assert 0.2 < np.std(unsure.angle - true) / np.median(unsure.sd) < 1.5


def test_rings_out_of_the_picture_are_known() -> None:
    picture = spectra([0.0], [(0.0, 0.0)])
    picture[:, :, 5:] = 0
    assert rings_seen(picture).tolist() == [[True] * 5 + [False] * 3]


def test_pictures_are_aligned_alike_however_many_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    true = np.linspace(0, 4, 30)
    pictures = spectra(true.tolist(), [(0.0, 0.0)] * 30)
    sd_shift = np.linspace(0.0005, 0.002, 30)
    whole = align(pictures, true, RADII, sd_shift)
    monkeypatch.setattr("curlshot.vision.spin.align.TOGETHER", 7)
    parts = align(pictures, true, RADII, sd_shift)
    np.testing.assert_allclose(parts.angle, whole.angle, atol=1e-5)
    np.testing.assert_allclose(parts.sd, whole.sd, rtol=1e-3)
    np.testing.assert_allclose(parts.shift, whole.shift, atol=1e-6)
