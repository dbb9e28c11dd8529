import pytest

from curlshot.data.errors import InputError
from curlshot.data.units import unit_of_angles, unit_of_lengths


@pytest.mark.parametrize(
    ("told", "unit"),
    [
        ("m", "m"), ("meters", "m"), ("Centimetre", "cm"), ("inches", "in"), ("feet", "ft"),
        ("CM", "cm"), ("m.", "m"), ("yards", "yd"), ("yds", "yd"), ("cms", "cm"),
    ],
)  # fmt: skip
def test_units_may_be_spelled_out(told: str, unit: str) -> None:
    assert unit_of_lengths(told, None, "shot.trk", "project") == unit


@pytest.mark.parametrize("told", ["ell", "mm2", "s"])
def test_other_units_are_unknown(told: str) -> None:
    with pytest.raises(InputError, match="unknown here"):
        unit_of_lengths(told, None, "shot.trk", "project")
    for said in ("m", "cm"):
        assert unit_of_lengths(told, said, "shot.trk", "project") == said


def test_what_is_said_counts_where_nothing_is_told_and_may_not_contradict() -> None:
    assert [unit_of_lengths("", said, "a.csv", "header") for said in (None, "cm")] == ["m", "cm"]
    for said in ("m", "mm"):
        with pytest.raises(InputError, match=f"length unit is cm, as the header says, not {said}"):
            unit_of_lengths("cm", said, "a.csv", "header")


def test_an_unknown_unit_of_angles_is_refused_but_where_a_person_says_one() -> None:
    """Turns were taken for radians without a word."""
    told = [unit_of_angles(unit, None, "a.csv") for unit in (None, "", "rad", "deg")]
    assert told == [None, None, "rad", "deg"]
    with pytest.raises(InputError, match=r"unit of angles is “turns”, .* \(`angle_unit`\)"):
        unit_of_angles("turns", None, "a.csv")
    assert unit_of_angles("turns", "deg", "a.csv") == "deg"
