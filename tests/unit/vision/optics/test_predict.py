from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.optics.predict import FAR, MEMORY, predict


def test_what_is_known_once_stays() -> None:
    assert (predict([0.3], np.array([[1.0, 2.0]]), [0.4, 0.7]) == [1.0, 2.0]).all()


def test_nothing_is_foretold_over_a_long_gap() -> None:
    times = [0.0, 0.04, 0.08, 0.12, 0.16]
    seen = np.square(times)[:, None]
    reach = FAR * (times[-1] - times[0])
    near, far = times[-1] + 0.9 * reach, times[-1] + 1.1 * reach
    np.testing.assert_allclose(
        predict(times, seen, [near, far, 9.0])[:, 0], [near**2, *2 * [0.16**2]]
    )


@pytest.mark.parametrize("noise", [0.01, 1.0])
def test_noise_is_not_blown_up(noise: float) -> None:
    rng = np.random.default_rng(4)
    shake = rng.normal(0, noise, (400, MEMORY, 1))
    foretold = [predict([*range(MEMORY)], one, [MEMORY])[0, 0] for one in shake]
    assert float(np.std(foretold)) < 2.5 * noise


def test_what_lies_long_before_says_nothing() -> None:
    times = np.arange(12.0)
    seen = np.maximum(times - 5.0, 0.0)[:, None]
    np.testing.assert_allclose(predict(times.tolist(), seen, [12.0]), [[7.0]], atol=1e-9)
