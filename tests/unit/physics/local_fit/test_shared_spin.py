from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.data.tracks import Columns
from curlshot.physics.local_fit.shared_spin import MAKES, share_spins
from curlshot.tests.helpers.physics.shared_spin import FIRST, PUCK, SECOND, rows


def shot() -> dict[str, Columns]:
    """A turns B by -0.8 rad/s, as itself; B turns C by 0.5; what is seen of B between is poor."""
    return {
        "A": rows((0.0, 1.5, 0.02), (1.0, 0.7, 0.02)),
        "B": rows((0.0, 0.0, 0.001), (1.0, 0.6, 0.9), (1.12, -0.3, 0.02)),
        "C": rows((0.0, 0.0, 0.001), (1.12, 0.5, 0.02)),
    }


def test_a_spin_between_two_hits_is_told_by_how_the_others_change() -> None:
    tables = shot()
    share_spins(tables, [FIRST, SECOND], PUCK)
    between = (tables["B"]["t"] > 1.0) & (tables["B"]["t"] < 1.12)
    # By A it is -0.8 rad/s, and by C, which was turned by 0.5, -0.8 as well.
    assert tables["B"]["omega"][between] == pytest.approx(-0.8, abs=0.02)
    assert (tables["B"]["sd_omega"][between] < 0.2).all()


def test_spins_that_are_well_seen_stay() -> None:
    before, after = shot(), shot()
    share_spins(after, [FIRST, SECOND], PUCK)
    for name in ("A", "C"):
        assert after[name]["omega"] == pytest.approx(before[name]["omega"], abs=0.002)
    far = (after["B"]["t"] < 1.0) | (after["B"]["t"] > 1.12)
    assert after["B"]["omega"][far] == pytest.approx(before["B"]["omega"][far], abs=0.002)


def test_a_hit_tells_less_of_a_slow_stone_s_spin_the_longer_ago_it_was() -> None:
    """A stone that hardly moves on may lose its spin; a fast one keeps it."""
    left = {}
    for speed in (2.0, 0.01):
        tables = shot()
        tables["B"]["sd_omega"][tables["B"]["t"] > 1.0] = 0.5
        tables["B"]["omega"][tables["B"]["t"] > 1.0] = 0.2
        tables["B"]["vy"] = np.full(60, speed)
        share_spins(tables, [FIRST], PUCK)
        left[speed] = tables["B"]["omega"][[26, -1]]
    assert left[2.0] == pytest.approx([-0.72, -0.72], abs=0.05)
    assert left[0.01][0] == pytest.approx(-0.72, abs=0.05)
    assert left[0.01][1] > left[0.01][0] + 0.2


def hit_by_law(rub: float) -> dict[str, Columns]:
    """A goes down onto B, which rests; rubbed by an impulse per mass, m/s, spins seen poorly.

    Newton's law for two equal cylinders: Δv = J / m and Δω = R J / (m R² / 2), of both.
    """
    lever = 0.5 * STONE.radius
    tables = {
        "A": rows((0.0, 1.5, 0.05), (1.0, 1.5 + rub / lever + 0.3, 0.5)),
        "B": rows((0.0, 0.0, 0.001), (1.0, rub / lever - 0.4, 0.5)),
    }
    after = tables["A"]["t"] > 1.0
    for name, sign, speeds in (("A", 1, (-2.0, -0.2)), ("B", -1, (0.0, -1.8))):
        table = tables[name]
        table["vx"], table["vy"] = after * sign * rub, np.where(after, speeds[1], speeds[0])
        for column in ("sd_vx", "sd_vy"):
            table[column] = np.full(60, 0.002)
        for column in ("sd_x", "sd_y"):
            table[column] = np.full(60, 0.0005)
    return tables


