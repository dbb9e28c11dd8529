"""The page's simulator against physics/: the same shots, random ones, to a millimetre."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.physics.curl import Curl, FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, Fit, IceLaw, Penner
from curlshot.physics.impact import Frictional, Impact, PointMass, RigidBody
from curlshot.physics.prediction.start import written_start
from curlshot.physics.prediction.what_if import Amount, Changes, changed
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, Simulation, StoneStart
from curlshot.physics.simulator.values import shot_values
from curlshot.report import page
from curlshot.tests.helpers.report.browser import Browser, Tab, needs_chromium

WEB = Path(page.__file__).parent / "web"
COUNT = 240
TOLERANCE = 1e-3  # m

OUTCOME = """shots.map((shot) => {
  const done = simulator.simulate(shot), end = simulator.endOf(done), times = [end / 3, end + 1];
  return {
    hits: done.hits.map((hit) => [hit.t, hit.stones.join(" on "), hit.x, hit.y]),
    states: times.map((t) => shot.stones.map((_, k) => {
      const s = simulator.stateAt(done, k, t);
      return [s.x, s.y, s.theta, s.vx, s.vy, s.omega];
    })),
    end,
  };
})"""


@pytest.fixture(scope="module")
def tab(browser: Browser):
    with browser.tab() as tab:
        for name in ("motion.js", "simulate.js"):
            tab.value((WEB / name).read_text(encoding="utf-8") + "; null")
        yield tab


def random_shot(rng: np.random.Generator) -> Shot:
    """A stone thrown into a house of others, some of which touch; any laws."""
    radius = float(rng.choice([0.145, 0.1455]))
    stones = [
        StoneStart(
            "A",
            float(rng.uniform(-0.7, 0.7)),
            float(rng.uniform(-6, -2.2)),
            float(rng.normal(0, 0.1)),
            float(rng.uniform(0.9, 3.5)),
            float(rng.uniform(-2.5, 2.5)) * bool(rng.random() < 0.9),
            0.3,
            mass=float(rng.choice([19.1, 18.0])),
        )
    ]
    wanted = int(rng.integers(4, 13))
    while len(stones) <= wanted:
        x, y = rng.uniform(-1.4, 1.4), rng.uniform(-1.4, 1.4)
        if len(stones) > 1 and rng.random() < 0.25:  # frozen onto another
            other = stones[int(rng.integers(1, len(stones)))]
            turn = rng.uniform(0, 2 * np.pi)
            x, y = other.x + 2 * radius * np.cos(turn), other.y + 2 * radius * np.sin(turn)
        if all(np.hypot(x - s.x, y - s.y) > 2 * radius - 1e-12 for s in stones):
            stones.append(StoneStart("ABCDEFGHIJKLM"[len(stones)], float(x), float(y)))
    e, rub = float(rng.uniform(0.5, 1.0)), float(rng.uniform(0, 0.3))
    impact: Impact = [PointMass(e), Frictional(e, rub), RigidBody(e)][rng.integers(3)]
    if impact.needs_spin_after:
        stones = [replace(s, omega_after=tuple(rng.normal(0, 0.1, 2).tolist())) for s in stones]
    friction = float(rng.uniform(0.006, 0.014))
    ice: IceLaw = [Constant(friction), FCV1(), Fit(0.0015, 0.1, 0.007), Penner(friction)][
        rng.integers(4)
    ]
    curl: Curl = [NoCurl(), FCV1Curl()][rng.integers(2)]
    bounds = [None, Bounds(1)][rng.integers(2)]
    return Shot(tuple(stones), impact, ice, curl, radius, bounds)


def outcomes(tab: Tab, shots: list[Shot]) -> list[dict[str, Any]]:
    values = json.dumps([shot_values(shot) for shot in shots])
    return tab.value(f"((shots) => {OUTCOME})({values})")


def states(done: Simulation, t: float) -> np.ndarray:
    """States at a time; of a stone that has left by then, its last one."""
    rows = []
    for name, paths in done.paths.items():
        when = min(t, done.gone.get(name, t))
        rows.append([path for path in paths if path.start <= when][-1].at(when))
    return np.array(rows)


@needs_chromium
def test_random_shots_go_as_in_python(tab):
    rng = np.random.default_rng(7)
    shots = [random_shot(rng) for _ in range(COUNT)]
    worst, many = 0.0, 0
    for shot, out in zip(shots, outcomes(tab, shots), strict=True):
        done = simulate(shot)
        many += len(done.hits) > 2
        end = max(rest.t for rest in done.rest.values())
        assert out["end"] == pytest.approx(end, abs=1e-3)
        assert [name for _, name, _, _ in out["hits"]] == [" on ".join(h.stones) for h in done.hits]
        for t, seen in zip((out["end"] / 3, out["end"] + 1), out["states"], strict=True):
            expected, there = states(done, t), [name not in done.gone for name in done.rest]
            off = np.abs(np.array(seen) - expected)
            worst = max(worst, float(off[:, :2].max()))
            assert off[:, :2].max() <= TOLERANCE
            assert off[there, 2:].max(initial=0.0) <= 0.01
        for (t, _, x, y), hit in zip(out["hits"], done.hits, strict=True):
            first = hit.before[hit.stones[0]]
            place = np.array([first.x, first.y]) + shot.radius * np.array(hit.normal)
            assert t == pytest.approx(hit.t, abs=1e-4)
            assert np.hypot(x - place[0], y - place[1]) <= TOLERANCE
    assert many > COUNT / 5, "shots with several hits are the hard ones"
    assert worst <= TOLERANCE


@needs_chromium
def test_changes_are_those_of_python(tab):
    rng = np.random.default_rng(11)
    tried = 0
    while tried < 40:
        shot = random_shot(rng)
        start = written_start(shot)
        changes = Changes(
            restitution=float(rng.uniform(0, 1)),
            friction=float(rng.uniform(0.005, 0.02)),
            speed=Amount(float(rng.uniform(0.8, 4))),
            spin=Amount(float(rng.uniform(-3, 3))),
            aim_offset=float(rng.uniform(-0.3, 0.3)),
        )
        try:
            expected = simulate(changed(start, changes).shot)
        except InputError:  # it would begin on top of another
            continue
        tried += 1
        asked = {
            "restitution": changes.restitution,
            "friction": changes.friction,
            "speed": changes.speed.value,
            "spin": changes.spin.value,
            "aimOffset": changes.aim_offset,
        }
        places = tab.value(
            f"""((shot, thrown, changes) => {{
              const done = simulator.simulate(simulator.changed(shot, thrown, changes));
              return shot.stones.map((_, k) => {{
                const s = simulator.stateAt(done, k, simulator.endOf(done));
                return [s.x, s.y];
              }});
            }})({json.dumps(shot_values(shot))}, {start.thrown}, {json.dumps(asked)})"""
        )
        rest = np.array([(r.x, r.y) for r in expected.rest.values()])
        np.testing.assert_allclose(places, rest, atol=TOLERANCE, rtol=0)
