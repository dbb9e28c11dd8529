from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.shot_fit.off_centre import centred, centred_traces

SD, PLACE = 0.0005, 0.002
COUNT = 200


def trace(turned: float, known: bool = True) -> Trace:
    """Detections of a stone that turns by so many radians."""
    t = np.linspace(0.0, 4.0, COUNT)
    theta = 0.3 + turned * t / 4.0 if known else np.full(COUNT, np.nan)
    xy = np.zeros((COUNT, 2))
    return Trace(
        "A",
        t,
        xy,
        np.full_like(xy, SD),
        theta,
        np.full(COUNT, 0.01),
        np.full_like(xy, PLACE),
        0 * xy,
    )


def wobble(seen: Trace, ahead: float, left: float) -> np.ndarray:
    """Residuals of a cap that is so far beside the centre in its stone's frame."""
    cos, sin = np.cos(seen.theta), np.sin(seen.theta)
    off = np.column_stack([cos * ahead - sin * left, sin * ahead + cos * left])
    return np.asarray(off / SD)


def test_a_cap_off_centre_is_found_by_its_turning() -> None:
    seen = trace(5.0)
    left, beside = centred(seen, wobble(seen, 0.003, -0.001), 1.0, PLACE)
    assert beside * PLACE == pytest.approx([0.003, -0.001], rel=0.01)
    assert np.abs(left).max() < 0.1


def test_outliers_do_not_move_it() -> None:
    seen = trace(5.0)
    residuals = wobble(seen, 0.003, -0.001)
    residuals[::20] += 500.0
    _, beside = centred(seen, residuals, 1.0, PLACE)
    assert beside * PLACE == pytest.approx([0.003, -0.001], abs=0.0005)


def test_it_is_known_beforehand() -> None:
    seen = trace(5.0)
    residuals = wobble(seen, 0.003, 0.0)
    # As many detections' noise as this leaves half of what is known beforehand.
    noise = COUNT * (PLACE / SD) ** 2
    _, beside = centred(seen, residuals / 10, noise, PLACE)
    assert beside == pytest.approx([0.15 / 2, 0.0], abs=1e-9)


@pytest.mark.parametrize(("seen", "sd"), [(trace(5.0), 0.0), (trace(5.0, known=False), PLACE)])
def test_nothing_is_taken_out_without_angles_or_a_stated_error(seen: Trace, sd: float) -> None:
    residuals = np.random.default_rng(1).normal(size=(COUNT, 2))
    left, beside = centred(seen, residuals, 1.0, sd)
    assert left is residuals
    assert not beside.any()


@pytest.mark.parametrize("share", [1.0, 0.25])
def test_detections_are_put_over_the_centre_by_as_much_as_the_fit_allows(share: float) -> None:
    """As much noise as this leaves part of what is known beforehand, the more the more that is."""
    seen, noise = trace(5.0), COUNT * (PLACE / SD) ** 2
    residuals = wobble(seen, 0.003, 0.0) / 10
    shot = SimpleNamespace(
        traces={"A": seen, "B": trace(5.0, known=False)},
        sd_off_centre=lambda _: share * PLACE,
        residuals=lambda _: [residuals, residuals],
    )
    fit = SimpleNamespace(shots=[shot], simulation=lambda: None, inflation=noise)
    known = shot.traces
    moved = centred_traces(known, fit)  # type: ignore[arg-type]
    kept = share**2 / (1 + share**2)
    assert moved["A"].xy == pytest.approx(seen.xy - kept * SD * residuals, abs=1e-9)
    # What angles are off by makes places err from now on.
    away = kept * 0.003 / 10
    assert moved["A"].sd == pytest.approx(np.hypot(SD, away * seen.sd_theta[:, None] + 0 * seen.sd))
    assert moved["B"] is known["B"]


def test_angles_beyond_what_was_fitted_are_those_that_were_seen() -> None:
    seen = trace(5.0)
    shot = SimpleNamespace(
        traces={"A": seen.until(2.0)},
        sd_off_centre=lambda _: PLACE,
        residuals=lambda _: [wobble(seen, 0.003, -0.001)[seen.t < 2.0]],
    )
    fit = SimpleNamespace(shots=[shot], simulation=lambda: None, inflation=1.0)
    moved = centred_traces({"A": seen}, fit)  # type: ignore[arg-type]
    assert moved["A"].xy == pytest.approx(-SD * wobble(seen, 0.003, -0.001), abs=1e-4)


def test_where_no_cap_is_told_all_stays_as_it_is() -> None:
    known = {"A": trace(5.0)}
    ones = [np.ones((COUNT, 2))]
    shot = SimpleNamespace(traces=known, sd_off_centre=lambda _: 0.0, residuals=lambda _: ones)
    fit = SimpleNamespace(shots=[shot], simulation=lambda: None, inflation=1.0)
    assert centred_traces(known, fit) is known  # type: ignore[arg-type]


def test_what_was_seen_without_an_angle_for_a_while_has_no_say() -> None:
    """Its last angle holds no longer: taken for that of a stone that stands it spoils all."""
    turns, seen = trace(5.0), trace(5.0)
    seen.theta[seen.t > 2.0] = np.nan
    residuals = wobble(turns, 0.003, -0.001)
    left, beside = centred(seen, residuals, 1.0, PLACE)
    assert beside * PLACE == pytest.approx([0.003, -0.001], abs=0.0003)
    late = seen.t > 2.6
    assert (left[late] == residuals[late]).all()
    shot = SimpleNamespace(
        traces={"A": seen}, sd_off_centre=lambda _: PLACE, residuals=lambda _: [residuals]
    )
    fit = SimpleNamespace(shots=[shot], simulation=lambda: None, inflation=1.0)
    moved = centred_traces({"A": seen}, fit)["A"]  # type: ignore[arg-type]
    assert (moved.xy[late] == seen.xy[late]).all()
    assert moved.sd[late] == pytest.approx(np.hypot(0.0032, SD), rel=0.1)
