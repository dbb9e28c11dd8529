from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from data.tracks import Columns
from physics.contacts import Contact
from physics.shared_spin import share_spins

FIRST = Contact(1.0, 0.001, ("A", "B"), (0.0, -1.0))
SECOND = Contact(1.12, 0.001, ("B", "C"), (0.0, -1.0))


def rows(*pieces: tuple[float, float, float]) -> Columns:
    """Rows of a stone at 25 a second: from when on it has which spin, with which error."""
    t = np.arange(60) / 25 + 0.01
    start, spin, sd = np.array(pieces).T
    at = np.searchsorted(start, t, side="right") - 1
    return {"t": t, "omega": spin[at], "sd_omega": sd[at]}


def shot() -> dict[str, Columns]:
    """A turns B by -0.8 rad/s, as itself; B turns C by 0.5; what is seen of B between is poor."""
    return {
        "A": rows((0.0, 1.5, 0.02), (1.0, 0.7, 0.02)),
        "B": rows((0.0, 0.0, 0.001), (1.0, 0.6, 0.9), (1.12, -0.3, 0.02)),
        "C": rows((0.0, 0.0, 0.001), (1.12, 0.5, 0.02)),
    }


def test_a_spin_between_two_hits_is_told_by_how_the_others_change() -> None:
    tables = shot()
    share_spins(tables, [FIRST, SECOND])
    between = (tables["B"]["t"] > 1.0) & (tables["B"]["t"] < 1.12)
    # By A it is -0.8 rad/s, and by C, which was turned by 0.5, -0.8 as well.
    assert tables["B"]["omega"][between] == pytest.approx(-0.8, abs=0.02)
    assert (tables["B"]["sd_omega"][between] < 0.2).all()


def test_spins_that_are_well_seen_stay() -> None:
    before, after = shot(), shot()
    share_spins(after, [FIRST, SECOND])
    for name in ("A", "C"):
        assert (before[name]["omega"] == after[name]["omega"]).all()
    far = (after["B"]["t"] < 1.0) | (after["B"]["t"] > 1.12)
    assert (before["B"]["omega"] == after["B"]["omega"])[far].all()


def test_a_long_stretch_keeps_what_was_seen_of_it() -> None:
    tables = shot()
    for name in tables:
        tables[name]["sd_omega"] = np.minimum(tables[name]["sd_omega"], 0.3)
    share_spins(tables, [FIRST, replace(SECOND, t=2.0)])
    assert (tables["B"]["omega"] == shot()["B"]["omega"]).all()


def test_a_stone_whose_spin_is_nowhere_told_tells_nothing() -> None:
    tables = shot()
    for name in ("omega", "sd_omega"):
        tables["A"][name][:] = np.nan
        tables["C"][name][:] = np.nan
    share_spins(tables, [FIRST, SECOND])
    assert (tables["B"]["omega"] == shot()["B"]["omega"]).all()


def test_a_long_stretch_of_which_hardly_anything_is_seen_is_told_as_well() -> None:
    tables = shot()
    for table in tables.values():
        after = table["t"] > 1.0
        table["omega"][after], table["sd_omega"][after] = table["omega"][after][0], 0.02
    tables["B"]["sd_omega"][tables["B"]["t"] > 1.0] = 0.9
    share_spins(tables, [FIRST])
    assert tables["B"]["omega"][-1] == pytest.approx(-0.8, abs=0.1)


@pytest.mark.parametrize("told", [(0.03, 0.9, np.nan), (0.03, 0.9, 0.9), (0.3, 0.3, 0.3)])
def test_a_hit_tells_but_once(told: tuple[float, float, float]) -> None:
    """Errors of the spins of A and C after and of B between are those stated."""
    rng = np.random.default_rng(3)
    after, between, last = told
    off = []
    for _ in range(300):
        turns = rng.normal(0, 0.5, 2)
        # The other stone's changes: as far from the same as may be.
        like = turns * rng.normal(1, 0.2, 2) + rng.normal(0, 0.05, 2)
        seen = {
            "A": [(0.0, 1.5, 0.03), (1.0, 1.5 + turns[0], after)],
            "B": [(0.0, 0.0, 0.001), (1.0, like[0], between), (1.12, like[0] + turns[1], 0.03)],
            "C": [(0.0, 0.0, 0.001), (1.12, like[1], last)],
        }
        tables = {
            name: rows(
                *((t, spin + rng.normal(0, sd if sd > 0 else 0.0), sd) for t, spin, sd in of)
            )
            for name, of in seen.items()
        }
        for table in tables.values():
            for name in table:
                table[name] = table[name][:35]  # so that A's last stretch is short
        share_spins(tables, [FIRST, SECOND])
        for name, k in (("A", 30), ("B", 26), ("C", 30)):
            error = tables[name]["omega"][k] - seen[name][1][1]
            off.append(error / tables[name]["sd_omega"][k])
    each = np.sqrt(np.mean(np.square(off).reshape(-1, 3), axis=0))
    assert all(0.85 < pull < 1.15 for pull in each[np.isfinite(each)])
