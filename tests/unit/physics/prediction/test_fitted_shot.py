from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.physics.ice import Constant
from curlshot.physics.impact import Frictional
from curlshot.physics.prediction.ensemble import read_ensemble, write_ensemble
from curlshot.physics.prediction.fitted_shot import by_itself
from curlshot.physics.prediction.uncertainty import InitialUncertainty
from curlshot.physics.simulator.simulation import Shot, StoneStart


def test_without_a_fit_each_error_is_drawn_by_itself() -> None:
    shot = Shot((StoneStart("A", 0, -1, 0, 1), StoneStart("B", 0, 0)), Frictional(0.8, 0.07))
    doubt = InitialUncertainty({name: np.zeros(5) for name in "AB"}, {}, restitution=0.05)
    may = by_itself(shot, doubt, 2.0, 200)
    assert (may.start, may.likely) == (2.0, shot)
    drawn = [getattr(other.impact, "restitution", 0.0) for other in may.others]
    assert np.std(drawn) == pytest.approx(0.05, rel=0.2)
    assert {other.stones for other in may.others} == {shot.stones}


def test_what_is_drawn_without_a_fit_is_written_and_read(tmp_path: Path) -> None:
    """Its ice is drawn too; what-ifs of such a shot were refused. So are stones in one another."""
    shot = Shot((StoneStart("A", 0, -0.3, 0, 1), StoneStart("B", 0, 0)), ice=Constant(0.01))
    doubt = InitialUncertainty({name: np.full(5, 0.03) for name in "AB"}, {}, friction=0.1)
    may = by_itself(shot, doubt, 2.0, 200)
    assert 20 < len(may.others) < 200
    assert np.std([getattr(other.ice, "friction", 0.0) for other in may.others]) > 0.0005
    write_ensemble(may, tmp_path / "ensemble.json")
    assert read_ensemble(tmp_path / "ensemble.json") == may