@pytest.mark.parametrize("rub", [-0.08, 0.05])
def test_velocities_tell_what_a_hit_changes_spins_by(rub: float) -> None:
    tables = hit_by_law(rub)
    share_spins(tables, [FIRST], STONE.radius)
    change = rub / (0.5 * STONE.radius)
    assert tables["B"]["omega"][40] == pytest.approx(change, abs=0.1)
    assert tables["A"]["omega"][40] == pytest.approx(1.5 + change, abs=0.1)
    assert 0.05 < tables["B"]["sd_omega"][40] < 0.2


@pytest.mark.parametrize("masses", [{"A": 2.0, "B": 1.0}, {"A": 0.1, "B": 0.3}])
def test_a_light_stone_turns_by_more(masses: dict[str, float]) -> None:
    """Newton's law: Δω = R J / (m R² / 2), with one J for both; A's spin is well seen."""
    turned = 0.6
    change = {name: turned * masses["A"] / mass for name, mass in masses.items()}
    tables = {
        "A": rows((0.0, 1.5, 0.02), (1.0, 1.5 + change["A"], 0.02)),
        "B": rows((0.0, 0.0, 0.001), (1.0, change["B"] - 0.3, 2.0)),
    }
    share_spins(tables, [FIRST], PUCK, masses)
    assert tables["B"]["omega"][40] == pytest.approx(change["B"], abs=0.05)


@pytest.mark.parametrize("heavy", ["A", "B"])
def test_velocities_of_unequal_stones_tell_their_spins(heavy: str) -> None:
    tables, lever = hit_by_law(0.05), 0.5 * STONE.radius
    after = tables["A"]["t"] > 1.0
    for column in ("vx", "vy"):  # half the change of velocity for twice the mass
        start = tables[heavy][column][0]
        tables[heavy][column] = start + 0.5 * (tables[heavy][column] - start)
    light = "B" if heavy == "A" else "A"
    tables[heavy]["omega"][after] -= 0.5 * 0.05 / lever
    share_spins(tables, [FIRST], STONE.radius, {heavy: 2.0, light: 1.0})
    start = {"A": 1.5, "B": 0.0}
    for name, share in ((heavy, 0.5), (light, 1.0)):
        assert tables[name]["omega"][40] == pytest.approx(
            start[name] + share * 0.05 / lever, abs=0.1
        )


def test_velocities_that_tell_otherwise_than_angles_that_are_well_seen_are_not_heard() -> None:
    tables = hit_by_law(0.05)
    for table in tables.values():
        table["sd_omega"] = np.minimum(table["sd_omega"], 0.02)
        table["vx"] *= -8
    tables["B"]["omega"][tables["B"]["t"] > 1.0] = 0.69
    tables["A"]["omega"][tables["A"]["t"] > 1.0] = 2.19
    share_spins(tables, [FIRST], STONE.radius)
    assert tables["B"]["omega"][40] == pytest.approx(0.69, abs=0.001)


def test_a_stone_whose_spin_is_nowhere_told_tells_nothing() -> None:
    tables = shot()
    for name in ("omega", "sd_omega"):
        tables["A"][name][:] = np.nan
        tables["C"][name][:] = np.nan
    share_spins(tables, [FIRST, SECOND], PUCK)
    assert tables["B"]["omega"] == pytest.approx(shot()["B"]["omega"], abs=0.002)


def test_a_long_stretch_of_which_hardly_anything_is_seen_is_told_as_well() -> None:
    tables = shot()
    for table in tables.values():
        after = table["t"] > 1.0
        table["omega"][after], table["sd_omega"][after] = table["omega"][after][0], 0.02
    tables["B"]["sd_omega"][tables["B"]["t"] > 1.0] = 0.9
    share_spins(tables, [FIRST], PUCK)
    assert tables["B"]["omega"][-1] == pytest.approx(-0.8, abs=0.1)


def turned_by(
    seen: tuple[float, float], alike: tuple[float, float], other: float, *, rise: bool = False
) -> Columns:
    """A's rows whose spins are off together by so much before and after a hit, and turned B.

    They are for a `rise` of its handle, or else for what the ice takes.
    """
    (before, after), own = seen, 0.02
    tables = {
        "A": rows((0.0, before, np.hypot(own, alike[0])), (1.0, after, np.hypot(own, alike[1]))),
        "B": rows((0.0, 0.0, 0.001), (1.0, other, 0.01)),
    }
    size = np.where(tables["A"]["t"] > 1.0, alike[1], alike[0])
    together = {"A": np.column_stack([size * rise, size * (not rise)])}
    share_spins(tables, [FIRST], STONE.radius, together=together)
    return tables["A"]


