from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.data.tracks import check_detections
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.free_glides import are_free, is_pushed
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import Local, estimate_locally
from curlshot.physics.local_fit.segments import Piece
from curlshot.tests.unit.physics.watch import RADIUS, Floats, hit_motion, watch

FPS = 60


def seen(*ways: Floats, sd: float = 0.001) -> pd.DataFrame:
    """Detections of ways, (n, 2) at `FPS`, of as many stones."""
    tables = []
    for k, way in enumerate(ways):
        x, y = (way + np.random.default_rng(k).normal(0, sd, way.shape)).T
        tables.append(
            pd.DataFrame({"stone": f"S{k}", "t": np.arange(len(way)) / FPS, "x": x, "y": y})
        )
    return check_detections(pd.concat(tables))


def told(*ways: Floats) -> Local:
    return estimate_locally(seen(*ways), (), radius=RADIUS)


def by_turns(slowing: Floats, speed: float, each: float = 0.75) -> Floats:
    """A way up y whose slowing, m/s², changes from one stretch to the next."""
    t = np.arange(0.0, each * len(slowing), 1 / FPS)
    v = speed - np.cumsum(slowing[(t // each).astype(int)]) / FPS
    return np.column_stack([0 * t, np.cumsum(v) / FPS])


@pytest.mark.parametrize(
    ("slowing", "aside", "sd", "sd_aside", "so"),
    [
        (0.1, 0.0, 0.01, 0.01, False),
        (-0.15, 0.0, 0.01, 0.01, False),
        (-0.25, 0.0, 0.01, 0.01, True),
        (-0.25, 0.0, 0.03, 0.01, False),
        (3.0, 0.0, 0.01, 0.01, False),
        (0.1, 0.25, 0.01, 0.01, True),
        (0.1, -0.25, 0.01, 0.01, True),
        (0.1, 0.25, 0.01, 0.03, False),
    ],
)
def test_what_no_ice_gives_is_a_push(
    slowing: float, aside: float, sd: float, sd_aside: float, so: bool
) -> None:
    assert is_pushed(slowing, aside, sd, sd_aside) == so


def pieces(*stops: bool) -> list[Piece]:
    return [
        Piece("A", float(k), k + 1.0, np.arange(30), stops=stop) for k, stop in enumerate(stops)
    ]


def test_what_follows_one_push_is_free_and_between_two_nothing() -> None:
    row = pieces(False, False, False, False)
    assert are_free(row, (), {}).all()
    assert are_free(row, {1}, {}).tolist() == [False, False, True, True]
    assert not are_free(row, {0, 2}, {}).any()
    rests = pieces(False, True, False, False)
    assert are_free(rests, {2, 3}, {}).tolist() == [True, True, False, False]
    other = [*row[:2], Piece("B", 0.0, 1.0, np.arange(30))]
    assert are_free(other, {0, 1}, {}).tolist() == [False, False, True]
    # A hit, or a rest whose piece has been left out, begins anew.
    struck = [*row[:2], Piece("A", 2.0, 3.0, np.arange(30), opens=0)]
    assert are_free(struck, {0, 1}, {}).tolist() == [False, False, True]
    later = [*row[:2], Piece("A", 5.0, 6.0, np.arange(30))]
    assert are_free(later, {0, 1}, {}).tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("apart", "count", "so"), [(0.4, 8, False), (0.4, 4, True), (1.0, 8, True)]
)
def test_a_motion_that_changes_all_the_time_is_led(apart: float, count: int, so: bool) -> None:
    piece = Piece("A", -np.inf, np.inf, np.arange(90))
    assert are_free([piece], (), {"A": [k * apart for k in range(count)]}).tolist() == [so]
    assert are_free([piece], (), {"B": [0.1 * k for k in range(9)]}).all()
    times = {"A": [k * apart for k in range(count)]}
    rests = [Piece("A", k * apart, (k + 0.9) * apart, np.arange(9)) for k in range(count)]
    assert are_free(rests, (), times).all() == so  # however it is cut


def test_an_orbit_has_no_friction() -> None:
    t = np.arange(0.0, 10.0, 1 / FPS)
    found = told(np.column_stack([np.cos(1.3 * t), 0.5 * np.sin(1.3 * t)]))
    assert not found.glides
    assert found.friction.value is None
    assert "no stone glides freely" in str(found.friction_doubt)
    assert any("S0 is apparently pushed or carried" in text for text in found.warnings)


def test_the_slowed_halves_of_a_swing_are_no_friction() -> None:
    found = told(by_turns(np.array([0.5, -0.5] * 4), 1.0))
    assert found.friction.value is None


def test_a_stone_that_is_thrown_in_view_tells_friction_afterwards() -> None:
    found = told(by_turns(np.array([-1.0, 0.107, 0.107, 0.107, 0.107]), 0.4))
    assert found.friction.value == pytest.approx(0.0109, abs=0.0005)
    assert any(
        "S0 is apparently pushed or carried between 0.0" in t for t in found.warnings
    )


@pytest.mark.parametrize(("each", "so"), [(0.8, True), (0.4, False)])
def test_a_stone_that_is_led_tells_no_friction(each: float, so: bool) -> None:
    t = np.arange(0.0, 12 * each, 1 / FPS)
    velocity = np.column_stack([np.where((t // each) % 2, 0.4, -0.4), np.full(len(t), 0.6)])
    found = told(np.cumsum(velocity, axis=0) / FPS)
    assert (found.friction.value is not None) == so


def test_frictions_that_differ_are_a_mean_if_that_tells_something() -> None:
    wood = told(*(by_turns(np.array([9.81 * mu]), 1.5, 0.5) for mu in (0.27, 0.33)))
    assert wood.friction.value == pytest.approx(0.30, abs=0.01)
    assert "the value is a mean" in str(wood.friction_doubt)
    vague = told(*(by_turns(np.array([a]), 1.5, 1.0) for a in (1.0, -0.15, 0.1, -0.1)))
    assert len(vague.glides) == 4
    assert vague.friction.value is None
    assert "tells nothing" in str(vague.friction_doubt)


@pytest.mark.parametrize("gain", [0.3, 0.6, 1.0])
def test_a_push_up_to_the_hit_spoils_neither_restitution_nor_tracks(gain: float) -> None:
    detections = watch(hit_motion(1.5, 0.08), np.random.default_rng(3), sd=0.002)
    pushed = (detections["stone"] == "A") & (detections["t"] < 1.0)
    away = 1.0 - detections.loc[pushed, "t"]
    detections.loc[pushed, "y"] += 0.5 * (gain + 0.0109 * 9.81) * away**2
    contacts = detect_hits(detections, RADIUS)
    found = estimate_locally(detections, contacts, radius=RADIUS)
    assert found.restitution.value == pytest.approx(0.83, abs=0.02)
    assert found.restitution.stderr is not None and found.restitution.stderr < 0.02
    assert found.friction.value == pytest.approx(0.0109, abs=0.0005)
    assert any("A is pushed, carried or led" in text for text in found.warnings)
    tracks = smooth(detections, contacts, radius=RADIUS).query("stone == 'A' and t < 0.98")
    speed = 1.5 - gain * (1.0 - tracks["t"])
    assert np.sqrt(np.mean((tracks["vy"] - speed) ** 2)) < 0.05


def test_what_gains_speed_all_the_way_is_followed() -> None:
    tracks = smooth(seen(by_turns(np.array([-0.8]), 0.2, 1.2)), (), radius=0.04)
    off = tracks["vy"] - (0.2 + 0.8 * tracks["t"])
    assert np.sqrt(np.mean(off**2)) < 0.03
    assert np.sqrt(np.mean((off / tracks["sd_vy"]) ** 2)) < 1.5
