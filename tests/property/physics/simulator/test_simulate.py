from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from curlshot.data.results import StoneState
from curlshot.data.sheet import GRAVITY
from curlshot.physics.curl import NoCurl
from curlshot.physics.ice import Constant, IceLaw
from curlshot.physics.impact import Frictional, Impact, PointMass
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import HitEvent, StoneStart
from curlshot.tests.helpers.physics.simulate import LAWS, R, energies, momentum, shot

MODELS: list[Impact] = [PointMass(0.8), Frictional(0.8, 0.2), Frictional(1.0, 0.0)]


@st.composite
def houses(draw: st.DrawFn) -> tuple[StoneStart, ...]:
    """Stones in a house, none overlapping, the first thrown among the others."""
    cells = draw(st.lists(st.integers(0, 24), min_size=1, max_size=5, unique=True))
    shift = st.floats(-0.1, 0.1)
    stones = [
        StoneStart(
            "A",
            draw(st.floats(-0.8, 0.8)),
            -2.0,
            draw(st.floats(-0.3, 0.3)),
            draw(st.floats(0.8, 3.5)),
            draw(st.floats(-2.5, 2.5)),
        )
    ]
    for k, cell in enumerate(cells):
        x = 0.5 * (cell % 5 - 2) + draw(shift)
        y = 0.5 * (cell // 5 - 2) + draw(shift)
        stones.append(StoneStart("BCDEFG"[k], x, y, theta=0.1 * k))
    return tuple(stones)


@settings(deadline=None)
@given(st.floats(0.3, 5.0), st.floats(0.3, 3.0), st.floats(-0.28, 0.28))
def test_contact_time_has_its_closed_form(v: float, ahead: float, offset: float) -> None:
    a = Constant().friction * GRAVITY
    way = ahead + 2 * R - math.sqrt((2 * R) ** 2 - offset**2)
    assume(way < 0.98 * v**2 / (2 * a))
    stones = StoneStart("A", 0, 0, 0, v), StoneStart("B", offset, ahead + 2 * R)
    (hit,) = simulate(
        shot(*stones, impact=PointMass(1.0), ice=Constant(), curl=NoCurl()), until=5.0
    ).hits[:1] or (None,)
    t = (v - math.sqrt(v**2 - 2 * a * way)) / a
    assume(t < 5.0)
    assert hit is not None
    assert hit.t == pytest.approx(t, abs=1e-9)
    assert hit.normal == pytest.approx(
        (offset / (2 * R), math.sqrt(1 - (offset / (2 * R)) ** 2)), abs=1e-8
    )


@settings(deadline=None)
@given(st.floats(1.0, 90.0), st.floats(1e-6, 0.01), st.sampled_from(LAWS))
def test_no_contact_is_stepped_over(v: float, deep: float, law: IceLaw) -> None:
    """However fast the stone is and however briefly it grazes the other."""
    stones = StoneStart("A", 0, -2, 0, v), StoneStart("B", 2 * R - deep, 0)
    hits = simulate(shot(*stones, ice=law, curl=NoCurl())).hits
    assert [hit.stones for hit in hits] == [("A", "B")]


@settings(deadline=None)
@given(st.floats(1.0, 90.0), st.floats(1e-8, 0.01), st.sampled_from(LAWS))
def test_a_near_miss_is_no_hit(v: float, gap: float, law: IceLaw) -> None:
    stones = StoneStart("A", 0, -2, 0, v), StoneStart("B", 2 * R + gap, 0)
    assert simulate(shot(*stones, ice=law, curl=NoCurl())).hits == ()


@settings(deadline=None, max_examples=50)
@given(
    st.tuples(st.floats(-1, 1), st.floats(0.2, 3), st.floats(-3, 3)),
    st.tuples(st.floats(-3, -0.2), st.floats(-1, 1), st.floats(-3, 3)),
    st.floats(-0.5, 0.5),
    st.sampled_from(LAWS),
)
def test_the_first_contact_of_two_that_move(
    a: tuple[float, float, float], b: tuple[float, float, float], aim: float, law: IceLaw
) -> None:
    """Against the distance of both, alone on the ice, at many moments."""
    stones = (
        StoneStart("A", 0, -1, a[0], a[1], a[2]),
        StoneStart("B", 1, aim, b[0], b[1], b[2]),
    )
    times = np.linspace(0, 12, 1201)
    alone = [simulate(shot(stone, ice=law)).sample(times)[["x", "y"]] for stone in stones]
    distance = np.linalg.norm(alone[0].to_numpy() - alone[1].to_numpy(), axis=1)
    hits = simulate(shot(*stones, ice=law)).hits
    if not hits:
        assert distance.min() > 2 * R - 1e-9
        return
    assert (distance[times < hits[0].t - 1e-9] > 2 * R - 1e-9).all()
    places = simulate(shot(*stones, ice=law)).sample([hits[0].t])[["x", "y"]].to_numpy()
    assert math.dist(*places) == pytest.approx(2 * R, abs=1e-9)


@settings(deadline=None, max_examples=60)
@given(houses(), st.sampled_from(LAWS), st.sampled_from(MODELS))
def test_laws_of_conservation(stones: tuple[StoneStart, ...], law: IceLaw, model: Impact) -> None:
    sim = simulate(shot(*stones, ice=law, impact=model))
    masses = {stone.name: stone.mass for stone in stones}
    assert [hit.t for hit in sim.hits] == sorted(hit.t for hit in sim.hits)
    for hit in sim.hits:
        before, after = dict(hit.before), dict(hit.after)
        p0, p1 = momentum(hit, before, masses), momentum(hit, after, masses)
        assert np.abs(p1 - p0).max() <= 1e-12 * np.abs(p0).max() + 1e-15
        if isinstance(model, Frictional):
            assert angular(hit, after) == pytest.approx(angular(hit, before), rel=1e-12, abs=1e-12)
    end = max(rest.t for rest in sim.rest.values())
    total = energies(sim, np.linspace(0, end, 200).tolist())
    assert np.diff(total).max() <= 1e-12
    assert total[-1] == 0


def angular(hit: HitEvent, states: dict[str, StoneState]) -> float:
    total = 0.0
    for name in hit.stones:
        s = states[name]
        assert s.omega is not None
        total += s.x * s.vy - s.y * s.vx + 0.5 * R**2 * s.omega
    return total


@settings(deadline=None, max_examples=60)
@given(houses(), st.sampled_from(LAWS))
def test_stones_never_overlap(stones: tuple[StoneStart, ...], law: IceLaw) -> None:
    sim = simulate(shot(*stones, ice=law))
    end = max(rest.t for rest in sim.rest.values())
    table = sim.sample(np.linspace(0, end, 300))
    places = table[["x", "y"]].to_numpy().reshape(len(stones), -1, 2)
    for k in range(len(stones)):
        for j in range(k):
            assert np.linalg.norm(places[k] - places[j], axis=-1).min() > 2 * R - 3e-6


@settings(deadline=None, max_examples=40)
@given(houses(), st.floats(-3.1, 3.1), st.booleans())
def test_mirror_and_rotation(stones: tuple[StoneStart, ...], angle: float, mirror: bool) -> None:
    """A mirrored or turned shot ends mirrored or turned, as far as hits let numbers agree."""
    sign = -1.0 if mirror else 1.0
    c, s = math.cos(angle), math.sin(angle)

    def turned(x: float, y: float) -> tuple[float, float]:
        return c * sign * x - s * y, s * sign * x + c * y

    def changed(stone: StoneStart) -> StoneStart:
        x, y = turned(stone.x, stone.y)
        vx, vy = turned(stone.vx, stone.vy)
        return replace(stone, x=x, y=y, vx=vx, vy=vy, omega=sign * stone.omega)

    one = simulate(shot(*stones))
    two = simulate(shot(*map(changed, stones)))
    # Each hit enlarges a rounding error; a graze without end.
    assume(all(closing(hit) > 0.05 for hit in (*one.hits, *two.hits)))
    assert [hit.stones for hit in one.hits] == [hit.stones for hit in two.hits]
    for name, rest in one.rest.items():
        expected = turned(rest.x, rest.y)
        assert (two.rest[name].x, two.rest[name].y) == pytest.approx(expected, abs=1e-6)


def closing(hit: HitEvent) -> float:
    one, two = (hit.before[name] for name in hit.stones)
    return (one.vx - two.vx) * hit.normal[0] + (one.vy - two.vy) * hit.normal[1]


@settings(deadline=None, max_examples=20)
@given(houses())
def test_the_same_shot_ends_the_same_to_the_bit(stones: tuple[StoneStart, ...]) -> None:
    one, two = simulate(shot(*stones)), simulate(shot(*stones))
    assert one.rest == two.rest
    assert one.hits == two.hits


@settings(deadline=None, max_examples=20)
@given(houses(), st.floats(0.1, 8.0))
def test_an_earlier_end_changes_nothing_before_it(
    stones: tuple[StoneStart, ...], until: float
) -> None:
    whole, part = simulate(shot(*stones)), simulate(shot(*stones), until=until)
    assert part.hits == tuple(hit for hit in whole.hits if hit.t <= until)
    times = np.linspace(0, until, 7)
    assert part.sample(times).equals(whole.sample(times))
    at_end = whole.sample([until]).set_index("stone")
    for name, rest in part.rest.items():
        assert rest.t <= until
        assert (rest.x, rest.y) == pytest.approx(tuple(at_end.loc[name, ["x", "y"]]), abs=1e-12)