def test_a_hit_tells_what_spins_of_a_stone_are_off_by_together() -> None:
    """Of 2 and 1 rad/s a tenth more is seen: the change, 0.1 too large, tells it to 0.06."""
    told = turned_by((2.2, 1.1), (0.2, 0.1), -1.0)
    share = 0.1**2 / (0.1**2 + 2 * 0.02**2 + 0.01**2 + 0.02**2 + (0.05 * 1.0) ** 2)
    for k, off in ((10, 0.2), (40, 0.1)):
        assert told["omega"][k] == pytest.approx((2.2, 1.1)[k > 25] - share * off, abs=0.004)
        assert told["sd_omega"][k] == pytest.approx(off * np.sqrt(1 - share), abs=0.01)


def test_a_hit_tells_nothing_of_what_is_the_same_on_either_side_of_it() -> None:
    told = turned_by((2.2, 1.2), (0.2, 0.2), -0.9)
    assert told["omega"][[10, 40]] == pytest.approx([2.2, 1.2], abs=0.015)
    assert told["sd_omega"][[10, 40]] == pytest.approx(0.2, abs=0.005)


def test_handles_of_a_shot_whose_hits_fit_its_spins_are_taken_to_be_level() -> None:
    fits, does_not = ((1.0 + off, 2.0 - off) for off in (0.01, 0.3))
    for seen, better in ((fits, True), (does_not, False)):
        of_ice, of_rise = (turned_by(seen, (0.2, -0.2), 1.0, rise=rise) for rise in (False, True))
        less = of_rise["sd_omega"] / of_ice["sd_omega"]
        assert (less < 0.8).all() if better else (less > 0.95).all()
    assert of_rise["omega"][[10, 40]] == pytest.approx(of_ice["omega"][[10, 40]], abs=0.05)


@pytest.mark.parametrize("off", [0.05, 0.1, 0.2, 0.4, 0.6, 0.8])
def test_a_hit_that_contradicts_level_handles_tells_that_they_are_steep(off: float) -> None:
    """What it asks of them is beyond the 0.02 rad/s which seeing level ones errs by."""
    found = turned_by((1.0 + off, 2.0 - off), (0.2, -0.2), 1.0, rise=True)
    left = found["omega"][[10, 40]] - [1.0, 2.0]
    assert (np.abs(left) < found["sd_omega"][[10, 40]]).all()
    if off < 0.5:
        assert left == pytest.approx(np.zeros(2), abs=0.02)
        assert (found["sd_omega"] < 0.08).all()


def test_a_hit_that_contradicts_handles_of_any_make_tells_of_none() -> None:
    found = turned_by((3.0, 0.0), (0.2, -0.2), 1.0, rise=True)
    assert found["omega"][[10, 40]] == pytest.approx([3.0, 0.0], abs=1e-3)
    stated = np.hypot(0.02, 0.2 * np.sqrt(np.mean(np.square(MAKES))))
    assert found["sd_omega"] == pytest.approx(np.full(60, stated), abs=1e-3)


def test_velocities_at_a_hit_of_which_the_time_is_unknown_tell_nothing() -> None:
    tables, change = hit_by_law(0.05), 0.05 / (0.5 * STONE.radius)
    share_spins(tables, [replace(FIRST, stderr_t=np.inf, normal=(0.1, -0.995))], STONE.radius)
    # Half-way between what is seen of either: both turn by the same amount.
    assert tables["B"]["omega"][40] == pytest.approx(change - 0.05, abs=0.02)
    assert tables["B"]["sd_omega"][40] == pytest.approx(0.5 / np.sqrt(2), abs=0.02)
