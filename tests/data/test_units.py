import pytest

from data.errors import InputError
from data.units import unit_of_lengths


@pytest.mark.parametrize(
    ("told", "unit"),
    [("m", "m"), ("meters", "m"), ("Centimetre", "cm"), ("inches", "in"), ("feet", "ft")],
)
def test_units_may_be_spelled_out(told: str, unit: str) -> None:
    assert unit_of_lengths(told, "m", "shot.trk", "project") == unit


@pytest.mark.parametrize("told", ["ell", "mm2", "s"])
def test_other_units_are_unknown(told: str) -> None:
    with pytest.raises(InputError, match="unknown here"):
        unit_of_lengths(told, "m", "shot.trk", "project")
